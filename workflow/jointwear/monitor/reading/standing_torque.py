"""A torque that stands still while its axis moves both ways: the sensor, or the log, and nothing that the axis does."""

from __future__ import annotations

import numpy as np

#: Samples of a torque that keeps one value, and of motion of its joint either way, from which it is frozen.
FEWEST_FROZEN, FEWEST_MOVING = 200, 20


def standing(torque: np.ndarray, velocity: np.ndarray, dead_band: np.ndarray) -> np.ndarray:
    """Return the axes (n,) whose torque keeps one value though they move both ways.

    Parameters
    ----------
    torque, velocity : (m, n) [N m], [rad/s]. dead_band : (n,) [rad/s].
    """
    if len(torque) < FEWEST_FROZEN:
        return np.zeros(torque.shape[1], dtype=bool)
    # One value throughout shows in the first samples already: mostly nothing is left to look at.
    first = torque[:FEWEST_FROZEN]
    same = ~(np.isfinite(first[0]) & np.isfinite(first) & (first != first[0])).any(axis=0)
    for j in np.flatnonzero(same):
        known = torque[np.isfinite(torque[:, j]), j]
        same[j] = len(known) > 0 and np.ptp(known) == 0
    both = (velocity > dead_band).sum(axis=0), (velocity < -dead_band).sum(axis=0)
    return same & (np.minimum(*both) > FEWEST_MOVING)
