"""Which ambiguity decides a score: main effects of all dimensions and the strongest pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from jointwear.studies.multiverse.dimensions import Reading

#: Interactions of two dimensions that are told.
PAIRS = 10


@dataclass(frozen=True)
class Effect:
    """Share of the variance of a score that one dimension, or the interaction of two, explains beyond chance.

    `levels` maps every value (of a pair: "u / v") to the mean score of the readings that have it; `p_value` is
    that of the F test against the residual of the additive model.
    """

    names: tuple[str, ...]
    share: float
    p_value: float
    levels: dict[str, float]


def _columns(readings: Sequence[Reading], name: str) -> tuple[np.ndarray, list[str]]:
    values = [str(r[name]) for r in readings]
    levels = sorted(set(values))
    return np.array([levels.index(v) for v in values]), levels


def _dummies(index: np.ndarray, levels: int) -> np.ndarray:
    # The first level is the base, so that the columns of all dimensions stay independent.
    return (index[:, None] == np.arange(1, levels)).astype(float)


def _rss(design: np.ndarray, values: np.ndarray) -> tuple[float, int]:
    solution, _, rank, _ = np.linalg.lstsq(design, values, rcond=None)
    return float(((values - design @ solution) ** 2).sum()), int(rank)


def _adjusted(gain: float, freedom: int, residual_mean: float, total: float) -> float:
    """Return omega squared: the explained share less what chance explains with so many degrees of freedom."""
    return max(gain - freedom * residual_mean, 0.0) / (total + residual_mean)


def influence(readings: Sequence[Reading], values: np.ndarray) -> tuple[list[Effect], list[Effect]]:
    """Return main effects, strongest first, and the :data:`PAIRS` strongest interactions of two dimensions.

    Parameters
    ----------
    readings : m readings of a balanced sample; values : (m,) their score.

    Notes
    -----
    Main effects come from one additive least-squares model of all dimensions; each is what the fit loses
    without it. An interaction is what the product of two dimensions adds to the additive model; only the eight
    strongest dimensions are paired. Shares are omega squared (Hays 1963), which is 0 on average for a dimension
    that does nothing.
    """
    from scipy.special import fdtrc

    values = np.asarray(values, dtype=float)
    names = [k for k in readings[0] if len({str(r[k]) for r in readings}) > 1]
    coded = {k: _columns(readings, k) for k in names}
    blocks = {k: _dummies(index, len(levels)) for k, (index, levels) in coded.items()}
    constant = np.ones((len(values), 1))
    full = np.hstack([constant, *blocks.values()])
    residual, rank = _rss(full, values)
    total = float(((values - values.mean()) ** 2).sum())
    free = max(len(values) - rank, 1)
    scale = residual / free

    def p_value(gain: float, added: int, rest: float, rest_free: int) -> float:
        if added < 1 or rest <= 0:
            return 1.0
        return float(fdtrc(added, rest_free, max(gain, 0.0) / added / (rest / rest_free)))

    main = []
    for name, (index, levels) in coded.items():
        without = np.hstack([constant, *(b for k, b in blocks.items() if k != name)])
        rest, smaller = _rss(without, values)
        means = {level: float(values[index == i].mean()) for i, level in enumerate(levels)}
        share = _adjusted(rest - residual, rank - smaller, scale, total)
        main.append(Effect((name,), share, p_value(rest - residual, rank - smaller, residual, free), means))
    main.sort(key=lambda e: -e.share)

    effects = []
    for a, b in combinations([e.names[0] for e in main[:8]], 2):
        product = (blocks[a][:, :, None] * blocks[b][:, None, :]).reshape(len(values), -1)
        rest, larger = _rss(np.hstack([full, product]), values)
        rest_free = max(len(values) - larger, 1)
        share = _adjusted(residual - rest, larger - rank, rest / rest_free, total)
        (i, u), (j, v) = coded[a], coded[b]
        means = {
            f"{x} / {y}": float(values[(i == k) & (j == m)].mean())
            for k, x in enumerate(u)
            for m, y in enumerate(v)
            if ((i == k) & (j == m)).any()
        }
        effects.append(Effect((a, b), share, p_value(residual - rest, larger - rank, rest, rest_free), means))
    effects.sort(key=lambda e: -e.share)
    return main, effects[:PAIRS]
