"""Events of the config that lie before what is judged, mostly a month or a year that was mistyped, or are yet to come.

Nothing is judged before the end of the baseline, so that such an event closes no alarm. One before the baseline changes
nothing at all; one within it leaves an axis the windows before it alone to learn from. One between the last window
before the baseline and its first is what the baseline begins after ('from'), and nothing to ask about. One that is yet
to come acts from its time on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.monitor.events import Event
from jointwear.monitor.findings.findings import moment_words
from jointwear.monitor.local_time import with_local_times, zone_of
from jointwear.monitor.reading.windows import WindowStatistics

#: Kinds of the findings; one that is so far ahead that its date is mistyped is told as one that is early.
EARLY_EVENT, PLANNED_EVENT = "early_event", "planned_event"


def early_event_findings(
    statistics: WindowStatistics, events: Sequence[Event], baseline: np.ndarray
) -> list[dict[str, Any]]:
    """Return one finding for each event before the end of the baseline: what it does, why, and what is allowed.

    Parameters
    ----------
    events : of the config, in order of time. baseline : (w,) bool; without any window nothing is told.
    """
    rows = np.flatnonzero(baseline)
    if not len(rows):
        return []
    begin, end = float(statistics.start[rows[0]]), float(statistics.end[rows[-1]])
    before = float(statistics.end[rows[0] - 1]) if rows[0] else np.inf
    result = []
    for event in (e for e in events if e.time < end and not before <= e.time <= begin):
        axes = [axis + 1 for axis in event.axes]
        of = f"{event.kind}, {name_axes(axes) if axes else 'all axes'}"
        told = f"The event of {moment_words(statistics, event.time)} ({of})"
        after = moment_words(statistics, end)
        if event.time <= begin:
            words = (
                f"{told} changes nothing: it lies before the baseline, which begins {moment_words(statistics, begin)}, "
                f"and nothing is judged before that ends, {after}. Is its month or year right? Give a time after "
                f"{after}, or take it out."
            )
        else:
            words = (
                f"{told} closes no alarm: it lies within the baseline, which ends {after}. What is normal is learnt of "
                "what came before it alone, and learnt anew after it. Is its day or month right? Give a time after "
                f"{after}, or let the baseline begin after it ('from')."
            )
        result.append({"time": None, "axes": axes, "kind": EARLY_EVENT, "words": words})
    return result


def planned_event_findings(statistics: WindowStatistics, planned: Sequence[tuple[Event, bool]]) -> list[dict[str, Any]]:
    """Return one finding for each event that is yet to come; `planned`: as of
    :func:`~jointwear.monitor.events.planned_events`."""
    result = []
    for event, far in planned:
        axes = [axis + 1 for axis in event.axes]
        words = (
            f"The event of {moment_words(statistics, event.time)} ({event.kind}, "
            f"{name_axes(axes) if axes else 'all axes'}) is yet to come: it closes no alarm until then."
        )
        if far:
            words += " It is more than a year ahead: is its year a typo? Give the time at which it was done."
        result.append({"time": None, "axes": axes, "kind": EARLY_EVENT if far else PLANNED_EVENT, "words": words})
    return result


def early_events(findings: Sequence[Mapping[str, Any]], time_zone: str | None) -> list[str]:
    """Return the words of those findings that are on events which close nothing, with times of a zone (IANA name; None
    is UTC)."""
    zone = zone_of(time_zone)
    kinds = (EARLY_EVENT, PLANNED_EVENT)
    return [with_local_times(found["words"], zone) for found in findings if found["kind"] in kinds]
