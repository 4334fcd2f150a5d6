"""Free identification of base parameters, for comparison: what the usual procedure makes of the same data.

All inertial parameters, friction and motor inertia are fitted without a prior. That follows the training data more
closely than any physical model has to: a missing effect is swallowed by parameters that have no business with it.
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.problem.problem import FRICTION, Problem

#: Directions of the parameters whose share of the largest singular value is less than this are left out (the base
#: parameters are what remains).
SMALLEST = 1e-4


def free_identification(problem: Problem) -> list[float | None]:
    """Return the RMS error (n,) [N m] on held-out moving samples after a fit of all parameters without a prior.

    Weighted least squares over all axes, weights 1 / standard deviation of the torque of an axis, directions that the
    motion does not excite left out (Gautier 1991 on base parameters).
    """
    n = problem.robot.joints
    count = problem.regressor.shape[2] + len(FRICTION) * n
    usable, discrepancy = problem.measured.usable, problem.discrepancy

    def columns(axis: int, chosen: np.ndarray) -> np.ndarray:
        block = np.zeros((int(chosen.sum()), count))
        block[:, : problem.regressor.shape[2]] = problem.regressor[chosen, axis]
        own = problem.regressor.shape[2] + len(FRICTION) * axis
        block[:, own : own + len(FRICTION)] = problem.friction_columns(problem.state, axis)[chosen]
        return block

    rows, targets = [], []
    for axis in problem.judged:
        chosen = usable[:, axis] & problem.train
        weight = 1.0 / max(float(np.std(problem.measured.torque[chosen, axis])), 1e-9)
        rows.append(weight * columns(axis, chosen))
        targets.append(weight * discrepancy[chosen, axis])
    if not rows:
        return [None] * n
    design = np.concatenate(rows)
    scale = np.maximum(np.linalg.norm(design, axis=0), 1e-12)
    theta = np.linalg.lstsq(design / scale, np.concatenate(targets), rcond=SMALLEST)[0] / scale
    result: list[float | None] = []
    for axis in range(n):
        chosen = usable[:, axis] & problem.test
        if axis not in problem.judged or not chosen.any():
            result.append(None)
            continue
        error = discrepancy[chosen, axis] - columns(axis, chosen) @ theta
        result.append(float(np.sqrt(np.mean(error**2))))
    return result
