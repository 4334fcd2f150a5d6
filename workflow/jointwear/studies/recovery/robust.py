"""Descent that trusts the majority of the cells.

Two columns of a table that contradict each other pull a least-squares fit to their middle, where neither is
reproduced. The pseudo-Huber loss lets one of them go, and its square root keeps the problem one of least squares.
"""

from __future__ import annotations

import numpy as np

from jointwear.studies.recovery.least_squares import minimise
from jointwear.studies.recovery.problem import Problem


def pseudo_huber(residual: np.ndarray, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Return signed roots whose squares sum to twice the pseudo-Huber loss, and their derivative by the residual.

    Parameters
    ----------
    residual : any shape.
    scale : size beyond which the loss grows linearly.
    """
    bend = np.sqrt(1 + (residual / scale) ** 2)
    # bend - 1 without loss of digits
    root = np.sqrt(2 / (bend + 1))
    return residual * root, root * (0.5 + 0.5 / bend)


def robust_descent(problem: Problem, point: np.ndarray, scale: float, iterations: int) -> np.ndarray:
    """Return free vectors (S, p) that minimise the pseudo-Huber loss of the weighted residuals from `point`."""

    def residuals(u: np.ndarray) -> np.ndarray:
        return pseudo_huber(problem.residuals(u), scale)[0]

    def residuals_and_jacobian(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        r, jacobian = problem.residuals_and_jacobian(u)
        root, slope = pseudo_huber(r, scale)
        return root, jacobian * slope[..., None]

    return minimise(residuals, residuals_and_jacobian, point, iterations).point
