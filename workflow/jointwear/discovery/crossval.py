"""Leave every record out in turn and predict it, in nats and in N m."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import ndtr

from jointwear.discovery.linear import Term
from jointwear.discovery.whitening import White


@dataclass(frozen=True)
class CrossValidated:
    """What terms add to the prediction of records left out.

    Attributes
    ----------
    nats : gain in the log predictive density, summed over the records left out in turn; `worst` that of the record
        that gains least, `last` that of the last record.
    share : part of the squared error beyond the noise that they explain on their axes, whitened, at most 1.
    lowers_error : probability that they lower the squared error [N m^2], by signed ranks over blocks of time.
    gain_share : drop of the mean squared error [N m^2] over the noise variance, on the axis where it drops most.
    raw : squared error with the terms over that without, on their axes; `middle` : the median over the records.
    """

    nats: float
    share: float
    worst: float = 0.0
    last: float = 0.0
    lowers_error: float = 1.0
    gain_share: float = 1.0
    raw: float = 0.9
    middle: float = 0.9


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
    axes = sorted({axis for t in extra for axis in t.blocks})
    parts: dict[int, np.ndarray] = {}
    own: dict[int, np.ndarray] = {}
    in_newton_metres: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for axis, y in enumerate(white.targets):
        if not len(y):
            continue
        active = [i for i, t in enumerate(terms) if axis in t.blocks]
        columns = np.concatenate([places[i] for i in active])
        where = np.append(columns, total)
        block = np.concatenate([*(terms[i].blocks[axis] for i in active), y[:, None]], axis=1)
        if axis in axes:
            in_newton_metres[axis] = np.concatenate([terms[i].raw[axis] for i in active], axis=1), columns
        label = white.parts(axis)
        for record in np.unique(label):
            rows = block[label == record]
            gram = rows.T @ rows
            for sums in (parts, own) if axis in axes else (parts,):
                held = sums.setdefault(int(record), np.zeros((total + 1, total + 1)))
                held[np.ix_(where, where)] += gram
    whole = sum(parts.values())
    evidence = [_posterior(whole, std, size, total)[1] for size in (plain, total)]
    gains: dict[int, float] = {}
    coefficients: dict[int, tuple[np.ndarray, ...]] = {}
    errors = np.zeros(2)
    for record in sorted(parts):
        found = [_posterior(whole - parts[record], std, size, total) for size in (plain, total)]
        coefficients[record] = tuple(theta for theta, _ in found)
        if record not in own:
            continue
        gains[record] = (evidence[1] - found[1][1]) - (evidence[0] - found[0][1])
        s = own[record]
        for k, (theta, _) in enumerate(found):
            size = len(theta)
            errors[k] += s[total, total] - 2 * theta @ s[:size, total] + theta @ s[:size, :size] @ theta
    count = sum(len(white.targets[axis]) for axis in axes)
    gained = errors[0] - errors[1]
    share = float(np.clip(gained / max(errors[0] - count, gained, 1e-9), -1.0, 1.0))
    order = list(gains.values())
    lowers, gain_share, raw, middle = _in_newton_metres(white, in_newton_metres, coefficients, plain)
    return CrossValidated(
        nats=sum(order),
        share=share,
        worst=min(order, default=0.0),
        last=order[-1] if order else 0.0,
        lowers_error=lowers,
        gain_share=gain_share,
        raw=raw,
        middle=middle,
    )


def _in_newton_metres(
    white: White,
    designs: dict[int, tuple[np.ndarray, np.ndarray]],
    coefficients: dict[int, tuple[np.ndarray, ...]],
    plain: int,
) -> tuple[float, float, float, float]:
    """Return `lowers_error`, `gain_share`, `raw` and `middle` of :class:`CrossValidated`.

    Parameters
    ----------
    designs : axis -> unwhitened columns (m, k) and their places. coefficients : record -> without and with the extra
        terms, fitted on the other records; the first `plain` places are those without.
    """
    targets = white.raw_targets()
    drops: dict[tuple[int, float], float] = {}
    per_record: dict[int, np.ndarray] = {}
    shares = []
    for axis, (design, places) in designs.items():
        first = places < plain
        label, time = white.parts(axis), white.problem.train_state.time[white.whiteners[axis].rows]
        variance = white.whiteners[axis].marginal ** 2
        dropped = 0.0
        for record, (without, extended) in coefficients.items():
            rows = label == record
            if not rows.any():
                continue
            square = [
                (targets[axis][rows] - x @ theta) ** 2 / variance
                for x, theta in (
                    (design[rows][:, first], without[places[first]]),
                    (design[rows], extended[places]),
                )
            ]
            block = (time[rows] - time[rows][0]) // white.problem.settings.block
            # Recordings may lie years apart: what is kept is as long as there are blocks with samples.
            numbers, place = np.unique(block, return_inverse=True)
            sums = np.bincount(place, square[0] - square[1])
            for index, total in zip(numbers.tolist(), sums.tolist(), strict=True):
                drops[record, index] = drops.get((record, index), 0.0) + total
            per_record[record] = per_record.get(record, np.zeros(2)) + np.sum(square, axis=1)
            dropped += float(sums.sum())
        shares.append(dropped / max(len(label), 1))
    lowers = positive(np.array(list(drops.values())))
    both = np.array(list(per_record.values()))
    ratios = both[:, 1] / np.maximum(both[:, 0], 1e-300)
    raw = float(both[:, 1].sum() / max(both[:, 0].sum(), 1e-300))
    return lowers, max(shares), raw, float(np.median(ratios))


def positive(values: np.ndarray) -> float:
    """Return the probability that values (k,) lie above zero: Wilcoxon's signed ranks in the normal approximation.

    An effect that is strong in some blocks and weak in others scatters widely without being in doubt; ranks do not
    take the one for the other.
    """
    count = len(values)
    if not count:
        return 0.5
    ranks = np.argsort(np.argsort(np.abs(values))) + 1.0
    excess = float(ranks[values > 0].sum()) - count * (count + 1) / 4
    return float(ndtr(excess / np.sqrt(count * (count + 1) * (2 * count + 1) / 24)))


def _posterior(sums: np.ndarray, std: np.ndarray, size: int, total: int) -> tuple[np.ndarray, float]:
    """Return coefficients (size,) and log evidence, up to what does not depend on the terms, from sums of products."""
    scale = std[:size]
    normal = sums[:size, :size] * scale[:, None] * scale + np.eye(size)
    right = scale * sums[:size, total]
    factor = cho_factor(normal)
    scaled = cho_solve(factor, right)
    log_det = 2 * float(np.sum(np.log(np.diag(factor[0]))))
    return scale * scaled, 0.5 * float(right @ scaled) - 0.5 * log_det
