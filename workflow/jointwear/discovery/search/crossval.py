"""Leave every record out in turn and predict it, in nats and in N m."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import ndtr, stdtr

from jointwear.discovery.linear import Term
from jointwear.discovery.problem.whitening import Folds, White

#: Columns (m, k) on every axis with the places of their coefficients.
Designs = dict[int, tuple[np.ndarray, np.ndarray]]
#: Coefficients without and with the extra terms, for every record left out.
Coefficients = dict[int, tuple[np.ndarray, ...]]


@dataclass(frozen=True)
class CrossValidated:
    """What terms add to the prediction of records left out.

    Attributes
    ----------
    nats : gain in the log predictive density, summed over the records left out in turn; `worst` that of the record
        that gains least, `last` that of the last record.
    elsewhere : evidence [nats] of the terms without the block of time that gains most from them.
    share : part of the squared error beyond the noise that they explain on their axes, whitened, at most 1.
    lowers_error : probability that they lower the squared error [N m^2], by blocks of time (:func:`lowered`).
    gain_share : drop of the mean squared error [N m^2] over the noise variance, on the axis where it drops most.
    """

    nats: float
    share: float
    worst: float = 0.0
    last: float = 0.0
    lowers_error: float = 1.0
    gain_share: float = 1.0
    elsewhere: float = np.inf


def cross_validate(
    white: White, before: list[Term], extra: list[Term], parts_of: Folds | None = None
) -> CrossValidated:
    """Compare the base regression with `before` against the same with `extra` terms.

    The density of a record left out is p(record | rest) = p(all) / p(rest): where the rest does not say what a term
    does in the record, the prediction is wide rather than wrong. Only sums of products are kept of every record, so
    that leaving one out costs one factorisation.

    Parameters
    ----------
    parts_of : axis -> part (m,) of each whitened row, left out in turn; default the records, at least four parts.
    """
    parts_of = parts_of or white.parts
    sums = _sums_of(white, before, extra, parts_of)
    fitted = [sums.posterior(sums.whole, size) for size in sums.sizes]
    evidence = [value for _, value in fitted]
    gains: list[float] = []
    coefficients: Coefficients = {}
    errors = np.zeros(2)
    for record in sorted(sums.of_record):
        found = [sums.posterior(sums.whole - sums.of_record[record], size) for size in sums.sizes]
        coefficients[record] = tuple(theta for theta, _ in found)
        if record in sums.on_own_axes:
            gains.append((evidence[1] - found[1][1]) - (evidence[0] - found[0][1]))
            errors += [sums.squared_error(record, theta) for theta in coefficients[record]]
    count = sum(len(white.targets[axis]) for axis in sums.whitened)
    gained = errors[0] - errors[1]
    everywhere = dict.fromkeys(sums.of_record, tuple(theta for theta, _ in fitted))
    plain, total = sums.sizes
    most = int(np.argmax(_drops(white, parts_of, sums.whitened, white.targets, everywhere, plain)[0]))
    rest = sums.whole - _of_block(white, sums.whitened, most, total)
    without, extended = (sums.posterior(rest, size)[1] for size in sums.sizes)
    lowers, gain_share = _in_newton_metres(white, parts_of, sums.in_newton_metres, coefficients, plain)
    return CrossValidated(
        nats=sum(gains),
        elsewhere=extended - without,
        share=float(np.clip(gained / max(errors[0] - count, gained, 1e-9), -1.0, 1.0)),
        worst=min(gains, default=0.0),
        last=gains[-1] if gains else 0.0,
        lowers_error=lowers,
        gain_share=gain_share,
    )


@dataclass(frozen=True)
class _Sums:
    """Sums of products of the columns of all terms, and of the target behind them, (k + 1, k + 1).

    `of_record` holds them by record, `on_own_axes` those of the axes on which the extra terms act alone; `whole` is the
    sum over all records. `whitened` and `in_newton_metres` are the columns on these axes. `std` (k,) of the
    coefficients a priori, and `sizes`, how many columns there are without the extra terms and with them.
    """

    of_record: dict[int, np.ndarray]
    on_own_axes: dict[int, np.ndarray]
    whole: np.ndarray
    whitened: Designs
    in_newton_metres: Designs
    std: np.ndarray
    sizes: tuple[int, int]

    def posterior(self, products: np.ndarray, size: int) -> tuple[np.ndarray, float]:
        """Return coefficients (size,) and log evidence of the first columns; see :func:`_posterior`."""
        return _posterior(products, self.std, size, self.sizes[1])

    def squared_error(self, record: int, theta: np.ndarray) -> float:
        """Return the squared error of coefficients (size,) in a record, on the axes of the extra terms, whitened."""
        s, size, total = self.on_own_axes[record], len(theta), self.sizes[1]
        return s[total, total] - 2 * theta @ s[:size, total] + theta @ s[:size, :size] @ theta


def _sums_of(white: White, before: list[Term], extra: list[Term], parts_of: Folds) -> _Sums:
    """Return the sums for the base regression with `before` and `extra` terms, as :func:`cross_validate` takes them."""
    terms = [*white.base, *before, *extra]
    sizes = [len(t.std) for t in terms]
    places = [np.arange(stop - size, stop) for size, stop in zip(sizes, np.cumsum(sizes), strict=True)]
    total = int(np.sum(sizes))
    axes = {axis for t in extra for axis in t.blocks}
    of_record: dict[int, np.ndarray] = {}
    own: dict[int, np.ndarray] = {}
    whitened: Designs = {}
    in_newton_metres: Designs = {}
    for axis, y in enumerate(white.targets):
        if not len(y):
            continue
        active = [i for i, t in enumerate(terms) if axis in t.blocks]
        columns = np.concatenate([places[i] for i in active])
        where = np.append(columns, total)
        block = np.concatenate([*(terms[i].blocks[axis] for i in active), y[:, None]], axis=1)
        if axis in axes:
            whitened[axis] = block[:, :-1], columns
            in_newton_metres[axis] = np.concatenate([terms[i].raw[axis] for i in active], axis=1), columns
        label = parts_of(axis)
        for record in np.unique(label):
            rows = block[label == record]
            gram = rows.T @ rows
            for sums in (of_record, own) if axis in axes else (of_record,):
                held = sums.setdefault(int(record), np.zeros((total + 1, total + 1)))
                held[np.ix_(where, where)] += gram
    std = np.concatenate([t.std for t in terms])
    plain = total - sum(len(t.std) for t in extra)
    return _Sums(of_record, own, sum(of_record.values()), whitened, in_newton_metres, std, (plain, total))


def _in_newton_metres(
    white: White, parts_of: Folds, designs: Designs, coefficients: Coefficients, plain: int
) -> tuple[float, float]:
    """Return `lowers_error` and `gain_share` of :class:`CrossValidated`; arguments as of :func:`_drops`, unwhitened."""
    targets = white.raw_targets
    blocks, shares = 0.0, []
    for axis, design in designs.items():
        variance = white.whiteners[axis].marginal ** 2
        found = _drops(white, parts_of, {axis: design}, targets, coefficients, plain) / variance
        shares.append(float(found[0].sum()) / max(len(targets[axis]), 1))
        blocks = blocks + found
    # Blocks in which no axis can be judged say nothing.
    drops, changes = blocks[:, blocks[0] != 0.0]
    return lowered(drops, changes), max(shares)


def _drops(
    white: White,
    parts_of: Folds,
    designs: Designs,
    targets: list[np.ndarray],
    coefficients: Coefficients,
    plain: int,
) -> np.ndarray:
    """Return what extra terms do to records left out in every block of time, (2, blocks).

    By how much they lower the squared error, and the squared change of what is predicted.

    Parameters
    ----------
    designs : axis -> columns (m, k) and their places. targets : (m,) of every axis. coefficients : record -> without
        and with the extra terms, fitted on the other records; the first `plain` places are those without.
    """
    drops = np.zeros((2, white.problem.block_of_sample.max(initial=-1) + 1))
    for axis, (design, places) in designs.items():
        first = places < plain
        label, block = parts_of(axis), white.blocks(axis)
        for record, (without, extended) in coefficients.items():
            rows = label == record
            x, y = design[rows], targets[axis][rows]
            plain_torque, torque = x[:, first] @ without[places[first]], x @ extended[places]
            both = (y - plain_torque) ** 2 - (y - torque) ** 2, (torque - plain_torque) ** 2
            drops += [np.bincount(block[rows], square, minlength=drops.shape[1]) for square in both]
    return drops


def _of_block(white: White, designs: Designs, block: int, total: int) -> np.ndarray:
    """Return the sums of products (total + 1, total + 1) of one block of time; `designs` as of :func:`_drops`."""
    sums = np.zeros((total + 1, total + 1))
    for axis, (design, places) in designs.items():
        rows = white.blocks(axis) == block
        joint = np.column_stack([design[rows], white.targets[axis][rows]])
        where = np.append(places, total)
        sums[np.ix_(where, where)] += joint.T @ joint
    return sums


def lowered(drops: np.ndarray, changes: np.ndarray) -> float:
    """Return the probability that an effect lowers the squared error, from its drop in blocks of time (k,).

    Ranks over all blocks see that many of them gain. What acts in few, after reversals above all, is lost among those
    in which it changes nothing. A drop grows with the squared change of the prediction and scatters as its root, so the
    drop for each unit of change is asked too, with the scatter of all blocks. Student's t has the freedom of as many
    blocks as hold the change.

    Parameters
    ----------
    changes : (k,) squared change of the prediction; it does not know the errors.
    """
    d, c = drops[changes > 0], changes[changes > 0]
    acting = float(c.sum() ** 2 / np.sum(c**2)) if len(c) else 0.0
    if acting < 2.0:
        return positive(drops)
    rate = float(d.sum() / c.sum())
    scatter = float(np.sum((d - rate * c) ** 2 / c)) / (len(c) - 1)
    return max(positive(drops), float(stdtr(acting - 1.0, rate * np.sqrt(c.sum() / max(scatter, 1e-300)))))


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
    # The variance of that sum where half of the values lie above zero by chance.
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
