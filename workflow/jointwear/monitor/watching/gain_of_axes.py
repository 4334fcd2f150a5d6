"""A gain of the torque of some axes, told from friction and bodies as they are, before anything is learnt.

The normal state knows conditions of operation, and a gain looks like one: the gravity torque of its axis grows as with
a load. Where a robot repeats one cycle no window of the baseline had such a load, so that its axis is not judged, and
:mod:`.scale` has nothing to look at. But a gain multiplies friction and bodies of an axis by the same factor and leaves
those of the others, which neither wear nor a load does. Friction is told beside bodies that are free in every window:
where they are held, as they look like friction in the only cycle, a gain of them moves it too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointwear.monitor.normal.series import Series
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.regimes import beyond_usual, programs_or_one
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.scale import (
    AGAINST,
    FEWEST_TOGETHER,
    MOST,
    TOGETHER,
    ScaleStep,
    cut_beside,
    usual_before,
)
from jointwear.monitor.watching.shared_error import FINDING
from jointwear.statistics.known import known_median, known_rms

#: Least scatter of the medians of shifts, and how many shifts of the baseline tell it.
FLOOR, USUAL = 0.005, 2
#: By which share of it friction and bodies may differ from one factor; factors of two shifts in a row too.
SAME_FACTOR = 0.2


def gains_of_axes(
    friction: Series,
    scale: Series,
    regime: np.ndarray | None,
    shift: np.ndarray,
    baseline: np.ndarray,
    events: Sequence[Sequence[int]],
) -> list[ScaleStep]:
    """Return the first gain after the baseline of each axis that shows one in two shifts in a row, or has that of most.

    Parameters
    ----------
    friction, scale : of friction beside free bodies and of what moves the bodies, as logs. regime : (w,) program of
        each window, -1 unknown, or None for one. shift : (w,) labels. baseline : (w,) bool. events : for each axis the
        windows at which something was done to it, from the first of which on it is not held against before.
    """
    w, n = friction.value.shape
    program = programs_or_one(regime, w)
    names, place = np.unique(shift, return_inverse=True)
    early = np.array([baseline[place == a].all() for a in range(len(names))])
    if early.sum() < USUAL:
        return []
    after = after_baseline(baseline)
    late = np.array([after[place == a].any() for a in range(len(names))])
    rubs, moves = (beyond_usual(s.value, program, baseline) for s in (friction, scale))
    noise = [np.where(np.isfinite(s.variance), s.variance, np.inf) for s in (friction, scale)]
    (rubbed, rub_error), (moved, move_error) = (
        _of_shifts(values, variance, place, early) for values, variance in zip((rubs, moves), noise, strict=True)
    )
    levels = np.stack([rubbed, moved], axis=-1)
    errors = np.stack([rub_error, move_error], axis=-1)
    # Of a worn axis friction lies off its baseline already: the shifts before tell what a gain has added.
    pairs = [_pairs(levels, errors, late, usual) for usual in (np.zeros_like(levels), usual_before(levels))]
    found: list[ScaleStep] = []
    first: dict[int, int] = {}
    ends = [[k for k in own if not baseline[k]] for own in events]
    last = np.array([place[min(own)] if own else len(names) for own in ends])
    for j in range(n):
        until = max(last[j] - 1, 0)
        shown = [(int(np.argmax(p[0][:until, j])), k) for k, p in enumerate(pairs) if p[0][:until, j].any()]
        if shown:
            first[j], k = min(shown)
            size, usual = (x[first[j], j] for x in pairs[k][1:])
            first[j] = _since(first[j], float(size), levels[:, j] - usual, late)
            values = np.stack([rubs[:, j], moves[:, j]], axis=1) - usual
            spread = np.stack(
                [s[first[j], j] ** 2 + v[:, j] for s, v in zip((rub_error, move_error), noise, strict=True)], axis=1
            )
            begin = cut_beside(values, spread, float(size), shift, names[max(first[j] - 1, 0) : first[j] + 1], baseline)
            found.append(ScaleStep(j, begin, float(np.exp(size))))
    return _together(found, first, levels, errors, last)


def _since(a: int, size: float, levels: np.ndarray, late: np.ndarray) -> int:
    """Return the first of the shifts up to `a`, without a break, whose bodies have a gain of `size` already.

    Bodies show the same factor from the first day on. Friction that cold has raised meanwhile differs from it by more
    than one factor allows, and has only to be nearer to the gain than to none.

    Parameters
    ----------
    levels : (s, 2) of friction and bodies, beyond what they are held against. late : (s,) bool, after the baseline.
    """
    while a > 0 and late[a - 1]:
        rubbed, moved = levels[a - 1]
        if not (abs(moved - size) < SAME_FACTOR * abs(size) and rubbed / size > 0.5):
            break
        a -= 1
    return a


def _together(
    found: list[ScaleStep], first: dict[int, int], levels: np.ndarray, errors: np.ndarray, last: np.ndarray
) -> list[ScaleStep]:
    """Return the steps, with one that at least half of the axes show at once as a step of each axis that may have it.

    Its friction has to step alike, and its bodies must say nothing against: they may be light, or carry what changes.

    Parameters
    ----------
    first : the shift in which each axis of `found` begins. levels, errors : (s, n, 2) of friction and bodies. last :
        (n,) the shift with the first event of each axis after the baseline.
    """
    n = len(last)
    for one in found:
        a, size = first[one.axis], float(np.log(one.factor))
        then = (s for s in found if abs(first[s.axis] - a) <= 1)
        near = [s for s in then if abs(np.log(s.factor) - size) < SAME_FACTOR * abs(size)]
        if len(near) < max(FEWEST_TOGETHER, MOST * n):
            continue
        size = float(np.mean([np.log(s.factor) for s in near]))
        off = np.abs(levels[a : a + 2] - usual_before(levels)[a] - size)
        tolerated = np.maximum(SAME_FACTOR * abs(size), AGAINST * errors[a : a + 2])
        alike, against = (off < tolerated)[..., 0].all(axis=0), (off > tolerated)[..., 1].any(axis=0)
        window = int(np.median([s.window for s in near]))
        # An odd shift of one axis hides the begin of its step, though its bodies step beside those of the others.
        near += [
            s
            for s in found
            if first[s.axis] > a + 1 and abs(np.log(s.factor) - size) < SAME_FACTOR * abs(size) and not against[s.axis]
        ]
        own = {s.axis for s in near}
        rest = [j for j in range(n) if j not in own and alike[j] and not against[j] and last[j] > a + 1]
        others = [s for s in found if s.axis not in own | set(rest)]
        common = [replace(s, window=window) for s in near] + [ScaleStep(j, window, float(np.exp(size))) for j in rest]
        return sorted([*others, *common], key=lambda s: s.axis)
    return found


def _pairs(
    levels: np.ndarray, errors: np.ndarray, late: np.ndarray, usual: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return of each shift but the last whether (s - 1, n) it and the next show a gain, of which size, beyond what.

    Parameters
    ----------
    levels, errors : (s, n, 2) of friction and bodies. late : (s,) bool, shifts after the baseline. usual : (s, n, 2)
        what a shift and the next are held against.
    """
    usual = usual[:-1]
    shown, sizes, alone = [], [], _moved_alone(levels, errors)
    for rows in (slice(None, -1), slice(1, None)):
        rubbed, moved = np.moveaxis(levels[rows] - usual, -1, 0)
        rub_error, move_error = np.moveaxis(errors[rows], -1, 0)
        with np.errstate(invalid="ignore"):
            alike = np.abs(rubbed - moved) < np.maximum(SAME_FACTOR * np.abs(moved), AGAINST * rub_error)
            bodies = (np.abs(moved) > np.maximum(FINDING, TOGETHER * move_error)) & late[rows, None]
            both = bodies & alike & (np.abs(rubbed) > TOGETHER * rub_error) & (rubbed * moved > 0)
        # A load moves the bodies of several axes, and their friction by another share.
        loaded = (bodies & ~both).sum(axis=1) + 1 >= FEWEST_TOGETHER
        shown.append(both & ~loaded[:, None] & ~alone[rows])
        sizes.append(moved)
    first, second = sizes
    with np.errstate(invalid="ignore"):
        steady = shown[0] & shown[1] & (np.abs(second - first) < SAME_FACTOR * np.abs(second))
    return steady, (first + second) / 2, usual


def _moved_alone(levels: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Return of each shift (s, n) whether bodies lie as far off as they did before, with friction that did not, and
    came back from.

    A product moves the bodies of an axis each time that it comes, and cold may raise its friction by the same share
    once. A gain stays.

    Parameters
    ----------
    levels, errors : (s, n, 2) of friction and bodies.
    """
    (rubbed, moved), (rub_error, move_error) = np.moveaxis(levels, -1, 0), np.moveaxis(errors, -1, 0)
    found = np.zeros(moved.shape, dtype=bool)
    with np.errstate(invalid="ignore"):
        apart = np.abs(rubbed - moved) > np.maximum(SAME_FACTOR * np.abs(moved), AGAINST * rub_error)
        alone = apart & (np.abs(moved) > np.maximum(FINDING, AGAINST * move_error))
        for a in range(1, len(moved)):
            as_far = np.abs(moved[:a] - moved[a]) < SAME_FACTOR * np.abs(moved[a])
            back = np.abs(moved[:a]) < 0.5 * np.abs(moved[a])
            passed = np.cumsum(back[::-1], axis=0)[::-1] > 0
            found[a] = (alone[:a] & as_far & passed).any(axis=0)
    return found


def _of_shifts(
    values: np.ndarray, variance: np.ndarray, place: np.ndarray, early: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the medians (s, n) of shifts and their errors, from the scatter of those of the baseline and from noise.

    Parameters
    ----------
    values, variance : (w, n). place : (w,) of the shift of each window. early : (s,) bool, shifts of the baseline.
    """
    shifts = [values[place == a] for a in range(len(early))]
    middle = np.array([known_median(own, axis=0) for own in shifts])
    spread = np.array([known_median(variance[place == a], axis=0) for a in range(len(early))])
    scatter = np.maximum(known_rms(middle[early], USUAL), FLOOR)
    count = np.array([np.maximum(np.isfinite(own).sum(axis=0), 1) for own in shifts])
    return middle, np.sqrt(scatter**2 + spread / count)


def without_gain(
    statistics: WindowStatistics, step: ScaleStep, coulomb: np.ndarray, viscous: float
) -> WindowStatistics:
    """Return what the windows would hold if the torque of an axis had been divided by the factor of a step from its
    window on. The torque histogram, and what axes tell together of a zero, stay as they are.

    Parameters
    ----------
    coulomb : (2,) nominal levels of the axis [N m], both positive. viscous : [N m s/rad].
    """
    j, later, share = step.axis, slice(step.window, None), 1 / step.factor
    # The residual is what the nominal model leaves: the measured torque changes, the model does not.
    model = np.array([coulomb[0], coulomb[1], viscous, 1.0, 1.0])
    gram, moment = statistics.gram[later, j], statistics.moment[later, j]
    explained = gram @ model
    changed: dict[str, np.ndarray] = {}

    def put(name: str, values: np.ndarray) -> None:
        changed[name] = getattr(statistics, name).copy()
        changed[name][later, j] = values

    put("moment", share * moment + (share - 1) * explained)
    cross, whole = moment @ model, explained @ model
    square = share**2 * statistics.square[later, j] + 2 * share * (share - 1) * cross + (share - 1) ** 2 * whole
    put("square", np.maximum(square, 0.0))
    for name in ("residual_square", "lag_square", "score", "pulse_near", "pulse_far"):
        put(name, share**2 * getattr(statistics, name)[later, j])
    put("torque_peak", share * statistics.torque_peak[later, j])
    return replace(statistics, **changed)
