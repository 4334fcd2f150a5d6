"""Samples in which a drive that two joints share sticks: no model can be judged by them.

Motor 6 of many wrists turns with q5 + q6. Where that sum stands still for an instant its friction is anything up to
Coulomb friction, on both joints. A few such samples in a hundred are enough to make the noise look many times larger.
They are left out where the data show a shared drive: friction that jumps with the sum explains much of what is missing
away from the jump, and what it leaves near the jump is far larger.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from jointwear.discovery import assumed

#: Fewest samples that say that a drive sticks, and fewest elsewhere for each column of the regression.
FEWEST_STUCK, FEWEST_EACH = 5, 3
#: Shares of a joint in the motion of the drive of its neighbour, whose own is one: none where the neighbour drags it.
SHARES = (1.0, -1.0, 0.0)
#: Samples that the regression is made of, at most.
SAMPLES = 3000
#: Share of the squared residual elsewhere that the friction of the shared drive may leave: half.
UNEXPLAINED = 0.5
#: Ridge of the regression as a share of the mean square of its columns.
RIDGE = 1e-6


def sticking(
    usable: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    missing: np.ndarray,
    inertial: np.ndarray,
    sigmas: float,
) -> np.ndarray:
    """Return the samples (N, n) at which the axis shares a drive that sticks with one of its neighbours.

    Parameters
    ----------
    usable : (N, n) samples of each axis to look at. velocity, acceleration : (N, n) [rad/s], [rad/s2].
    missing : (N, n) measured less nominal torque [N m]. inertial : (N, n, r) torque of errors of the inertia [N m].
    sigmas : standard deviations beyond which what is left where a drive is slow is no noise.
    """
    stuck = np.zeros_like(usable)

    @cache
    def base_of(axis: int) -> np.ndarray:
        v, a = velocity[:, axis], acceleration[:, axis]
        return np.concatenate([np.stack([v > 0, v < 0, v, a], axis=1), inertial[:, axis]], axis=1)

    for pair in pairwise(range(usable.shape[1])):
        for axis, other in (pair, pair[::-1]):
            used = usable[:, axis]
            for share in SHARES:
                speed = share * velocity[:, axis] + velocity[:, other]
                slow = np.abs(speed) < assumed.STICKS
                if np.sum(used & slow) < FEWEST_STUCK:
                    continue
                shared = np.stack([np.sign(speed), velocity[:, other], acceleration[:, other]], axis=1)
                if _sticks(base_of(axis), shared, missing[:, axis], used, slow, sigmas):
                    stuck[:, axis] |= slow
    return stuck


def _sticks(
    base: np.ndarray, shared: np.ndarray, missing: np.ndarray, used: np.ndarray, slow: np.ndarray, sigmas: float
) -> bool:
    """Return whether the columns (N, 3) of a shared drive explain what is `missing` (N,), but for its slow samples."""
    rows = np.flatnonzero(used & ~slow)
    if len(rows) < FEWEST_EACH * (base.shape[1] + shared.shape[1]):
        return False
    rows = rows[:: -(-len(rows) // SAMPLES)]
    inside = np.flatnonzero(used & slow)
    x, y = np.concatenate([base.take(rows, axis=0), shared[rows]], axis=1), missing[rows]
    gram, right = x.T @ x, x.T @ y
    gram += RIDGE * np.diag(np.maximum(np.diag(gram), 1e-12))
    count = base.shape[1]
    alone = y - x[:, :count] @ np.linalg.solve(gram[:count, :count], right[:count])
    theta = np.linalg.solve(gram, right)
    left = y - x @ theta
    if left @ left > UNEXPLAINED * (alone @ alone):
        return False
    near = missing[inside] - np.concatenate([base[inside], shared[inside]], axis=1) @ theta
    # Not all slow samples stick: a drive that reverses fast is as good a friction as elsewhere.
    noise = sigmas**2 * np.mean(left**2)
    odd_near, odd = near**2 > noise, left**2 > noise
    return bool(np.sum(odd_near) >= FEWEST_STUCK and np.mean(odd_near) > sigmas * np.mean(odd))
