"""Leave every record out in turn and predict it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery.linear import Term
from jointwear.discovery.problem import White


@dataclass(frozen=True)
class CrossValidated:
    """What terms add to the prediction of records left out, on the axes that they act on.

    Attributes
    ----------
    nats : gain in log likelihood. share : part of the squared error beyond the noise that they explain, at most 1.
    raw : squared error [N m^2] with the terms over that without. last : nats gained in the last record alone,
    worst in the record that gains least.
    """

    nats: float
    share: float
    raw: float
    last: float
    worst: float


def cross_validate(white: White, before: list[Term], extra: list[Term]) -> CrossValidated:
    """Compare the base regression with `before` against the same with `extra` terms.

    Only sums of products are kept of every record, so that leaving one out costs one solve.
    """
    terms = [*white.base, *before, *extra]
    sizes = [len(t.std) for t in terms]
    places = [np.arange(stop - size, stop) for size, stop in zip(sizes, np.cumsum(sizes), strict=True)]
    total = int(np.sum(sizes))
    plain = total - sum(len(t.std) for t in extra)
    precision = 1.0 / np.concatenate([t.std for t in terms]) ** 2
    axes = {axis for t in extra for axis in t.blocks}
    raw_targets = white.raw_targets()
    parts: dict[int, dict[str, np.ndarray]] = {}
    for axis, y in enumerate(white.targets):
        if not len(y):
            continue
        active = [i for i, t in enumerate(terms) if axis in t.blocks]
        index = np.concatenate([places[i] for i in active])
        design = np.concatenate([terms[i].blocks[axis] for i in active], axis=1)
        raw = np.concatenate([terms[i].raw[axis] for i in active], axis=1) if axis in axes else None
        label = white.folds(axis)
        for record in np.unique(label):
            rows = label == record
            sums = parts.setdefault(
                int(record), {k: np.zeros((total + 1, total + 1)) for k in ("all", "own", "raw")} | {"count": 0}
            )
            where = np.append(index, total)
            block = np.concatenate([design[rows], y[rows, None]], axis=1)
            gram = block.T @ block
            sums["all"][np.ix_(where, where)] += gram
            if axis in axes:
                sums["own"][np.ix_(where, where)] += gram
                block = np.concatenate([raw[rows], raw_targets[axis][rows, None]], axis=1)
                sums["raw"][np.ix_(where, where)] += block.T @ block
                sums["count"] += int(rows.sum())
    whole = sum(p["all"] for p in parts.values())
    errors = np.zeros((2, 2))
    count = 0
    last, worst = 0.0, np.inf
    for record in sorted(parts):
        sums = parts[record]
        before_record = errors[:, 0].copy()
        rest = whole - sums["all"]
        for row, size in enumerate((plain, total)):
            theta = np.linalg.solve(rest[:size, :size] + np.diag(precision[:size]), rest[:size, total])
            for column, kind in enumerate(("own", "raw")):
                s = sums[kind]
                errors[row, column] += s[total, total] - 2 * theta @ s[:size, total] + theta @ s[:size, :size] @ theta
        count += sums["count"]
        if sums["count"]:
            step = errors[:, 0] - before_record
            last = 0.5 * float(step[0] - step[1])
            worst = min(worst, last)
    gained = errors[0, 0] - errors[1, 0]
    excess = max(errors[0, 0] - count, gained, 1e-9)
    share = float(np.clip(gained / excess, -1.0, 1.0))
    return CrossValidated(0.5 * gained, share, float(errors[1, 1] / max(errors[0, 1], 1e-300)), last, worst)
