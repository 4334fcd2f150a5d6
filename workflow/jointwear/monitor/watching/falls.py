"""Falls of friction: which propose a service, which of them may be but its wander, and which have gone again.

Friction of healthy axes wanders: at :data:`FALL_RATE` it falls far enough for a question ten times as often as a joint
is greased. What is learnt within such a dip is no normal state, and the way back out of it no wear. So after a fall
that wander may be too (:func:`proposed`, `doubtful`) and that no event confirms, growth counts only as far as it would
without the fall (:func:`doubted`), and once friction is back at what was normal before, the fall counts no more
(:func:`gone_again`), nor a rise since then (:func:`after_dips`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.recent_shifts import BACK
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.watching.decision import NORMAL, SHIFTS, STEP_WINDOWS, Evidence
from jointwear.monitor.watching.watched_axis import Start

#: False falls per 1,000 h, whatever rate is stated: a fall proposes a service, and no rate may decide what is learnt.
FALL_RATE = 0.5
#: The same of falls that are as likely a service as wander: as often as makers have joints greased, every 20,000 h
#: (Nabtesco, manual of the RV-N series, 8.3.1; ABB, product manual of the IRB 460, 3.2.2).
CLEAR_RATE = 1.0 / 20.0


@dataclass(frozen=True)
class Dip:
    """A fall that has gone again: the window from which friction was low, and the last of the shifts by which it was
    known to be back at what was normal before."""

    window: int
    back: int


def proposed(
    evidence: Evidence,
    least: float,
    clear: float,
    shift: np.ndarray,
    baseline: np.ndarray,
    dips: Sequence[Dip] = (),
) -> tuple[int, Start] | None:
    """Return the first window after the baseline whose fall exceeds `least`, and the start at which it begins, doubtful
    unless within the shifts that evidence rests on it exceeds `clear` too; None where there is none.

    Nobody has to hurry for a fall: a shift tells of it by all its windows, of the running one those so far.

    Parameters
    ----------
    shift : (w,) labels. baseline : (w,) bool. dips : falls that have gone again, which propose nothing.
    """
    free, judged = after_baseline(baseline), np.isfinite(evidence.std)
    for dip in dips:
        free[dip.window : dip.back + 1] = False
    rows = np.flatnonzero(judged)
    ends = rows[np.append(np.diff(shift[rows]) != 0, True)] if len(rows) else rows
    hits = ends[(evidence.fall > least)[ends] & free[ends]]
    if not len(hits):
        return None
    hit = int(hits[0])
    begin = _begin_of_change(hit, int(evidence.shifts[hit]), shift, judged)
    since = max([int(np.argmax(after_baseline(baseline))), *(dip.back + 1 for dip in dips if dip.back < hit)])
    later = ends[ends >= hit][:SHIFTS]
    doubtful = not bool((evidence.fall[later] > clear).any())
    return hit, Start(max(begin, since), True, doubtful=doubtful)


def with_service(starts: Sequence[Start], hit: int, start: Start) -> list[Start] | None:
    """Return the starts of an axis with a service that shows at the window `hit`; None if it has one."""
    kept = [s for s in starts if s.window <= hit]
    if kept and kept[-1].window >= start.window:
        return None
    return [*kept, start, *(replace(s, grown=None) for s in starts if s.window > hit)]


def doubted(starts: Sequence[Start], windows: int) -> np.ndarray:
    """Return the windows (w,) after a fall that may be wander, up to the next start that is none, such as an event."""
    result = np.zeros(windows, dtype=bool)
    for start in starts:
        result[start.window :] = start.doubtful
    return result


def gone_again(starts: Sequence[Start], residual: np.ndarray, shift: np.ndarray) -> tuple[list[Start], list[Dip]]:
    """Return the starts of an axis that stay, and the falls that have gone again: those that may be wander, and after
    which two shifts in a row were as before, as an axis that alarmed counts as back.

    Parameters
    ----------
    residual : (w,) log level over the normal state that no doubtful fall has changed, NaN where not judged. shift :
    (w,) labels.
    """
    stay, dips = [], []
    edges = [*(s.window for s in starts), len(shift)]
    for k, start in enumerate(starts):
        stop = next(edges[i] for i in range(k + 1, len(edges)) if i == len(starts) or not starts[i].doubtful)
        back = _back(start.window, stop, residual, shift) if start.doubtful else None
        if back is None:
            stay.append(start)
        else:
            dips.append(Dip(start.window, back))
    return stay, dips


def after_dips(dips: Sequence[Dip], shift: np.ndarray) -> np.ndarray:
    """Return the windows (w,) of dips and of the shifts whose look back may reach one: against what was low for a while
    friction as normal has risen.

    Parameters
    ----------
    shift : (w,) labels.
    """
    result = np.zeros(len(shift), dtype=bool)
    place = np.unique(shift, return_inverse=True)[1]
    for dip in dips:
        result[dip.window :] |= place[dip.window :] < place[dip.back] + BACK
    return result


def _back(begin: int, stop: int, residual: np.ndarray, shift: np.ndarray) -> int | None:
    """Return the last window of the second of two shifts in a row, from `begin` to before `stop`, that are not below
    normal; None where there are none. The newest has as many windows as a large step takes, or as the one before."""
    rows = begin + np.flatnonzero(np.isfinite(residual[begin:stop]))
    names, place, count = np.unique(shift[rows], return_inverse=True, return_counts=True)
    if len(names) < 2:
        return None
    mean = np.bincount(place, residual[rows]) / count
    above = mean > -NORMAL
    above[1:] &= count[1:] >= np.minimum(STEP_WINDOWS, count[:-1])
    both = np.flatnonzero(above[1:] & above[:-1])
    return int(rows[np.flatnonzero(place == both[0] + 1)[-1]]) if len(both) else None


def _begin_of_change(window: int, shifts: int, shift: np.ndarray, judged: np.ndarray) -> int:
    """Return the first window of the shifts that the evidence at `window` rests on, of those that are `judged` (w,)."""
    names = np.unique(shift[judged])
    place = int(np.searchsorted(names, shift[window]))
    return int(np.argmax(shift == names[max(place - max(shifts, 1) + 1, 0)]))
