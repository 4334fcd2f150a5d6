"""What there is to tell of a fleet now: unresolved alarms, robots that are refused, robots that are silent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import tzinfo
from typing import Any

from jointwear.files.shown_numbers import fixed, number
from jointwear.monitor.local_time import duration, log_time, with_local_times
from jointwear.monitor.presentation.words import anew_words, change_words, event_words, outlook_words, until_words
from jointwear.monitor.watching.limits import COULOMB, VISCOUS, in_sentence
from jointwear.monitor.watching.records import DETECTORS


@dataclass(frozen=True)
class Notice:
    """Something to tell of a robot.

    `key` stays the same as long as it lasts; `active` is False for an alarm whose friction is back to normal though
    nobody has explained it; `subject` names robot and axis, `words` say what is the matter.
    """

    key: str
    robot: str
    subject: str
    words: str
    active: bool = True


@dataclass(frozen=True)
class Closure:
    """How an event closed an alarm, in `words`; `mended`: somebody did something to the axis, not only looked at it."""

    words: str
    mended: bool


def notices(rows: Sequence[Mapping[str, Any]], zone: tzinfo) -> list[Notice]:
    """Return the notices of the rows of a fleet, the most urgent robot first."""
    found = []
    for row in rows:
        found += _alarms(row, zone)
        if row["result"] != "judged":
            found.append(Notice(f"{row['folder']}|refused", row["robot"], row["robot"], f"refused: {row['reason']}"))
        elif row["refused_newest"]:
            told = row["refusals"][-1] if row["refusals"] else "see its page"
            words = f"the newest logs are refused ({row['refused_newest']}): {told}"
            found.append(Notice(f"{row['folder']}|refused", row["robot"], row["robot"], words))
        if row["stale"]:
            what = "no log that can be judged" if row["refused_newest"] else "no new log"
            silent = f"{what} for {duration(row['silence_hours'])}"
            found.append(Notice(f"{row['folder']}|stale", row["robot"], row["robot"], silent))
    return found


def _alarms(row: Mapping[str, Any], zone: tzinfo) -> list[Notice]:
    """One notice per axis and quantity."""
    axes = {axis["axis"]: axis for axis in row["axes"]}
    found = []
    for episode in row["episodes"]:
        # A row that an earlier version wrote may hold what the paper's detector saw.
        if episode["detector"] != DETECTORS[0]:
            continue
        axis = axes.get(episode["axis"])
        since = f"first alarm {log_time(episode['first'], zone, row['dated'])}"
        subject = _subject(row, axis)
        if axis is None:
            told = [in_sentence(episode["quantity"]), since]
        else:
            quantity, change = in_sentence(episode["quantity"]), change_words(axis, until_words(row, axis, zone))
            # How much it has grown begins with what has grown.
            named = quantity.lower() in change.lower()
            told = ["" if named else quantity, change, anew_words(row, axis, zone), outlook_words(row, axis, zone)]
            told += [since, with_local_times(axis["check"], zone)]
        key = f"{row['folder']}|{episode['key']}"
        found.append(Notice(key, row["robot"], subject, "; ".join(t for t in told if t), episode["open"]))
    return found


def _subject(row: Mapping[str, Any], axis: Mapping[str, Any] | None) -> str:
    """Return the name of robot and axis, None the whole robot."""
    if axis is None:
        return f"{row['robot']}, whole robot"
    return f"{row['robot']}, axis {axis['axis']}" + (f" ({axis['joint']})" if axis["joint"] else "")


def closures(rows: Sequence[Mapping[str, Any]], zone: tzinfo) -> dict[str, Closure]:
    """Return what closed the alarms that events of the config have closed, by the key of their notice."""
    found = {}
    for row in rows:
        axes = {axis["axis"]: axis for axis in row["axes"]}
        for episode in row.get("closed", ()):
            event, axis = episode["event"], axes.get(episode["axis"])
            seen = event["kind"] == "acknowledged"
            told = event_words(event, zone, row["dated"], "" if seen else "of ")
            size = {COULOMB: "growth", VISCOUS: "viscous_growth"}.get(episode["quantity"])
            grown = axis.get(size) if seen and axis is not None and axis.get("event") and size else None
            if grown is not None:
                # Nothing was done to it: who reads that has to know how much is left.
                quantity, limit = in_sentence(episode["quantity"]), number(axis["limit"], 2)
                told += f"; {quantity} {fixed(grown, 1, True)} %, limit {limit} %"
            found[f"{row['folder']}|{episode['key']}"] = Closure(told, not seen)
    return found
