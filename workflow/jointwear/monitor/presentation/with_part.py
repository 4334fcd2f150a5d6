"""Alarms that follow a change of the load: what to ask before anybody opens a gear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.measurement.flags import Flag
from jointwear.monitor.events import NEW_PROGRAM, Event
from jointwear.monitor.findings.findings import PROGRAM, moment_words
from jointwear.monitor.judging.state import RobotState
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.watching.present import FEWEST_NOW

#: Time [s] for which an alarm may be of a part that was put on before it: an alarm rests on two shifts at most, of a
#: day each. An event of a new program as near to the part is of it: the axis was learnt anew from there.
SOON = 2 * 86400.0
#: Share of the windows from the first one on whose torque the model explains much less of until the alarm, and of all
#: that lie before: at least half, which is most of them, and at most a tenth.
MOST, SELDOM = 0.5, 0.1


def part_before(
    findings: Sequence[Mapping[str, Any]], axis: int, first: float, events: Sequence[Event] = ()
) -> Mapping[str, Any] | None:
    """Return the newest finding on a part after which a 1-based axis, whose torque it changed, soon alarmed `first`
    [s]; None where there is none, or where the config tells of the program that came with it.

    Parameters
    ----------
    findings : of the robot. events : of the config.
    """
    told = [e.time for e in events if e.kind == NEW_PROGRAM and e.concerns(axis - 1)]
    found = [
        f
        for f in findings
        if f["kind"] == PROGRAM
        and axis in f.get("moved", ())
        and 0 <= first - f["time"] <= SOON
        and not any(abs(time - f["time"]) <= SOON for time in told)
    ]
    return max(found, key=lambda f: float(f["time"]), default=None)


def asked_of_part(state: RobotState, j: int, episodes: Sequence[Episode], events: Sequence[Event]) -> str:
    """Return what to ask first of a 0-based axis whose newest episode soon followed a part; else empty."""
    newest = max(episodes, key=lambda e: e.last, default=None)
    if newest is None:
        return ""
    found = part_before(state.findings, j + 1, newest.first, events)
    if found:
        return part_words(found, moment_words(state, found["time"]))
    since = less_explained_since(state, j, newest.first)
    answered = since is None or any(e.concerns(j) and abs(e.time - since) <= SOON for e in events)
    return "" if answered else less_explained_words(moment_words(state, since))


def less_explained_since(state: RobotState, j: int, first: float) -> float | None:
    """Return from when on [s] the model explains much less of the torque of a 0-based axis, if soon before an alarm at
    `first` [s] it came to do so; else None.

    Whatever size friction has, the model explains the rest of the torque: what wears does not change that, and another
    load does, though it may be carried on some moves only and look like friction there.
    """
    told = (state.count[:, j] > 0) & (state.end <= first)
    recent = told & (state.end > first - SOON)
    marked = (state.flags[:, j] & int(Flag.UNEXPLAINED) != 0) & told
    before = told & ~recent
    if not before.any() or np.mean(marked[before]) > SELDOM or not marked[recent].any():
        return None
    since = float(state.start[recent & marked][0])
    later = marked[told & (state.start >= since)]
    return since if len(later) >= FEWEST_NOW and np.mean(later) >= MOST else None


def less_explained_words(moment: str) -> str:
    """Return what to ask first where the model explains less since an alarm, the begin of a sentence."""
    return (
        f"does it carry another part or tool since about {moment}, or run another program? The model explains much "
        "less of its torque since then, whatever size friction has, which wear does not change. If so, enter it as "
        "'program' of that time under 'events', or label the programs in the logs; if not, "
    )


def part_words(found: Mapping[str, Any], moment: str) -> str:
    """Return what to ask first where an alarm followed a part, the begin of a sentence; `moment`: its time in words."""
    return (
        f"was a part or tool put on at about {moment}? The torque of {name_axes(found['moved'])} changed at once then, "
        "and friction rises with the load, too. If one was, enter it as 'program' of that time under "
        "'events', or label the programs in the logs; if not, "
    )
