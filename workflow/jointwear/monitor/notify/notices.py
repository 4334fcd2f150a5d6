"""What there is to tell of a fleet now: unresolved alarms, robots that are refused, robots that are silent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import tzinfo
from typing import Any

from jointwear.monitor.local_time import duration, log_time
from jointwear.monitor.presentation.words import anew_words, change_words, outlook_words
from jointwear.monitor.watching.limits import in_sentence
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
            silent = f"no new log for {duration(row['silence_hours'])}"
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
        if axis is None:
            subject, told = f"{row['robot']}, whole robot", [in_sentence(episode["quantity"]), since]
        else:
            subject = f"{row['robot']}, axis {axis['axis']}" + (f" ({axis['joint']})" if axis["joint"] else "")
            quantity, change = in_sentence(episode["quantity"]), change_words(axis)
            # How much it has grown begins with what has grown.
            named = quantity.lower() in change.lower()
            told = ["" if named else quantity, change, anew_words(row, axis, zone), outlook_words(row, axis, zone)]
            told += [since, axis["check"]]
        key = f"{row['folder']}|{episode['key']}"
        found.append(Notice(key, row["robot"], subject, "; ".join(t for t in told if t), episode["open"]))
    return found
