"""Slope and curvature of the evidence over the logarithms of all nonlinear parameters of an effect at once.

Such parameters stand in for each other: a Stribeck curve that decays at a higher speed with a larger exponent looks
much the same. What is known of one while the others are held is several times what is known of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from jointwear.discovery.estimates.refine import FIRST_STEP, evidence_at, free_parameters, limits
from jointwear.discovery.linear import Fit
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.whitening import White

#: Step of the logarithm of a parameter over which the curvature of the evidence is taken, and the least and the largest
#: standard deviation of it that is believed.
STEP, LEAST_SPREAD, LARGEST_SPREAD = 0.05, 1e-4, 1.0
#: How often parameters are moved together at most, and by which a move must gain [nats]: a seventh of a standard
#: deviation.
MOVES, GAINED = 6, 0.01


@dataclass(frozen=True)
class Spreads:
    """How little is known of the free nonlinear parameters of an effect.

    Attributes
    ----------
    names : of the parameters. root : (k, k) of the covariance C of their logarithms, C = root root'. Its columns are
        steps of one standard deviation that are independent of each other.
    """

    names: tuple[str, ...]
    root: np.ndarray

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of the logarithm of every parameter, whatever the others are."""
        return {name: float(s) for name, s in zip(self.names, np.linalg.norm(self.root, axis=1), strict=True)}

    def at_least(self, others: Spreads) -> Spreads:
        """Return these with every parameter known no better than in `others` of the same parameters."""
        own, least = self.std, others.std
        share = np.array([max(1.0, least[name] / own[name]) for name in self.names])
        return replace(self, root=share[:, None] * self.root)

    def moved(self, candidate: Candidate, steps: np.ndarray) -> Candidate:
        """Return a candidate by steps (k,) [standard deviations] along the columns of the root, within its bounds."""
        return _shifted(candidate, self.names, self.root @ steps, _bounds(candidate))


def spreads_of(white: White, fit: Fit, candidate: Candidate) -> Spreads:
    """Return what is not known of the nonlinear parameters of a candidate, from the curvature of the evidence.

    It is the largest spread along what costs no evidence, and where the torque would have to turn round.
    """
    names = tuple(p.name for p in free_parameters(candidate))
    if not names:
        return Spreads((), np.zeros((0, 0)))
    # A size at its bound has a slope there, and no edge.
    _, precision = _around(white, fit, candidate, names, any_size=True)
    values, vectors = np.linalg.eigh(precision)
    return Spreads(names, vectors / np.sqrt(np.clip(values, LARGEST_SPREAD**-2, LEAST_SPREAD**-2)))


def moved_together(white: White, fit: Fit, candidate: Candidate) -> Candidate:
    """Return a refined candidate with its nonlinear parameters at the largest evidence along what they share.

    One after the other they stop on the slope of a narrow ridge.
    """
    names = tuple(p.name for p in free_parameters(candidate))
    if len(names) < 2:
        return candidate
    bounds = limits(white, candidate)
    best, value = candidate, evidence_at(white, fit, candidate)
    for _ in range(MOVES):
        slope, precision = _around(white, fit, best, names)
        values, vectors = np.linalg.eigh(precision)
        shift = vectors @ (vectors.T @ slope / np.maximum(values, LARGEST_SPREAD**-2))
        shift *= min(1.0, FIRST_STEP / max(float(np.abs(shift).max()), 1e-300))
        trial = _shifted(best, names, shift, bounds)
        got = evidence_at(white, fit, trial)
        if not got > value + GAINED:
            break
        best, value = trial, got
    return best


def _around(
    white: White, fit: Fit, candidate: Candidate, names: tuple[str, ...], any_size: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Return slope (k,) and negative curvature (k, k) of the evidence over the logarithms of parameters, 0 of what is
    not known."""

    def at(shift: np.ndarray) -> float:
        return evidence_at(white, fit, _shifted(candidate, names, shift, {}), any_size=any_size)

    steps, here = STEP * np.eye(len(names)), at(np.zeros(len(names)))
    slope, precision = np.zeros(len(names)), np.zeros((len(names), len(names)))
    for i, step in enumerate(steps):
        above, below = at(step), at(-step)
        if np.isfinite([below, here, above]).all():
            slope[i] = (above - below) / (2 * STEP)
            precision[i, i] = -(above - 2 * here + below) / STEP**2
    for i, j in combinations(np.flatnonzero(np.diag(precision)), 2):
        alike = at(steps[i] + steps[j]) + at(-steps[i] - steps[j])
        apart = at(steps[i] - steps[j]) + at(steps[j] - steps[i])
        if np.isfinite([alike, apart]).all():
            precision[i, j] = precision[j, i] = -(alike - apart) / (4 * STEP**2)
    return slope, precision


def _bounds(candidate: Candidate) -> dict[str, tuple[float, float]]:
    return {p.name: (p.lower, p.upper) for p in free_parameters(candidate)}


def _shifted(
    candidate: Candidate, names: tuple[str, ...], shift: np.ndarray, bounds: Mapping[str, tuple[float, float]]
) -> Candidate:
    """Return a candidate with the logarithms of parameters shifted (k,), within bounds where there are any."""
    own = {}
    for name, s in zip(names, shift, strict=True):
        own[name] = float(np.clip(candidate.nonlinear[name] * np.exp(s), *bounds.get(name, (-np.inf, np.inf))))
    return replace(candidate, nonlinear={**candidate.nonlinear, **own})
