"""When to alarm: the growth of one axis over its last shifts against what shifts of normal operation do.

At every window, for the last K = 1 ... 6 shifts (the running one as far as it goes), z_K is the generalised
least-squares mean of the residuals of these shifts less :data:`TOLERATED`, over its standard error. The covariance
holds the windows' noise, the variance between shifts, and the error of the normal state, which all shifts share; each
shift counts by how far off the other axes are in it (:mod:`.shift_scale`). An axis alarms where

- the largest z_K over K >= 2 exceeds the threshold and the last two shifts both exceed :data:`TOLERATED`, or
- they do, and the last K shifts less those before them exceed a threshold of their own (friction that fell since the
  baseline, by running in, hides wear that begins from there; what is not known of the normal state they share), or
- z_1 does in a shift of at least :data:`STEP_WINDOWS` windows that exceeds :data:`STEP`: a large step is told at once,
  unless all axes move together in that shift: what one of them has beyond the others is then weather too.

A fall is the same with the sign turned; as nothing wears that falls, it waits for :data:`FALLEN` shifts. The threshold
is that of :mod:`.null_runs`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.dispersion import inflated
from jointwear.monitor.normal_state import Posterior
from jointwear.monitor.shifts import places_of_shifts, running_sums

#: Shifts looked back at; growth that is tolerated; growth and windows of a large step.
SHIFTS, TOLERATED, STEP, STEP_WINDOWS = 6, 0.001, 0.025, 6
#: Growth up to which friction that had alarmed counts as back to normal.
NORMAL = 0.002
#: Shifts looked back at in all where the last ones are held against those before; fewest of these.
BACK, FEWEST_BEFORE = 12, 3
#: Last shifts that must all lie below for a fall.
FALLEN = 3
#: Windows of a shift that scatter more than their noise show that their conditions are not all known; what is unknown
#: comes in runs (a program, a part, a speed), of which a shift holds no more than this many.
RUNS_IN_SHIFT = 2.0
#: Share of the variance of shared error and range that neighbouring shifts have in common: weather lasts for days.
CARRIED = 0.7


@dataclass(frozen=True)
class Evidence:
    """Of one axis, (w,): `growth` and `fall`, the largest admitted z (-inf where none is); `step`, the same of the last
    shifts less those before; `mean`, `std` of the generalised least-squares mean that `growth` (or, where larger,
    `fall`) comes from; `shifts` of that mean."""

    growth: np.ndarray
    fall: np.ndarray
    step: np.ndarray
    mean: np.ndarray
    std: np.ndarray
    shifts: np.ndarray


def shift_evidence(
    value: np.ndarray,
    variance: np.ndarray,
    design: np.ndarray,
    normal: Sequence[Posterior],
    which: np.ndarray,
    shift: np.ndarray,
    memory: float,
    between: np.ndarray,
    extra: np.ndarray,
    inside: np.ndarray,
    scale: np.ndarray,
    calm: np.ndarray,
) -> Evidence:
    """Return the evidence at every window.

    Parameters
    ----------
    value : (w,) log level less shared error; NaN where not judged. variance : (w,) noise of the windows.
    design : (w, p). normal : normal states. which : (w,) the one that holds at each window, by what was known then.
    shift : (w,) labels. memory : of windows within a shift. between : (w,) standard deviation between shifts.
    extra : (w,) variance that all windows of a shift share (shared error, range), and part of which carries on.
    inside : (w,) bool, at temperatures that the baseline had; a fall counts in shifts that mostly are.
    scale : (w,) factor of all variance of the shift of each window so far (:mod:`.shift_scale`).
    calm : (w,) bool, in shifts in which the axes have not moved together so far; elsewhere one shift is no large step.
    """
    w = len(value)
    means = np.stack([n.mean for n in normal])
    covariances = np.stack([n.covariance for n in normal])
    good = np.isfinite(value) & np.isfinite(variance)
    weight = np.where(good, 1.0 / np.where(good, variance, 1.0), 0.0)
    starts = np.concatenate([[True], np.diff(shift) != 0]) if w else np.zeros(0, dtype=bool)
    # Rows that are not judged may hold NaN in their design.
    clean = np.where(good[:, None], design, 0.0)
    total = running_sums(weight, starts)
    count = running_sums(good.astype(float), starts)
    safe = np.where(total > 0, total, 1.0)
    mean = running_sums(weight * np.where(good, value, 0.0), starts) / safe
    at = np.stack([running_sums(weight * clean[:, k], starts) for k in range(design.shape[1])], axis=1) / safe[:, None]
    shared = running_sums(weight * np.where(good, extra, 0.0), starts) / safe
    own = inflated(count, memory) / safe + shared
    odd = _unexplained(value - np.einsum("wp,wp->w", clean, means[which]), weight, count, starts)
    own += np.maximum(odd, _so_far(odd, count, starts)) / RUNS_IN_SHIFT
    usual = running_sums((good & inside).astype(float), starts) > 0.5 * count
    seen = total > 0
    place = places_of_shifts(shift, BACK + 4)
    order = _judged_first(place, seen)
    known = order >= 0
    index = np.maximum(order, 0)
    v, x = np.where(known, own[index] + between[:, None] ** 2, np.inf), at[index]
    r = mean[index] - np.einsum("wkp,wp->wk", x, means[which])
    fall = np.full(w, -np.inf)
    growth = np.full(w, -np.inf)
    best_mean, best_std, best_shifts = np.zeros(w), np.full(w, np.inf), np.zeros(w, dtype=int)
    both_up = known[:, 0] & known[:, 1] & (r[:, 0] > TOLERATED) & (r[:, 1] > TOLERATED)
    all_down = (known & (r < -TOLERATED) & usual[index])[:, :FALLEN].all(axis=1)
    carried = np.sqrt(CARRIED * shared[index])
    loud = np.sqrt(scale)[index]
    step = _steps(r, x, v, covariances, which, carried, known, both_up & good, loud)
    whole = _covariance(x[:, :SHIFTS], covariances, which) + carried[:, :SHIFTS, None] * carried[:, None, :SHIFTS]
    own_place = np.arange(SHIFTS)
    whole[:, own_place, own_place] += v[:, :SHIFTS] - carried[:, :SHIFTS] ** 2
    whole *= loud[:, :SHIFTS, None] * loud[:, None, :SHIFTS]
    for k in range(1, SHIFTS + 1):
        rows = np.flatnonzero(good & known[:, k - 1])
        if not len(rows):
            break
        c = whole[rows, :k, :k]
        solved = np.linalg.solve(c, np.ones((len(rows), k, 1)))[..., 0]
        information = solved.sum(axis=1)
        centre = np.einsum("wk,wk->w", solved, r[rows, :k]) / information
        error = 1.0 / np.sqrt(information)
        if k == 1:
            full = (count[rows] >= STEP_WINDOWS) & calm[rows]
            up, down = full & (centre > STEP), np.zeros(len(rows), dtype=bool)
        else:
            # A fall lasts: each of its shifts lies nearer to it than to what is normal.
            up, down = both_up[rows], all_down[rows] & (2 * r[rows, :FALLEN] < centre[:, None]).all(axis=1)
        rise = np.where(up, (centre - TOLERATED) / error, -np.inf)
        drop = np.where(down, (-centre - TOLERATED) / error, -np.inf)
        better = np.maximum(rise, drop) > np.maximum(growth[rows], fall[rows])
        fresh = better | ((best_shifts[rows] == k - 1) & ~np.isfinite(np.maximum(growth[rows], fall[rows])))
        best_mean[rows] = np.where(fresh, centre, best_mean[rows])
        best_std[rows] = np.where(fresh, error, best_std[rows])
        best_shifts[rows] = np.where(fresh, k, best_shifts[rows])
        growth[rows] = np.maximum(growth[rows], rise)
        fall[rows] = np.maximum(fall[rows], drop)
    return Evidence(growth, fall, step.max(axis=1), best_mean, best_std, best_shifts)


def _steps(
    r: np.ndarray,
    x: np.ndarray,
    v: np.ndarray,
    covariances: np.ndarray,
    which: np.ndarray,
    carried: np.ndarray,
    known: np.ndarray,
    rows: np.ndarray,
    loud: np.ndarray,
) -> np.ndarray:
    """Return z (w, SHIFTS) of the last K shifts less those before them; -inf where `rows` (w,) do not ask for it.

    Parameters
    ----------
    r, v : (w, BACK) residuals of shifts and their own variance. x : (w, BACK, p) their designs. covariances : of the
    normal states, `which` (w,) holds. carried : (w, BACK) standard deviations in common. known : (w, BACK) bool.
    loud : (w, BACK) factor of the standard deviations of each shift.
    """
    result = np.full((len(r), SHIFTS), -np.inf)
    rows = np.flatnonzero(rows & (known.sum(axis=1) >= 2 + FEWEST_BEFORE))
    if not len(rows):
        return result
    some = known[rows]
    c = _covariance(x[rows], covariances, which[rows])
    c += carried[rows][:, :, None] * carried[rows][:, None, :]
    both = some[:, :, None] & some[:, None, :]
    own = np.arange(BACK)
    c = np.where(both, c, 0.0)
    # A place without a shift is known to nothing.
    c[:, own, own] += np.where(some, v[rows] - carried[rows] ** 2, 1e6)
    c *= loud[rows][:, :, None] * loud[rows][:, None, :]
    precision = np.linalg.inv(c)
    moment = np.einsum("wij,wj->wi", precision, np.where(some, r[rows], 0.0))
    for k in range(2, SHIFTS + 1):
        old = some[:, k:].sum(axis=1) >= FEWEST_BEFORE
        a, b, d = (precision[:, i, j].sum(axis=(1, 2)) for i, j in _blocks(k))
        p, q = moment[:, :k].sum(axis=1), moment[:, k:].sum(axis=1)
        determinant = a * d - b**2
        difference = (d * p - b * q - a * q + b * p) / determinant
        error = np.sqrt((a + 2 * b + d) / determinant)
        result[rows, k - 1] = np.where(old, (difference - TOLERATED) / error, -np.inf)
    return result


def _covariance(x: np.ndarray, covariances: np.ndarray, which: np.ndarray) -> np.ndarray:
    """Return the covariance (w, k, k) of predictions for designs `x` (w, k, p) by the normal states `which` (w,)."""
    result = np.empty((len(x), x.shape[1], x.shape[1]))
    for state in np.unique(which):
        rows = np.flatnonzero(which == state)
        result[rows] = x[rows] @ covariances[state] @ np.swapaxes(x[rows], 1, 2)
    return result


def _blocks(k: int) -> tuple[tuple[slice, slice], ...]:
    """Return the blocks of the last `k` shifts, of these and those before, and of those before."""
    new, old = slice(0, k), slice(k, None)
    return (new, new), (new, old), (old, old)


def _unexplained(error: np.ndarray, weight: np.ndarray, count: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the variance (w,) by which the windows of a shift so far scatter more than their noise.

    Parameters
    ----------
    error : (w,) residuals. weight : (w,) 1 / variance, 0 where not judged. count : (w,) windows of the shift so far.

    Notes
    -----
    The estimator of DerSimonian and Laird (1986), less what chance adds to it by one standard deviation.
    """
    error = np.where(weight > 0, error, 0.0)
    total, square = running_sums(weight, starts), running_sums(weight**2, starts)
    safe = np.where(total > 0, total, 1.0)
    spread = running_sums(weight * error**2, starts) - running_sums(weight * error, starts) ** 2 / safe
    freedom = np.maximum(count - 1, 0.0)
    beyond = spread - freedom - np.sqrt(2 * freedom)
    scale = total - square / safe
    return np.where((freedom > 0) & (beyond > 0), beyond / np.where(scale > 0, scale, np.inf), 0.0)


def _so_far(odd: np.ndarray, count: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the mean (w,) of `odd` (w,) at the end of all shifts before, which may come to any shift; 0 before any.

    Parameters
    ----------
    count : (w,) windows of the shift so far; a shift of one says nothing. starts : (w,) bool.
    """
    last = np.flatnonzero(np.append(starts[1:], True)) if len(starts) else np.zeros(0, dtype=int)
    told = count[last] > 1
    total = np.concatenate([[0.0], np.cumsum(np.where(told, odd[last], 0.0))])
    shifts = np.concatenate([[0], np.cumsum(told)])
    before = np.cumsum(starts) - 1
    return total[before] / np.maximum(shifts[before], 1)


def _judged_first(place: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Return the places (w, BACK) with shifts that show nothing passed over, the running one kept first."""
    valid = (place >= 0) & seen[np.maximum(place, 0)]
    rank = np.argsort(~valid, axis=1, kind="stable")
    ordered = np.where(np.take_along_axis(valid, rank, 1), np.take_along_axis(place, rank, 1), -1)
    return ordered[:, :BACK]
