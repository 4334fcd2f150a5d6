"""A changed scale of the measured torque: gain of a current sensor, a unit, a torque constant.

Wear leaves the torque that moves the rigid bodies as it is; a changed scale multiplies it by the same factor as the
friction. The share by which gravity and inertial torque together differ from the model's is held against its own
normal state, as friction is; where friction steps and this share steps with it, the scale has changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.estimate import COLUMNS, Sums, column_estimate
from jointwear.monitor.normal.series import Series
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.watching.watching import Watch
from jointwear.statistics.known import known_median

#: A scale explains growth where the growth is likelier as its step than as no step of it by this log likelihood ratio;
#: smallest step. Of a second axis the factors are alike within this share, a third contradicts that many errors off.
LIKELIER, LEAST, SAME_SCALE, AGAINST = 1.0, 0.01, 0.5, 2.5
#: A step of all scales together needs so many standard errors in two shifts in a row, and at least so many axes.
TOGETHER, FEWEST_TOGETHER = 4.0, 3
#: Share of the axes whose friction must step with it: a load or a program moves the bodies of all axes alone.
MOST = 0.5
#: Shifts whose median a step is held against: friction that fell or rose long before is no part of it.
BEFORE = 3
#: Change of the gravity torque, as a share, below which hardly anything of it is left: no scale is told from that.
LEAST_LEFT = -0.9
_GRAVITY, _INERTIAL = COLUMNS.index("gravity"), COLUMNS.index("inertial")
#: Standard deviation of a window's scale above which it shows nothing.
COARSEST = 0.25


@dataclass(frozen=True)
class ScaleStep:
    """The scale of a 0-based `axis` changed by `factor` at `window`."""

    axis: int
    window: int
    factor: float


def scale_series(sums: Sums, pooled: np.ndarray) -> Series:
    """Return the log of the scale of the rigid-body torque, window by window; `pooled` (n,) noise variance [N2 m2]."""
    n = sums.gram.shape[-3]
    change = np.broadcast_to(np.eye(5), (n, 5, 5)).copy()
    change[:, _INERTIAL, _GRAVITY] = 1.0
    joined = Sums(
        np.einsum("nji,wnjk,nkl->wnil", change, sums.gram, change),
        np.einsum("nji,wnj->wni", change, sums.moment),
        sums.residual_square,
        sums.freedom,
        sums.usable,
    )
    free = np.ones((n, len(COLUMNS)), dtype=bool)
    free[:, _INERTIAL] = False
    value, variance = column_estimate(joined, np.zeros((n, len(COLUMNS))), free, pooled, _GRAVITY)
    with np.errstate(invalid="ignore"):
        known = (variance > 0) & (variance < COARSEST**2) & (value > LEAST_LEFT)
        logs = np.where(known, np.log1p(np.where(known, value, 0.0)), np.nan)
    spread = np.where(known, variance / (1 + np.where(known, value, 0.0)) ** 2, np.nan)
    return Series(logs, spread, np.ones(n), np.ones(n))


def scale_steps(level: Watch, plain: Watch, scale: Watch, shift: np.ndarray, baseline: np.ndarray) -> list[ScaleStep]:
    """Return the first alarm or fall of each axis that a step of its scale explains.

    Where the scale of two axes steps at once, or the friction of another axis by as much, a common cause (unit, supply,
    cabinet) is likely: axes whose own scale says nothing against the same factor take it over.

    Parameters
    ----------
    level, scale : what was watched. plain : the level with what all axes have in common, no service assumed.
    shift : (w,) labels. baseline : (w,) bool.
    """
    found = []
    for j, axis in enumerate(level.axes):
        if axis is None or scale.axes[j] is None:
            continue
        hits = [(int(k), 1.0) for k in np.flatnonzero(level.alarm[:, j])[:1]]
        fallen = [*(s.window for s in level.starts[j] if s.proposed), *(dip.window for dip in level.dips[j])]
        hits += [(k, -1.0) for k in sorted(fallen)[:1]]
        for k, sign in sorted(hits):
            begin = k if sign < 0 else _begin(level, k, j, shift)
            # A changed scale lasts. The windows up to an alarm are few and of like conditions, whose error they share.
            rows = slice(begin, _end(k, shift))
            step, error = mean_residual(scale, rows, j, shift)
            size = mean_residual(level, slice(begin, k + 1), j, shift)[0] if sign > 0 else step
            steps = np.isfinite(step) and sign * step > LEAST and _evidence(step, size, error) > LIKELIER
            if steps and not _grows_on(plain, rows, j, shift, step) and not _of_a_load(plain, scale, rows, j, shift):
                found.append(ScaleStep(j, begin, float(np.exp(step))))
                break
    return _common(plain, scale, shift, baseline) or found + _joined(found, level, scale, shift)


def _grows_on(plain: Watch, rows: slice, j: int, shift: np.ndarray, step: float) -> bool:
    """Return whether friction of the 0-based axis `j` goes on growing over the shifts of `rows`, beyond its error and
    by half of a `step` of its scale: a gain holds, and wear that begins as if it were one does not.
    """
    place = np.arange(rows.start, rows.stop)
    (before, error), (after, spread) = (
        mean_residual(plain, place[shift[place] == shift[k]], j, shift) for k in (place[0], place[-1])
    )
    return bool(after - before > max(AGAINST * np.hypot(error, spread), SAME_SCALE * abs(step)))


def _of_a_load(plain: Watch, scale: Watch, rows: slice, own: int, shift: np.ndarray) -> bool:
    """Return whether what moves the bodies of the 0-based axis `own` is another load: it moves those of others too.

    Of at least :data:`FEWEST_TOGETHER` axes, with `own`, the scale steps then, and the friction of others does not step
    with it, as it would if their torque had another scale. Bodies of others that move the opposite way speak for the
    scale of `own`: a load is estimated from all axes, and takes some of a gain of one of them for a lighter one.
    """
    others, mine = 0, mean_residual(scale, rows, own, shift)[0]
    for j, axis in enumerate(plain.axes):
        if j == own or axis is None or scale.axes[j] is None:
            continue
        (moved, error), (rubbed, spread) = (mean_residual(w, rows, j, shift) for w in (scale, plain))
        clear = mine * moved > 0 and abs(moved) > max(LEAST, AGAINST * error)
        others += bool(clear and abs(moved - rubbed) > AGAINST * np.hypot(error, spread))
    return others + 1 >= FEWEST_TOGETHER


def _common(plain: Watch, scale: Watch, shift: np.ndarray, baseline: np.ndarray) -> list[ScaleStep]:
    """Return a step that the scales of all axes show together, whether any of them has alarmed or not: a supply, a
    cabinet or a unit. Two shifts in a row must show it, and the friction of most axes; every axis whose own scale does
    not contradict it has it."""
    n = len(plain.axes)
    named = [j for j in range(n) if scale.axes[j] is not None]
    if len(named) < FEWEST_TOGETHER:
        return []
    after = after_baseline(baseline)
    names = np.unique(shift[after])
    means = np.full((len(names), len(named), 2), np.nan)
    friction = np.full((len(names), n), np.nan)
    for a, s in enumerate(names):
        rows = (shift == s) & after
        means[a] = [mean_residual(scale, rows, j, shift) for j in named]
        friction[a] = [np.nan if plain.axes[j] is None else mean_residual(plain, rows, j, shift)[0] for j in range(n)]
    with np.errstate(invalid="ignore"):
        weight = np.where(np.isfinite(means[..., 0]), means[..., 1] ** -2.0, 0.0)
        total = weight.sum(axis=1)
        size = (weight * np.nan_to_num(means[..., 0])).sum(axis=1) / np.maximum(total, 1e-300)
        clear = (np.abs(size) * np.sqrt(total) > TOGETHER) & (np.abs(size) > LEAST)
        clear &= (weight > 0).sum(axis=1) >= FEWEST_TOGETHER
        apart = np.abs(means[..., 0] - size[:, None]) > AGAINST * means[..., 1]
        alike = np.abs(friction - size[:, None]) < SAME_SCALE * np.abs(size)[:, None]
    clear &= (apart & (weight > 0)).sum(axis=1) <= len(named) // 3
    clear &= alike.sum(axis=1) > MOST * np.isfinite(friction).sum(axis=1)
    a = first_pair(clear, size)
    if a is None:
        return []
    value, variance = scale.residual[:, named], scale.noise[:, named]
    begin = cut_beside(value, variance, float(size[a + 1]), shift, names[max(a - 1, 0) : a + 1], baseline)
    factor = float(np.exp(size[a + 1]))
    against = {j for k, j in enumerate(named) if apart[a : a + 2, k].all()}
    return [ScaleStep(j, begin, factor) for j in range(n) if plain.axes[j] is not None and j not in against]


def first_pair(shown: np.ndarray, size: np.ndarray) -> int | None:
    """Return the first shift that, with the next, is `shown` (s,) to step to the same side; None where none is."""
    pairs = shown[1:] & shown[:-1] & (np.sign(size[1:]) == np.sign(size[:-1]))
    return int(np.argmax(pairs)) if pairs.any() else None


def _evidence(step: float, size: float, error: float) -> float:
    """Return the log likelihood ratio of a scale that stepped by `size` over one that stayed."""
    return (step**2 - (step - size) ** 2) / (2 * error**2)


def _joined(found: Sequence[ScaleStep], level: Watch, scale: Watch, shift: np.ndarray) -> list[ScaleStep]:
    more = []
    for one in found:
        near = [s for s in found if abs(int(shift[s.window]) - int(shift[one.window])) <= 1]
        near = [s for s in near if abs(np.log(s.factor / one.factor)) < SAME_SCALE * abs(np.log(one.factor))]
        if one is not near[0]:
            continue
        size = float(np.mean([np.log(s.factor) for s in near]))
        for j, axis in enumerate(level.axes):
            if axis is None or any(s.axis == j for s in near):
                continue
            rows = slice(one.window, _end(one.window, shift))
            steps = [mean_residual(w, rows, j, shift) for w in (scale, level) if w.axes[j] is not None]
            # One axis alone is no common cause, unless the friction of another steps with it by as much.
            if len(near) < 2 and not abs(steps[-1][0] - size) < SAME_SCALE * abs(size):
                continue
            if all(not np.isfinite(step) or abs(step - size) < AGAINST * error for step, error in steps):
                more.append(ScaleStep(j, one.window, float(np.exp(size))))
    return more


def _begin(level: Watch, k: int, j: int, shift: np.ndarray) -> int:
    """Return the first window of the shift from which on a step explains the level best, up to window `k`.

    The decision looks back over few shifts; a step of the scale that was too small to alarm may be older.
    """
    after = max([s.window for s in level.starts[j] if s.window <= k], default=0)
    known = np.flatnonzero(np.isfinite(level.residual[: k + 1, j]) & after_baseline(level.baseline)[: k + 1])
    known = known[known >= after]
    names = np.unique(shift[known])
    means = np.array([mean_residual(level, known[shift[known] == s], j, shift) for s in names])
    good = np.isfinite(means[:, 0])
    if not good.any():
        return k
    names, means = names[good], means[good]
    weight = means[:, 1] ** -2.0
    # Of the shifts from each one on: square of the weighted sum over the sum of weights.
    total, moment = (np.cumsum(x[::-1])[::-1] for x in (weight, weight * means[:, 0]))
    best = int(np.argmax(np.where(moment > 0, moment**2 / total, -np.inf)))
    later = min(best + 1, len(names) - 1)
    part = known[shift[known] == names[best]]
    value, variance = level.residual[part, j][:, None], level.noise[part, j][:, None]
    return int(part[cut_of(value, variance, float(moment[later] / total[later]))])


def cut_of(value: np.ndarray, variance: np.ndarray, size: float) -> int:
    """Return the window from which on residuals (w, k) are likelier `size` than zero, windows before it the reverse."""
    weight = np.where(np.isfinite(value), 1.0 / variance, 0.0)
    gain = (weight * (2 * np.nan_to_num(value) * size - size**2)).sum(axis=1)
    return int(np.argmax(np.cumsum(gain[::-1])[::-1]))


def cut_beside(
    value: np.ndarray, variance: np.ndarray, size: float, shift: np.ndarray, names: np.ndarray, baseline: np.ndarray
) -> int:
    """Return the window after the `baseline` (w,) from which on residuals (w, k) are likelier `size` than zero.

    Parameters
    ----------
    names : labels in `shift` (w,) of the one that shows the step and of the one before: the step itself may lie within
        a shift, which shows it in part.
    """
    rows = np.flatnonzero(np.isin(shift, names) & after_baseline(baseline))
    return int(rows[cut_of(value[rows], variance[rows], size)])


def _end(k: int, shift: np.ndarray) -> int:
    names = np.unique(shift[k:])[:3]
    return int(np.flatnonzero(shift == names[-1])[-1]) + 1


def mean_residual(watched: Watch, rows: slice | np.ndarray, j: int, shift: np.ndarray) -> tuple[float, float]:
    """Return the mean residual of the 0-based axis `j` over windows and its standard error.

    In the error each shift counts as one, however many windows it has.
    NaN and infinite where fewer than two `rows` are judged; `shift` (w,) labels.
    """
    value, variance, label = watched.residual[rows, j], watched.noise[rows, j], shift[rows]
    good = np.isfinite(value)
    if good.sum() < 2:
        return np.nan, np.inf
    weight = 1.0 / variance[good]
    axis = watched.axes[j]
    normal = float(known_median(axis.fit.left_out_variance))
    error = np.sqrt(1.0 / weight.sum() + axis.dispersion.between**2 / len(np.unique(label[good])) + normal)
    return float(weight @ value[good] / weight.sum()), float(error)


def shift_steps(
    watched: Watch, axes: list[int], names: np.ndarray, shift: np.ndarray, unknown: float = np.nan
) -> tuple[np.ndarray, np.ndarray]:
    """Return what was usual (s, n) before each shift of `names` (s,), its median over :data:`BEFORE` of them, and the
    step from there (s, n, 2) with the error of the shift, NaN on axes that are not of `axes`.

    Parameters
    ----------
    unknown : what was usual where none of the shifts before is judged.
    """
    n = len(watched.axes)
    means = np.full((len(names), n, 2), np.nan)
    for a, s in enumerate(names):
        for j in axes:
            means[a, j] = mean_residual(watched, shift == s, j, shift)
    usual = usual_before(means[..., 0])
    usual[np.isnan(usual)] = unknown
    return usual, np.stack([means[..., 0] - usual, means[..., 1]], axis=-1)


def usual_before(values: np.ndarray) -> np.ndarray:
    """Return what was usual before each shift: the median of `values` (s, ...) over :data:`BEFORE` shifts before it."""
    usual = np.full(values.shape, np.nan)
    for a in range(1, len(values)):
        usual[a] = known_median(values[max(a - BEFORE, 0) : a], axis=0)
    return usual
