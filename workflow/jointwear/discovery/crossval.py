"""Leave every record out in turn and predict it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from jointwear.discovery.linear import Term
from jointwear.discovery.problem import White


@dataclass(frozen=True)
class CrossValidated:
    """What terms add to the prediction of records left out.

    Attributes
    ----------
    nats : gain in the log predictive density, summed over the records left out in turn.
    share : part of the squared error beyond the noise that they explain on their axes, at most 1.
    raw : squared error [N m^2] with the terms over that without, on their axes; middle : the median over the records
    of that ratio in one. last : nats gained in the last record alone, worst in the record that gains least.
    """

    nats: float
    share: float
    raw: float
    last: float
    worst: float
    middle: float


def cross_validate(white: White, before: list[Term], extra: list[Term]) -> CrossValidated:
    """Compare the base regression with `before` against the same with `extra` terms.

    The density of a record left out is p(record | rest) = p(all) / p(rest): where the rest does not say what a term
    does in the record, the prediction is wide rather than wrong. Only sums of products are kept of every record, so
    that leaving one out costs one factorisation.
    """
    terms = [*white.base, *before, *extra]
    sizes = [len(t.std) for t in terms]
    places = [np.arange(stop - size, stop) for size, stop in zip(sizes, np.cumsum(sizes), strict=True)]
    total = int(np.sum(sizes))
    plain = total - sum(len(t.std) for t in extra)
    std = np.concatenate([t.std for t in terms])
    axes = {axis for t in extra for axis in t.blocks}
    raw_targets = white.raw_targets()
    parts: dict[int, dict] = {}
    for axis, y in enumerate(white.targets):
        if not len(y):
            continue
        active = [i for i, t in enumerate(terms) if axis in t.blocks]
        where = np.append(np.concatenate([places[i] for i in active]), total)
        design = np.concatenate([terms[i].blocks[axis] for i in active], axis=1)
        raw = np.concatenate([terms[i].raw[axis] for i in active], axis=1) if axis in axes else None
        label = white.folds(axis)
        for record in np.unique(label):
            rows = label == record
            sums = parts.setdefault(
                int(record), {k: np.zeros((total + 1, total + 1)) for k in ("all", "own", "raw")} | {"count": 0}
            )
            block = np.concatenate([design[rows], y[rows, None]], axis=1)
            gram = block.T @ block
            sums["all"][np.ix_(where, where)] += gram
            if axis in axes:
                sums["own"][np.ix_(where, where)] += gram
                block = np.concatenate([raw[rows], raw_targets[axis][rows, None]], axis=1)
                sums["raw"][np.ix_(where, where)] += block.T @ block
                sums["count"] += int(rows.sum())
    whole = sum(p["all"] for p in parts.values())
    evidence = [_posterior(whole, std, size, total)[1] for size in (plain, total)]
    errors = np.zeros((2, 2))
    count = 0
    gains, ratios = [], []
    for record in sorted(parts):
        sums = parts[record]
        left, raw = np.zeros(2), np.zeros(2)
        for row, size in enumerate((plain, total)):
            theta, rest = _posterior(whole - sums["all"], std, size, total)
            left[row] = evidence[row] - rest
            for column, kind in enumerate(("own", "raw")):
                s = sums[kind]
                error = s[total, total] - 2 * theta @ s[:size, total] + theta @ s[:size, :size] @ theta
                errors[row, column] += error
                raw[row] = error
        count += sums["count"]
        if sums["count"]:
            gains.append(float(left[1] - left[0]))
            ratios.append(float(raw[1] / max(raw[0], 1e-300)))
    gained = errors[0, 0] - errors[1, 0]
    excess = max(errors[0, 0] - count, gained, 1e-9)
    share = float(np.clip(gained / excess, -1.0, 1.0))
    raw_ratio = float(errors[1, 1] / max(errors[0, 1], 1e-300))
    middle = float(np.median(ratios)) if ratios else 1.0
    return CrossValidated(sum(gains), share, raw_ratio, gains[-1] if gains else 0.0, min(gains, default=0.0), middle)


def _posterior(sums: np.ndarray, std: np.ndarray, size: int, total: int) -> tuple[np.ndarray, float]:
    """Return coefficients (size,) and log evidence, up to what does not depend on the terms, from sums of products."""
    scale = std[:size]
    normal = sums[:size, :size] * scale[:, None] * scale + np.eye(size)
    right = scale * sums[:size, total]
    factor = cho_factor(normal)
    scaled = cho_solve(factor, right)
    log_det = 2 * float(np.sum(np.log(np.diag(factor[0]))))
    return scale * scaled, 0.5 * float(right @ scaled) - 0.5 * log_det
