"""Which findings somebody has to answer, or to mend while they last: what a page and a fleet show before all others."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from jointwear.monitor.findings.findings import AT_ONCE, FELL, PROGRAM, SHARED
from jointwear.monitor.findings.greasing import GREASED
from jointwear.monitor.findings.loud import LOUD, LOUD_PROGRAM, SMOOTH, UNEVEN
from jointwear.monitor.findings.misfits import MISFIT
from jointwear.monitor.findings.missed_torque import BASE
from jointwear.monitor.findings.odd_motion import CLOCK_SPEED, EXCHANGED, STOPPED
from jointwear.monitor.findings.offsets import OFFSET
from jointwear.monitor.findings.read_findings import DRIVES, NONE, ROUNDED, SCATTERED
from jointwear.monitor.findings.seen_growth import COARSE, LOOSE, MISSED
from jointwear.monitor.findings.thermometers import BROKEN
from jointwear.monitor.judging.baseline import ELSEWHERE
from jointwear.monitor.judging.open_alarms import GROWN_BEFORE, OPEN_ALARM
from jointwear.monitor.normal.override import OVERRIDE
from jointwear.monitor.reading.zeros import ZERO

#: Kind of a finding on logs that are dated ahead of now.
AHEAD = "dated_ahead"
#: Kinds of findings that somebody has to answer, though no axis has alarmed.
ASKING = (AHEAD, ELSEWHERE, OPEN_ALARM, GROWN_BEFORE, "scale", "clock", FELL, AT_ONCE, GREASED, LOUD, ZERO, MISFIT)
#: Kinds that somebody has to look for while they last: an axis whose torque or position is none, day after day, is not
#: healthy, and a thermometer that shows none hides what it was to explain.
WHILE_IT_LASTS = (
    "contradicted",
    *NONE,
    DRIVES,
    UNEVEN,
    SMOOTH,
    CLOCK_SPEED,
    STOPPED,
    EXCHANGED,
    BROKEN,
    OFFSET,
    SCATTERED,
    *ROUNDED,
)
#: Kinds that only tell how a robot ran and what of it is judged, unless they name logs to look at.
TELLING = (PROGRAM, LOUD_PROGRAM, OVERRIDE, SHARED, COARSE, LOOSE, MISSED, BASE)


def asks_for_answer(found: Mapping[str, Any]) -> bool:
    """Return whether somebody has to answer a finding: its kind asks, no event has answered it, and it is none that is
    `unsure`, of which nobody may have done anything."""
    return found["kind"] in ASKING and not found.get("answered") and not found.get("unsure")


def lasts(found: Mapping[str, Any], row: Mapping[str, Any]) -> bool:
    """Return whether a finding that somebody has to look for is one of the newest hour of the logs of a row."""
    last = math.inf if row["last_sample"] is None else row["last_sample"]
    return found["kind"] in WHILE_IT_LASTS and found.get("end", math.inf) >= last


def to_do(found: Mapping[str, Any]) -> int:
    """Return the place of a finding: a position that stands still, from which others follow as all axes are worked out
    with a wrong posture; those that ask for an answer, that are to be mended, and all others."""
    if found["kind"] == STOPPED:
        return -1
    return 0 if asks_for_answer(found) else 1 if found["kind"] in WHILE_IT_LASTS else 2


def is_note(found: Mapping[str, Any], row: Mapping[str, Any]) -> bool:
    """Return whether a finding asks for nothing: neither an answer nor that something is mended, or it is over."""
    if found["kind"] in ASKING or lasts(found, row):
        return False
    return "end" in found or (found["kind"] in TELLING and not found.get("logs"))
