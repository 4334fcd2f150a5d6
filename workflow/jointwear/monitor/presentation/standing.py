"""How a robot stands, as JSON has it: what its page, the fleet, messages and metrics are made from."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import EMPTY, LEFT_OUT, NO_SAMPLES, TRUNCATED, InputError, shown
from jointwear.files.json_documents import read_json
from jointwear.files.json_values import as_json, finite, six_digits
from jointwear.measurement.flags import Flag
from jointwear.monitor.events import Event
from jointwear.monitor.judging.state import RobotState
from jointwear.monitor.presentation.condition import (
    CHANGED,
    UNJUDGED,
    AxisCondition,
    axis_conditions,
    robot_episodes,
    urgency,
)
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.presentation.words import over_words, rising_words
from jointwear.monitor.watching.limits import VISCOUS

#: What a robot without a judgement has.
NOTHING: dict[str, Any] = {
    "alarms": 0, "axes_changed": "", "reason": "", "logs": 0, "refused_logs": 0, "copied_logs": 0, "unjudged_logs": 0,
    "windows": 0, "refused_windows": 0, "unjudged_windows": 0, "kept_logs": 0, "last_sample": None,
    "refused_newest": 0, "unfinished": False, "last_judged": None,
    "rhythm_hours": None, "dated": False, "axes": [], "episodes": [], "closed": [], "findings": [], "refusals": [],
    "page": None,
}  # fmt: skip
#: Time [s] before the newest log that its rhythm is read from: four weeks, so that weekends count with their weight.
RHYTHM = 28 * 86400.0
#: Refusals that a row tells in words; the page of the robot has all.
TOLD_REFUSALS = 3


def rows_of(path: str | Path, keys: Iterable[str] = NOTHING) -> list[dict[str, Any]]:
    """Return the rows of robots that a JSON file of the fleet holds; `keys`: what they must have besides the names.

    Raises
    ------
    InputError : naming the file and the row, if one is none.
    """
    rows = read_json(path).get("robots")
    if not isinstance(rows, list):
        raise InputError(f"{path}: has no rows of robots; delete it and run again")
    wanted = {"robot": "", "folder": "", "result": "", **{key: NOTHING.get(key) for key in keys}}
    for number, row in enumerate(rows, start=1):
        if not isinstance(row, dict):
            raise InputError(f"{path}: row {number} is {shown(row)}, must be a mapping; delete it and run again")
        for key, sound in wanted.items():
            if key not in row or (isinstance(sound, (str, list)) and not isinstance(row[key], type(sound))):
                raise InputError(f"{path}: row {number} has no sound '{key}'; delete it and run again")
        if row["folder"] != Path(row["folder"]).name:
            raise InputError(
                f"{path}: row {number}: 'folder' is {shown(row['folder'])}, no name; delete it and run again"
            )
    return rows


def left_of(path: str | Path) -> list[str]:
    """Return the folders of robots that have left the configuration, as a JSON file of the fleet names them.

    Raises
    ------
    InputError : naming the file, if they are no names.
    """
    left = read_json(path).get("left", [])
    if not isinstance(left, list) or not all(isinstance(name, str) for name in left):
        raise InputError(f"{path}: 'left' is {shown(left)}, must be a list of names; delete it and run again")
    return left


def standing(state: RobotState) -> dict[str, Any]:
    """Return what the fleet needs to know of a judged robot; `axes` in order of urgency first."""
    conditions = axis_conditions(state)
    first = urgency(conditions)
    ordered = first + [c for c in conditions if c not in first]
    unjudged = state.status == UNJUDGED
    taken = accepted(state)
    last = float(np.nanmax(state.last[taken] if taken.any() else state.last))
    newest = float(state.end[max(int(np.searchsorted(state.start, last, side="right")) - 1, 0)])
    whole, part = robot_episodes(state), rows_left_out(state)
    episodes = [e for c in ordered for e in c.episodes] + [e for e in whole if e.resolved is None]
    closed = [e for c in ordered for e in c.past] + [e for e in whole if e.resolved is not None]
    return {
        "alarms": len(state.counted),
        "axes_changed": " ".join(str(c.axis) for c in conditions if c.level == CHANGED),
        "logs": len(state.logs),
        "refused_logs": sum(bool(told) for told in state.refused) - sum(part),
        "left_out_logs": sum(part),
        "copied_logs": sum(bool(name) for name in state.copy_of),
        "unjudged_logs": _unjudged_logs(state, unjudged.all(axis=1)),
        "windows": len(state.start),
        "refused_windows": int(np.sum((state.flags & int(Flag.REFUSED)).any(axis=1))),
        "unjudged_windows": int(unjudged.all(axis=1).sum()),
        "refused_newest": refused_newest(state),
        "unfinished": unfinished(state),
        "last_judged": None if last_judged(state) is None else float(state.end[last_judged(state)]),
        "last_sample": last,
        "rhythm_hours": rhythm_hours(state.first[taken]),
        "dated": state.dated,
        "axes": [axis_row(c, newest) for c in ordered],
        "episodes": [episode_row(e, conditions) for e in episodes],
        "closed": [closed_row(e) for e in closed],
        "findings": as_json(state.findings),
        "refusals": [told for told, few in zip(state.refused, part, strict=True) if told and not few][-TOLD_REFUSALS:],
    }


def accepted(state: RobotState) -> np.ndarray:
    """Return which logs hold samples that were taken, (logs,) bool: a refused one, whose dates may be those of a wrong
    clock, says neither when the newest sample was measured nor how often a log comes."""
    refused = (state.flags & int(Flag.REFUSED)).any(axis=1) & ~state.count.any(axis=1)
    taken = np.concatenate([[0], np.cumsum(~refused)])
    begin = np.searchsorted(state.end, state.first, side="right")
    end = np.searchsorted(state.start, state.last, side="right")
    return np.isfinite(state.first) & (taken[np.maximum(begin, end)] > taken[begin])


def last_judged(state: RobotState) -> int | None:
    """Return the newest window in which some axis was judged, None where there is none."""
    judged = np.flatnonzero((state.status != UNJUDGED).any(axis=1))
    return int(judged[-1]) if len(judged) else None


def refused_newest(state: RobotState) -> int:
    """Return how many logs are refused since some axis was judged last: what the robot is like now nobody knows.

    A log of which nothing could be read has no time of its own: it comes after the log before it in the list, so that
    it is newer than the last judgement if that one reaches as far. One that was read counts where its samples were
    refused: a row or a cell that was left out is told, and refuses nothing. Of one that is :func:`unfinished` it has to
    show first that nobody writes it any more.
    """
    newest = last_judged(state)
    since, reached = (-np.inf, -np.inf) if newest is None else (state.end[newest], state.start[newest])
    if newest is None and state.baseline[-1]:
        # While the baseline is learnt nothing is judged, and what it is learnt from is known.
        since, reached = state.end[-1], state.start[-1]
    refused = (state.flags & int(Flag.REFUSED)).any(axis=1) & (state.end > since)
    count, before = 0, -np.inf
    logs = list(zip(state.refused, state.first, state.last, strict=True))
    for told, first, last in logs[:-1] if unfinished(state) else logs:
        if np.isfinite(last):
            before = last
            count += bool(told) and bool((refused & (state.start <= last) & (state.end > first)).any())
        else:
            count += bool(told) and before >= reached
    return count


def rows_left_out(state: RobotState) -> list[bool]:
    """Return of which logs only rows or cells were left out: all else that they hold was read, and not refused."""
    refused = (state.flags & int(Flag.REFUSED)).any(axis=1)
    return [
        LEFT_OUT in told
        and TRUNCATED not in told
        and bool(np.isfinite(last))
        and not (refused & (state.start <= last) & (state.end > first)).any()
        for told, first, last in zip(state.refused, state.first, state.last, strict=True)
    ]


def unfinished(state: RobotState) -> bool:
    """Return whether the last log has no sample that could be read yet, as one that its logger has just begun: many
    formats can be read only once they are closed."""
    return not np.isfinite(state.last[-1]) and any(why in state.refused[-1] for why in (EMPTY, NO_SAMPLES, TRUNCATED))


def _unjudged_logs(state: RobotState, blind: np.ndarray) -> int:
    """Number of logs that were read and of which no window of any axis could be judged."""
    begin = np.searchsorted(state.end, state.first, side="right")
    end = np.searchsorted(state.start, state.last, side="right")
    seen = np.concatenate([[0], np.cumsum(~blind)])
    read = np.isfinite(state.first)
    return int(sum(seen[b] == seen[a] for a, b in zip(begin[read], end[read], strict=True)))


def rhythm_hours(first: np.ndarray) -> float | None:
    """Return the calendar time per log [h] over the last :data:`RHYTHM`, nights and weekends included.

    Parameters
    ----------
    first : (logs,) [s], begin of every log, NaN of one that was not read. Of fewer than two there is None.
    """
    begins = np.unique(first[np.isfinite(first)])
    if len(begins) < 2:
        return None
    recent = begins[begins >= min(begins[-1] - RHYTHM, begins[-2])]
    return float(np.mean(np.diff(recent))) / 3600


def axis_row(condition: AxisCondition, newest: float) -> dict[str, Any]:
    """Return the condition of an axis as JSON has it. `limit_at`: moments [s] of its limit, median and both ends, None
    where it may never be reached; `hours`: to these from the end of the `newest` window [s], 0 where they have passed.
    """
    limited, main = condition.limited, condition.main
    # A forecast of its limit alone would stand beside the growth of the other friction.
    viscous = condition.viscous_told or (limited is not None and limited.quantity == VISCOUS)
    return {
        "axis": condition.axis,
        "joint": condition.joint,
        "level": condition.level,
        "reached": bool(condition.reached),
        "unsure": bool(condition.unsure),
        "growth": six_digits(condition.growth),
        "growth_std": six_digits(condition.growth_std),
        "limit": condition.limit,
        "limit_at": None if limited is None else [finite(t) for t in (limited.median, limited.low, limited.high)],
        "hours": None if limited is None else [six_digits(h) for h in limited.hours_from(newest)],
        "limited_by": "" if limited is None else limited.quantity,
        "viscous_growth": six_digits(condition.viscous) if viscous else None,
        "probability": None if condition.probability is None else six_digits(condition.probability),
        "quantity": condition.quantity,
        "change": as_json(condition.change),
        "unit": condition.unit,
        "since": main.first if main else None,
        "alarms": sum(len(e.alarms) for e in condition.episodes),
        "check": condition.check,
        "over": over_words(condition),
        "rising": rising_words(condition),
        "anew": _event_row(condition.anew),
        "event": _event_row(condition.event),
        "until": as_json(condition.until) if condition.event else None,
    }


def _event_row(event: Event | None) -> dict[str, Any] | None:
    return None if event is None else {"time": event.time, "kind": event.kind, "note": event.note}


def closed_row(episode: Episode) -> dict[str, Any]:
    """Return an episode that an event of the config has closed, as JSON has it."""
    named = {"key": episode.key, "axis": episode.axis, "quantity": episode.quantity, "detector": episode.detector}
    return {**named, "event": _event_row(episode.resolved)}


def episode_row(episode: Episode, conditions: list[AxisCondition]) -> dict[str, Any]:
    """Return an unresolved episode as JSON has it; `open` while the axis counts as changed."""
    levels = {c.axis: c.level for c in conditions}
    level = levels.get(episode.axis) if episode.axis else CHANGED
    return {
        "key": episode.key,
        "axis": episode.axis,
        "quantity": episode.quantity,
        "detector": episode.detector,
        "first": episode.first,
        "last": episode.last,
        "alarms": len(episode.alarms),
        "open": level == CHANGED,
        **{k: as_json(episode.newest[k]) for k in ("change", "change_low", "change_high", "unit")},
    }
