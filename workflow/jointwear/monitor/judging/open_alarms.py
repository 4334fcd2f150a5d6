"""Wear that stood, with or without an alarm, when somebody entered another program, which repairs nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointwear.files.shown_numbers import fixed
from jointwear.files.wording import listed, name_axes
from jointwear.monitor.events import Event
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.monitor.watching.limits import COULOMB, VISCOUS, in_sentence
from jointwear.monitor.watching.present import now_windows
from jointwear.monitor.watching.records import DETECTORS
from jointwear.monitor.watching.watching import Watch

#: Kinds of the findings: on an open alarm, and on growth for which none had been raised yet.
OPEN_ALARM, GROWN_BEFORE = "open_alarm", "grown_before"
#: Quantity of an alarm -> the estimate that has its growth in percent.
PERCENT = {COULOMB: "coulomb_percent", VISCOUS: "viscous_percent", BACKLASH: BACKLASH}


def open_alarm_findings(
    statistics: WindowStatistics,
    events: Sequence[Event],
    alarms: Sequence[Mapping[str, Any]],
    estimates: Mapping[str, np.ndarray],
) -> list[dict[str, Any]]:
    """Return one finding for each change of program that was entered while an axis had an open alarm.

    Parameters
    ----------
    events : of the config. alarms : rows of alarms.csv, `time` in seconds. estimates : name -> (w, n).
    """
    mending = [e for e in events if e.mends]
    result = []
    for event in (e for e in events if not e.mends):
        newest = {}
        for alarm in sorted(alarms, key=lambda a: a["time"]):
            axis = alarm["axis"]
            own = alarm["detector"] == DETECTORS[0] and axis and event.concerns(axis - 1)
            if own and event.follows(alarm, statistics.length):
                newest[axis] = alarm
        open_ones = {
            axis: alarm["quantity"]
            for axis, alarm in sorted(newest.items())
            if not any(
                e.concerns(axis - 1) and e.follows(alarm, statistics.length) and e.time <= event.time for e in mending
            )
        }
        if not open_ones:
            continue
        axes = list(open_ones)
        before = statistics.end <= event.time
        told = [_grown(estimates[PERCENT[q]][:, a - 1], q, before, statistics.end) for a, q in open_ones.items()]
        one = len(axes) == 1
        of, were, stay = ("An alarm", "was", "the alarm stays") if one else ("Alarms", "were", "these alarms stay")
        words = (
            f"{of} of {name_axes(axes)} {were} open when another program was entered here ({listed(told)} by "
            f"then). A program repairs no gear: {stay} open, and growth counts on from there, less what is gained over "
            "the shifts in which the axis is learnt anew. Enter a repair as 'service', or an alarm that has another "
            "cause as 'acknowledged'."
        )
        closed = all(any(e.concerns(a - 1) and e.time >= event.time for e in mending) for a in axes)
        answered = {"answered": True} if closed else {}
        result.append({"time": event.time, "axes": axes, "kind": OPEN_ALARM, "words": words, **answered})
    return result


def grown_before_findings(statistics: WindowStatistics, level: Watch) -> list[dict[str, Any]]:
    """Return one finding for each axis that had grown, without an alarm, when a change of program was entered: what it
    is judged against from then on holds that growth. Answered by an event that mends the axis, or by an alarm since."""
    result = []
    for j, starts in enumerate(level.starts):
        for start in (s for s in starts if s.left is not None):
            grown = level.axes[j].to_coulomb * float(np.expm1(start.left))
            words = (
                f"Friction of axis {j + 1} had risen, by about {fixed(100 * grown, 0, True)} % of its Coulomb part, "
                "when another program was entered here, too late for an alarm. A program repairs no gear, but what is "
                "normal is learnt anew with it: growth and limit count without that from here on. Look at the axis; "
                "enter a repair as 'service', or another cause as 'acknowledged'."
            )
            answered = any(later.closes and later.window >= start.window for later in starts)
            answered |= bool(level.alarm[start.window :, j].any())
            known = {"answered": True} if answered else {}
            time = float(statistics.start[start.window])
            result.append({"time": time, "axes": [j + 1], "kind": GROWN_BEFORE, "words": words, **known})
    return result


def _grown(growth: np.ndarray, quantity: str, before: np.ndarray, end: np.ndarray) -> str:
    """Return in words what `quantity` had grown by over the last day in which it was judged `before` (w,) an event.

    `growth` (w,) in percent; `end` (w,) of the windows [s].
    """
    known = np.flatnonzero(before & np.isfinite(growth))
    if not len(known):
        return in_sentence(quantity)
    rows = known[now_windows(end[known])]
    return f"{in_sentence(quantity)} {fixed(float(np.mean(growth[rows])), 0, True)} %"
