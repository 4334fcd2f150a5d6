"""Joints whose position is counted within one turn."""

from __future__ import annotations

import numpy as np

from jointwear.robots.robot import Robot

#: Shares of a turn either way from which limits are those of a joint that turns on and on, as readers of robot files
#: write them for one that has none.
A_TURN = 0.99


def turns_on(robot: Robot) -> np.ndarray:
    """Return which joints (n,) have limits that leave a whole turn either way: they may turn on beyond them."""
    return np.minimum(-robot.lower, robot.upper) >= A_TURN * 2 * np.pi


def unwrapped(position: np.ndarray) -> np.ndarray:
    """Return positions (m, n) [rad] without the jumps by a whole turn of a joint that is counted within one turn."""
    result = np.array(position, dtype=float)
    for j in range(result.shape[1]):
        finite = np.flatnonzero(np.isfinite(result[:, j]))
        x = result[finite, j]
        # Positions beyond a turn are not counted within one: their jumps are something else, such as degrees.
        if len(x) and np.abs(x).max() <= 2 * np.pi + 0.1 and np.any(np.abs(np.diff(x)) > 1.5 * np.pi):
            result[finite, j] = np.unwrap(x)
    return result
