"""Splines in place of filters: motion from positions and, where they were recorded, velocities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.measurement.derived.fused_velocity import AGREES
from jointwear.measurement.derived.smoothing import smooth


@dataclass(frozen=True)
class FittedMotion:
    """Position [rad], velocity [rad/s] and acceleration [rad/s2] (m, n) of least-squares splines.

    `band` (n,) [Hz] where that of a joint ends, `noise` (n,) [rad/s] of its velocity, `of_positions` (n,) bool: its
    accelerations were made of the positions.
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    band: np.ndarray
    noise: np.ndarray
    of_positions: np.ndarray


def fit_motion(
    time: np.ndarray, pieces: list[slice], position: np.ndarray, velocity: np.ndarray | None, rate: float
) -> FittedMotion:
    """Fit splines to positions and, where given, to velocities.

    Each joint's derivatives come from the signal that gives them with less noise, in the band of the signal that
    follows the motion further: in its own, a signal that is all noise has the least, because its fit follows hardly
    anything. They come from the velocities if the two disagree, as a recorder may take them from elsewhere.

    Parameters
    ----------
    time : (m,) [s]. pieces : the uninterrupted stretches. position, velocity : (m, n) [rad], [rad/s]. rate : [Hz].
    """
    rows = np.concatenate([np.arange(p.start, p.stop) for p in pieces])
    one = smooth([(time[p], position[p]) for p in pieces], rate)
    q, v, a = position.copy(), np.zeros_like(position), np.zeros_like(position)
    q[rows], v[rows], a[rows] = one.value, one.first, one.second
    cutoff, noise = one.cutoff, one.derivative_noise(1, rate)
    better = np.ones(position.shape[1], bool)
    if velocity is None:
        return FittedMotion(q, v, a, cutoff, noise, better)
    two = smooth([(time[p], velocity[p]) for p in pieces], rate)
    apart = np.sqrt(np.mean((velocity[rows] - one.first) ** 2, axis=0))
    agree = apart <= AGREES * np.hypot(two.noise, noise)
    band = np.maximum(one.cutoff, two.cutoff)
    for order, target in ((1, v), (2, a)):
        better = agree & (one.derivative_noise(order, rate, band) <= two.derivative_noise(order - 1, rate, band))
        target[np.ix_(rows, ~better)] = (two.value, two.first)[order - 1][:, ~better]
        cutoff = np.where(better, cutoff, two.cutoff)
        if order == 1:
            noise = np.where(better, noise, two.derivative_noise(0, rate))
    return FittedMotion(q, v, a, cutoff, noise, better)
