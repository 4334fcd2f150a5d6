"""State of the arm at the sampled instants of a there-and-back task, for many trajectories at once.

A cycle takes the arm from `start` to `stop` and back, one quintic each. Sampling at a fixed interval meets it
at the same few instants in every cycle. Arrays have shape (..., t, k, n): tasks, instants, joints.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.robots.trajectory import quintic_profile

INSTANTS = 6
CYCLE = 60.0
INTERVAL = CYCLE / INSTANTS
SEGMENT = CYCLE / 2


@dataclass(frozen=True)
class States:
    """`position` [rad], `velocity` [rad/s], `acceleration` [rad/s2], each (..., t, k, n)."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def progress(phase: np.ndarray, outward: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how far the motion has come at the instants, and its first and second derivative by time.

    Parameters
    ----------
    phase : (...,) time of the first instant after the start of the cycle [s].
    outward : (...,) duration of the motion to the stop [s]; the way back takes the rest of the cycle.

    Returns
    -------
    share of the way (..., k), its rate [1/s] and second rate [1/s2]; negative rates lead back to the start.
    """
    outward = np.asarray(outward, dtype=float)[..., None]
    time = np.mod(np.asarray(phase, dtype=float)[..., None] + INTERVAL * np.arange(INSTANTS), CYCLE)
    back = time >= outward
    duration = np.where(back, CYCLE - outward, outward)
    s = np.where(back, CYCLE - time, time) / duration
    share, rate, second = quintic_profile(s)
    return share, np.where(back, -1.0, 1.0) * rate / duration, second / duration**2


def states(start: np.ndarray, stop: np.ndarray, phase: np.ndarray, outward: np.ndarray, speed: np.ndarray) -> States:
    """Return the states at the instants.

    Parameters
    ----------
    start, stop : (..., t, n) positions [rad].
    phase : (..., t) [s].
    outward : (t,) duration of the motion from start to stop [s].
    speed : (..., 1) or (..., t) by how much every motion is faster than that; the instants stay where they are
        on the way. A cycle of two equal motions that is 5, 7, 11 or 13 times shorter, repeated, is met at just
        these places.
    """
    share, rate, second = progress(phase, outward)
    span = (stop - start)[..., None, :]
    speed = speed[..., None, None]
    return States(
        start[..., None, :] + span * share[..., None],
        span * rate[..., None] * speed,
        span * second[..., None] * speed**2,
    )
