"""Growth of an axis with an open alarm that stands still below its limit: no date is one of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from jointwear.monitor.events import Event
from jointwear.monitor.findings.findings import moment_words
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.limits import LimitDate, in_sentence
from jointwear.monitor.watching.records import DETECTORS

#: Kind of the finding.
STANDSTILL = "standstill"


def standstill_findings(
    statistics: WindowStatistics,
    limits: Sequence[LimitDate | None],
    alarms: Sequence[Mapping[str, Any]] = (),
    events: Sequence[Event] = (),
) -> list[dict[str, Any]]:
    """Return a finding on each axis with an open alarm whose growth stands still.

    Parameters
    ----------
    limits : of each axis, None where no date is due. alarms : rows of alarms.csv, `time` in seconds. events : of the
    config. Where the first alarm since the last repair came after the standstill began, it is told so.
    """
    result = []
    for j, limit in enumerate(limits):
        if limit is None or math.isnan(limit.still):
            continue
        since = limit.still
        words = (
            f"Growth of the {in_sentence(limit.quantity)} of axis {j + 1} has stood still since about "
            f"{moment_words(statistics, since)}{_late_alarm(statistics, since, _first_alarm(j, alarms, events))}: it "
            "may never reach its limit. What made it grow began and stopped, or is a drift that this axis has anyway; "
            "should it go on, its limit is given a date again."
        )
        result.append({"time": since, "axes": [j + 1], "kind": STANDSTILL, "words": words})
    return result


def _first_alarm(j: int, alarms: Sequence[Mapping[str, Any]], events: Sequence[Event]) -> float:
    """Return when a 0-based axis first alarmed since its last repair [s], infinite where it did not."""
    begin = max((e.time for e in events if e.mends and e.concerns(j)), default=-math.inf)
    own = [float(a["time"]) for a in alarms if a["axis"] == j + 1 and a["detector"] == DETECTORS[0]]
    return min((time for time in own if time > begin), default=math.inf)


def _late_alarm(statistics: WindowStatistics, since: float, first: float) -> str:
    """Return in words why the `first` alarm [s] came after growth stood still, empty where it did not."""
    if not since < first < math.inf:
        return ""
    return (
        f", before its first alarm at {moment_words(statistics, first)} (it took until then to be sure of growth so "
        "small)"
    )
