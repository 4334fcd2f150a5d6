"""A gain of the torque of some axes, told from friction and bodies as they are, before anything is learnt.

The normal state knows conditions of operation, and a gain looks like one: the gravity torque of its axis grows as with
a load. Where a robot repeats one cycle no window of the baseline had such a load, so that its axis is not judged, and
:mod:`.scale` has nothing to look at. But a gain multiplies friction and bodies of an axis by the same factor and leaves
those of the others, which neither wear nor a load does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointwear.monitor.normal.series import Series
from jointwear.monitor.reading.regimes import beyond_usual, programs_or_one
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.scale import AGAINST, FEWEST_TOGETHER, TOGETHER, ScaleStep, cut_beside
from jointwear.monitor.watching.shared_error import FINDING
from jointwear.statistics.known import known_median, known_rms

#: Least scatter of the medians of shifts, and how many shifts of the baseline tell it.
FLOOR, USUAL = 0.005, 2
#: By which share of it friction and bodies may differ from one factor; factors of two shifts in a row too.
ALIKE = 0.2


def gains_of_axes(
    friction: Series,
    scale: Series,
    regime: np.ndarray | None,
    shift: np.ndarray,
    baseline: np.ndarray,
    events: Sequence[Sequence[int]],
) -> list[ScaleStep]:
    """Return the first gain after the baseline of each axis that shows one in two shifts in a row.

    Parameters
    ----------
    friction, scale : of friction and of what moves the bodies, as logs. regime : (w,) program of each window, -1
        unknown, or None for one. shift : (w,) labels. baseline : (w,) bool. events : for each axis the windows at which
        something was done to it, from the first of which on it is not held against before.
    """
    w, n = friction.value.shape
    program = programs_or_one(regime, w)
    names, place = np.unique(shift, return_inverse=True)
    early = np.array([baseline[place == a].all() for a in range(len(names))])
    if early.sum() < USUAL:
        return []
    rubs, moves = (beyond_usual(s.value, program, baseline) for s in (friction, scale))
    noise = [np.where(np.isfinite(s.variance), s.variance, np.inf) for s in (friction, scale)]
    (rubbed, rub_error), (moved, move_error) = (
        _of_shifts(values, variance, place, early) for values, variance in zip((rubs, moves), noise, strict=True)
    )
    with np.errstate(invalid="ignore"):
        alike = np.abs(rubbed - moved) < np.maximum(ALIKE * np.abs(moved), AGAINST * rub_error)
        bodies = (np.abs(moved) > np.maximum(FINDING, TOGETHER * move_error)) & ~early[:, None]
        both = bodies & alike & (np.abs(rubbed) > TOGETHER * rub_error) & (rubbed * moved > 0)
    # A load moves the bodies of several axes, and their friction by another share.
    loaded = (bodies & ~both).sum(axis=1) + 1 >= FEWEST_TOGETHER
    both &= ~loaded[:, None]
    found = []
    for j in range(n):
        ends = [k for k in events[j] if not baseline[k]]
        last = place[min(ends)] if ends else len(names)
        steady = both[1:last, j] & both[: max(last - 1, 0), j]
        with np.errstate(invalid="ignore"):
            steady &= np.abs(np.diff(moved[:last, j])) < ALIKE * np.abs(moved[1:last, j])
        if steady.any():
            a = int(np.argmax(steady))
            size = float(np.median(moved[a : a + 2, j]))
            values = np.stack([rubs[:, j], moves[:, j]], axis=1)
            spread = np.stack([rub_error[a, j] ** 2 + noise[0][:, j], move_error[a, j] ** 2 + noise[1][:, j]], axis=1)
            begin = cut_beside(values, spread, size, shift, names[max(a - 1, 0) : a + 1], baseline)
            found.append(ScaleStep(j, begin, float(np.exp(size))))
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
