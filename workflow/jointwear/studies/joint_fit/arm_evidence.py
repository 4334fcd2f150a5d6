"""How likely an arm is, given Tables V and VI, when any poses may have been chosen.

A heavier payload can hide behind poses that bear less of it, so that the least cost alone does not tell one payload
from a heavier one. What tells them apart is how much of the space of poses fits: the heavier the payload, the smaller
and rarer are the regions in which the largest torque comes out as printed. Each region counts with its volume in
Laplace's approximation, poses being equally likely within the limits of the joints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.special import logsumexp

from jointwear.studies.joint_fit.pose_search import Arm, TaskFit

_UNIFORM = 1 / 12  # variance of the uniform distribution over a range of length one


def region_evidence(fit: TaskFit, u: np.ndarray) -> np.ndarray:
    """Return the log of likelihood times volume (S,) of the regions around free vectors u (S, p)."""
    residual, jacobian = fit.problem.residuals_and_jacobian(u)
    # From the free vector to shares of the range: theta = middle + half range x sin(u).
    by_share = jacobian * (2 / np.maximum(np.abs(np.cos(u)), 1e-3))[:, None, :]
    spread = np.eye(by_share.shape[1]) + _UNIFORM * (by_share @ by_share.swapaxes(1, 2))
    return -0.5 * (residual**2).sum(axis=1) - 0.5 * np.linalg.slogdet(spread)[1]


class ArmEvidence:
    """Evidence of arms for one paper; solutions found for one arm are starts for the next.

    Parameters
    ----------
    task : returns the :class:`TaskFit` of a 0-based task and an arm.
    pools : (S, p) free vectors of every task, the starts for every arm.
    iterations : of the descent from each.
    """

    def __init__(self, task: Callable[[int, Arm], TaskFit], pools: Sequence[np.ndarray], iterations: int) -> None:
        self._task, self._pools, self._iterations = task, pools, iterations

    def __call__(self, arm: Arm) -> float:
        """Return the log evidence of an arm, up to a constant."""
        total = 0.0
        for t, pool in enumerate(self._pools):
            fit = self._task(t, arm)
            total += float(logsumexp(region_evidence(fit, fit.descend(pool, self._iterations))))
        return total


def walk(
    evidence: Callable[[Arm], float],
    start: Arm,
    random: np.random.Generator,
    steps: int,
    size: float,
    shape_range: tuple[float, float],
) -> tuple[list[Arm], np.ndarray]:
    """Return the arms of a Metropolis walk over mass, offset and wear shape, and their evidence.

    Parameters
    ----------
    evidence : function of an arm.
    size : standard deviation of a step in the logarithm of each parameter.
    """
    arm, value = start, evidence(start)
    arms, values = [arm], [value]
    for _ in range(steps):
        scale = np.exp(size * random.standard_normal(3))
        shape = float(np.clip(arm.shape * scale[2], *shape_range))
        trial = Arm(float(arm.mass * scale[0]), float(arm.offset * scale[1]), shape)
        proposed = evidence(trial)
        if np.log(random.random()) < proposed - value:
            arm, value = trial, proposed
        arms.append(arm)
        values.append(value)
    return arms, np.array(values)
