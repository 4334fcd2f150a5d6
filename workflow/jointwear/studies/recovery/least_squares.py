"""Levenberg-Marquardt for many starts of the same problem at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

#: A start has converged once five steps in a row lower its cost by less than this share.
_LEAST = 1e-7


@dataclass(frozen=True)
class Solution:
    """`point` (S, p), `cost` (S,): half the sum of squares, `converged` (S,)."""

    point: np.ndarray
    cost: np.ndarray
    converged: np.ndarray


def minimise(
    residuals: Callable[[np.ndarray], np.ndarray],
    residuals_and_jacobian: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    start: np.ndarray,
    iterations: int,
) -> Solution:
    """Minimise half the sum of squares from every start.

    Parameters
    ----------
    residuals : (A, p) -> (A, m).
    residuals_and_jacobian : (A, p) -> (A, m), (A, m, p).
    start : (S, p).
    iterations : at most so many.

    Notes
    -----
    Damping after Marquardt with the diagonal of J'J, raised by its mean so that directions without any effect
    stay put; the factor follows Nielsen (Damping parameter in Marquardt's method, 1999).
    """
    point = np.array(start, dtype=float)
    count = len(point)
    damping, growth = np.full(count, 1e-2), np.full(count, 2.0)
    quiet = np.zeros(count, dtype=int)
    r, jac = residuals_and_jacobian(point)
    cost = 0.5 * (r**2).sum(axis=1)
    normal, gradient = _normal(jac, r)
    active = np.arange(count)
    for _ in range(iterations):
        a = active
        diagonal = np.einsum("spp->sp", normal[a])
        diagonal = diagonal + 1e-6 * diagonal.mean(axis=1, keepdims=True) + 1e-12
        system = normal[a].copy()
        np.einsum("spp->sp", system)[...] += damping[a, None] * diagonal
        step = -np.linalg.solve(system, gradient[a][..., None])[..., 0]
        # The sine repeats itself: no step needs to be longer than a quarter of its period.
        step *= np.minimum(1.0, 1.0 / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
        proposed = point[a] + step
        trial = 0.5 * (residuals(proposed) ** 2).sum(axis=1)
        expected = -(step * gradient[a]).sum(axis=1) - 0.5 * np.einsum("sp,spq,sq->s", step, normal[a], step)
        gain = (cost[a] - trial) / np.maximum(expected, 1e-300)
        better = trial < cost[a]
        small = np.where(better, cost[a] - trial < _LEAST * cost[a], damping[a] > 1e10)
        quiet[a] = np.where(small, quiet[a] + 1, np.where(better, 0, quiet[a]))
        taken = a[better]
        point[taken], cost[taken] = proposed[better], trial[better]
        damping[taken] *= np.maximum(1 / 3, 1 - (2 * np.minimum(gain[better], 2) - 1) ** 3)
        growth[taken] = 2.0
        refused = a[~better]
        damping[refused] *= growth[refused]
        growth[refused] *= 2
        active = a[(quiet[a] < 5) & (damping[a] < 1e14)]
        fresh = np.intersect1d(taken, active)
        if len(fresh):
            r, jac = residuals_and_jacobian(point[fresh])
            normal[fresh], gradient[fresh] = _normal(jac, r)
        if not len(active):
            break
    converged = np.ones(count, dtype=bool)
    converged[active] = False
    return Solution(point, cost, converged)


def _normal(jac: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    transposed = jac.swapaxes(1, 2)
    return transposed @ jac, (transposed @ r[..., None])[..., 0]
