"""Can a hidden thing be seen at all? From the torque that it really makes and the noise, not from a verdict.

The noise is that of the torque channel, and that of encoders which is felt as acceleration within the band of the
motion. See :mod:`jointwear.studies.sieve`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.robots.robot import Robot
from jointwear.studies.sieve import Sieve, build_sieve, drive_columns, inertial_torques

#: Pairs of neighbouring samples that are looked at, at most.
_PAIRS = 1400


@dataclass(frozen=True)
class Samples:
    """Logged instants, arrays (m, n), `recording` (m,): motion without noise, of the side that the encoders see."""

    recording: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    rate: float


def sieve_samples(
    samples: Samples,
    nominal: Robot,
    train: np.ndarray,
    noise: np.ndarray,
    colour: float,
    prior: float,
    drives: bool = True,
    without: tuple[str, int] | None = None,
) -> Sieve:
    """Return the projection of torques on logged instants.

    Parameters
    ----------
    train : (m,) mask. noise : (n,) [N m], `colour` the coefficient of its autoregression.
    prior : relative standard deviation of the inertial parameters. drives : friction and motor inertia are free.
    without : (parameter, 0-based axis) of the model that is asked for and must not be taken by itself.
    """
    usable = np.flatnonzero(train[:-1] & train[1:] & (np.diff(samples.recording) == 0))
    stride = max(1, len(usable) // _PAIRS)
    first = usable[::stride]
    pairs = np.concatenate([first, first + 1])
    q, v, a = samples.position[pairs], samples.velocity[pairs], samples.acceleration[pairs]
    inertial = inertial_torques(nominal, q, v, a, prior, without)
    free = drive_columns(v, a, without) if drives else np.empty((0, *v.shape))
    return build_sieve(first, np.abs(v), free, inertial, noise, colour, stride)
