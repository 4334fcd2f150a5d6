"""What each family of the library would add to a fit: evidence of many candidates at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.discovery.linear import Fit, gain, posterior_mean
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, Dictionary
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.settings import Settings
from jointwear.effects import Effect, get_effect


def gain_about_one(white: White, b: np.ndarray, gram: np.ndarray, off: float = np.inf) -> np.ndarray:
    """Return the evidence (...) that columns add whose coefficient is one, give or take the `usual` share.

    Columns that would have to turn round are another torque, however much of the data they would then explain: none of
    them may stand for its family, in which another size may be right.

    Parameters
    ----------
    b : (..., k) X'r of the columns, gram : (..., k, k) what is left of X'X, as of
        :func:`jointwear.discovery.linear.gain`.
    off : factor by which the coefficient that fits may be off, either way, as
        :func:`jointwear.discovery.search.acceptance.bound_missed` asks it.
    """
    width = np.full(b.shape, white.problem.settings.usual)
    beyond = b - gram.sum(axis=-1)
    another = np.any(1.0 + posterior_mean(beyond, gram, width) <= 0, axis=-1)
    if np.isfinite(off):
        size = posterior_mean(b, gram, np.ones(b.shape))
        another |= np.any((size <= 1.0 / off) | (size >= off), axis=-1)
    values = b.sum(axis=-1) - 0.5 * gram.sum(axis=(-2, -1)) + gain(beyond, gram, width)
    return np.where(another, -np.inf, values)[()]


@dataclass(frozen=True)
class Scored:
    """The best point of one family (effect, axis, source) and the evidence [nats] of the family.

    `others` are the best points of the forms that have other parameters, best first: a rise beside a wave.
    """

    candidate: Candidate
    evidence: float
    blocks: dict[int, np.ndarray]
    std: np.ndarray
    others: tuple[Scored, ...] = ()


def scan(white: White, dictionary: Dictionary, fit: Fit, keys: set | None = None) -> list[Scored]:
    """Score every family given the terms of `fit`; the families, best first.

    The evidence of a family is averaged over its grid and pays for the number of families searched. `keys`
    restricts the families.
    """
    families: dict[tuple, list[tuple[float, Candidate, dict, np.ndarray]]] = {}
    chol = np.linalg.cholesky(fit.covariance)
    for axis, matrix in dictionary.matrix.items():
        for candidate, where, std, value in _scored(dictionary, axis, fit, chol, keys):
            families.setdefault(candidate.key, []).append((value, candidate, {axis: matrix[:, where]}, std))
    for candidates, matrices in dictionary.spreading:
        if keys is not None and candidates[0].key not in keys:
            continue
        b, square = _gram_each(dictionary, matrices, fit, chol)
        values = gain_about_one(white, b[:, None], square[:, None, None], white.problem.settings.off_scale).tolist()
        for k, (candidate, value) in enumerate(zip(candidates, values, strict=True)):
            blocks = {a: x[:, k : k + 1] for a, x in matrices.items()}
            families.setdefault(candidate.key, []).append((value, candidate, blocks, np.ones(1)))
    for candidate, blocks, std in dictionary.whole:
        if keys is not None and candidate.key not in keys:
            continue
        b, gram = fit.gram(blocks)
        value = gain(b, gram, std)
        if candidate.effect == LINK_MASS and abs(b[0]) > white.problem.settings.wrongest_mass * (
            gram[0, 0] + 1 / std[0] ** 2
        ):
            value = -np.inf
        families.setdefault(candidate.key, []).append((value, candidate, blocks, std))
    price = np.log(max(len(families), 1))
    found = []
    for points in families.values():
        values = np.array([p[0] for p in points])
        cost = np.log(len(values)) + (price if keys is None else 0.0)
        forms: dict[frozenset, tuple] = {}
        for point in sorted(points, key=lambda p: -p[0]):
            forms.setdefault(frozenset(point[1].nonlinear), point)
        first, *rest = forms.values()
        others = tuple(Scored(c, float(value - cost), blocks, std) for value, c, blocks, std in rest)
        found.append(Scored(first[1], float(np.logaddexp.reduce(values) - cost), first[2], first[3], others))
    return sorted(found, key=lambda s: -s.evidence)


def _scored(
    dictionary: Dictionary, axis: int, fit: Fit, chol: np.ndarray, keys: set | None
) -> Iterator[tuple[Candidate, slice, np.ndarray, float]]:
    """Yield candidate, columns, prior and gain [nats] of what acts on one axis alone and may exist as it is fitted.

    Parameters
    ----------
    chol : lower Cholesky factor (p, p) of the covariance of the fit. keys : families, None for all.
    """
    entries = dictionary.entries[axis]
    chosen = np.array([keys is None or candidate.key in keys for candidate, _, _ in entries], dtype=bool)
    if not chosen.any():
        return
    b, cross = dictionary.products(axis, dictionary.matrix[axis]).projected(fit)
    turned = cross @ chol
    values: list[float] = [0.0] * len(entries)
    means: list[np.ndarray] = [np.zeros(0)] * len(entries)
    for group in (g.of(chosen) for g in dictionary.groups(axis)):
        taken = turned[group.places]
        gram = group.squares - taken @ taken.transpose(0, 2, 1)
        mean, value = (work(b[group.places], gram, group.std) for work in (posterior_mean, gain))
        for i, m, v in zip(group.members, mean, value.tolist(), strict=True):
            means[i], values[i] = m, v
    for i in np.flatnonzero(chosen):
        candidate, where, std = entries[i]
        if possible(get_effect(candidate.effect), candidate.nonlinear, means[i]):
            yield candidate, where, std, values[i]


def _gram_each(
    dictionary: Dictionary, matrices: dict[int, np.ndarray], fit: Fit, chol: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return b and H (k,) of each of the columns on several axes alone, as of :meth:`Fit.gram_each`."""
    sums = [dictionary.products(axis, x).projected(fit) for axis, x in matrices.items()]
    full = sum(dictionary.products(axis, x).squares for axis, x in matrices.items())
    return sum(b for b, _ in sums), full - np.sum((sum(cross for _, cross in sums) @ chol) ** 2, axis=1)


def contenders(found: list[Scored], settings: Settings) -> list[Scored]:
    """Return the leading families whose order a form that may bend could change, of all of them, best first.

    Bends are worth the `usual` share of an effect: who is further behind does not overtake.
    """
    if not found:
        return []
    return [s for s in found if s.evidence > (1.0 - settings.usual) * found[0].evidence - settings.accept]


def possible(effect: Effect, nonlinear: dict[str, Any], coefficients: np.ndarray) -> bool:
    """Return whether the parameters lie within their bounds: no friction that drives, no delay of a quarter second.

    Parameters
    ----------
    coefficients : (k,) of the columns of the effect.
    """
    if effect.scaled and coefficients[0] <= 0:
        # Its size, with its sign, is in the nonlinear parameters.
        return False
    return effect.possible(effect.parameters_of(nonlinear, coefficients))
