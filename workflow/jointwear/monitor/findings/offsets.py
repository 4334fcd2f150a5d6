"""An offset of the torque of one axis that carries gravity, the same in both directions of motion.

It is neither friction in the mean of both directions nor a load, which shows on several axes: a torque sensor whose
zero drifts, or friction that grows in one direction of motion more than in the other. The judgement counts no part of
it, so that it has to be told.

A zero is off in every program alike. Friction is not: what the model of friction lacks (presliding, other friction
under load, other speeds one way than back) grows with it, and where gravity hardly varies that is told as a constant,
another one in each program. So programs have to agree, and beside friction that grows an offset has to be the larger of
the two: no growth of friction, nor one in a single direction, is off by more than it grows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.shown_numbers import number
from jointwear.files.wording import name_axes
from jointwear.monitor.findings.spells import spell_finding, spells
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.regimes import beyond_usual, programs_or_one
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Kind of the finding.
OFFSET = "offset"
#: Smallest offset that is told, as a share of the friction at the usual speed; how many times the largest of a shift of
#: the baseline it is; and the share of these limits that another axis reaches where a load may be the cause. Of 72
#: robots of the thirty-second fleet, with parts and loads that come and go, none shows that, nor 0.05.
LEAST, TIMES, ALONE = 0.08, 4.0, 0.5
#: Shifts in a row that show it, and windows of each; fewest shifts of the baseline.
SHIFTS, WINDOWS, FEWEST_SHIFTS = 3, 3, 3

_WORDS = (
    "The torque of {axes} is off by {size} N m, {percent} % of its friction, in both directions of motion alike, and "
    "that of no other axis is: the zero of its torque drifts, or its friction grows in one direction of motion more "
    "than in the other. The offset counts as no friction; what that grew by in the mean of both is judged as before."
)


def offset_findings(
    statistics: WindowStatistics,
    offset: np.ndarray,
    friction: np.ndarray,
    regime: np.ndarray | None,
    shift: np.ndarray,
    baseline: np.ndarray,
    events: Sequence[Sequence[int]],
    growth: np.ndarray | None = None,
) -> list[dict[str, Any]]:
    """Return one finding for each spell of shifts after the baseline in which one axis alone has another offset.

    Parameters
    ----------
    offset : (w, n) constant torque [N m], NaN unknown. friction : (n,) at the usual speed in the baseline [N m].
    regime : (w,) program of each window, -1 unknown, or None for one. shift : (w,) labels. baseline : (w,) bool.
    events : for each axis the windows of the events that a user entered; one after the begin answers it.
    growth : (w, n) of friction, as a share, NaN where not judged, default none.
    """
    program = programs_or_one(regime, statistics.windows)
    size = np.where(friction > 0, friction, np.nan)
    change = beyond_usual(offset / size, program, baseline)
    early = [_middle(change[(shift == s) & baseline]) for s in np.unique(shift[baseline])]
    after = after_baseline(baseline)
    rows = [np.flatnonzero((shift == s) & after) for s in np.unique(shift[after])]
    if not early or not rows:
        return []
    usual = np.abs(np.array(early))
    with np.errstate(invalid="ignore"):
        limit = np.maximum(LEAST, TIMES * np.fmax.reduce(usual, axis=0))
    limit[np.isfinite(usual).sum(axis=0) < FEWEST_SHIFTS] = np.nan
    now = np.array([_agreed(change, program, rows[max(k - SHIFTS + 1, 0) : k + 1]) for k in range(len(rows))])
    grown = np.zeros(now.shape) if growth is None else np.nan_to_num([_middle(growth[own]) for own in rows])
    over = now / np.maximum(limit, grown)
    found = []
    for j in range(statistics.axes):
        others = np.nan_to_num(np.abs(np.delete(over, j, axis=1))).max(axis=1, initial=0.0)
        for sign in (1.0, -1.0):
            for part in spells((sign * np.nan_to_num(over[:, j]) > 1) & (others < ALONE), SHIFTS):
                own = np.concatenate(rows[part])
                share = float(now[part][-1, j])
                words = _WORDS.format(
                    axes=name_axes([j + 1]), size=number(share * size[j], 2), percent=number(100 * abs(share), 2)
                )
                found.append(spell_finding(statistics, own, [j + 1], OFFSET, words, [events[j]]))
    return found


def _agreed(change: np.ndarray, program: np.ndarray, shifts: Sequence[np.ndarray]) -> np.ndarray:
    """Return by how much each axis is off (n,) in the last of `shifts`, by the program of it that shows the least: none
    where one of the programs that ran in these shifts shows the other sign, NaN where too few windows are known.

    Parameters
    ----------
    change : (w, n). program : (w,). shifts : windows of the last shifts, the newest last.
    """
    newest, recent = shifts[-1], np.concatenate(shifts)
    told = []
    for name in np.unique(program[recent]):
        value, before = (_middle(change[rows[program[rows] == name]]) for rows in (newest, recent))
        told.append(np.where(np.isfinite(value), value, before))
    every = np.array(told)
    with np.errstate(all="ignore"):
        least, most = np.fmin.reduce(every, axis=0), np.fmax.reduce(every, axis=0)
        agreed = np.where(least > 0, least, np.where(most < 0, most, 0.0))
    return np.where(np.isfinite(_middle(change[newest])), agreed, np.nan)


def _middle(values: np.ndarray) -> np.ndarray:
    """Return the median of each column of windows (k, n), NaN where too few are known."""
    with np.errstate(all="ignore"):
        return np.where(np.isfinite(values).sum(axis=0) >= WINDOWS, known_median(values, axis=0), np.nan)
