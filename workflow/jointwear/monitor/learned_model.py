"""Which robot file a robot is monitored with: what `learn_normal` wrote from the given one and its logs, or that one.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json
from jointwear.monitor.made_with import joint_names, model_of, reading_of

#: Where `learn_normal` leaves the robot file of a robot, and beside it what it was learnt from.
LEARNED = "results/learned/{name}/robot.yaml"
#: What is read of a log that tells nothing of its samples' sizes.
BESIDE = ("time_zone", "columns", "programs")


def learnt_from(entry: Mapping[str, Any], logs: Iterable[str]) -> dict[str, Any]:
    """Return what a model is learnt from, as JSON has it: the given robot, how its logs are read, and the logs.

    Parameters
    ----------
    entry : of ``monitor.robots``, its `robot` the given one. logs : that were learnt from.
    """
    reading = reading_of(entry, joint_names(entry["robot"]))
    return {
        "model": model_of(entry["robot"]),
        "reading": {key: value for key, value in reading.items() if key not in BESIDE},
        "logs": sorted(set(logs)),
    }


def learnt_of_other(name: str, entry: Mapping[str, Any]) -> str:
    """Return why the model that was learnt for a robot is not used, in one line; empty if it is, or there is none."""
    learned = Path(LEARNED.format(name=name))
    if not entry.get("use_learned", True) or not learned.is_file():
        return ""
    try:
        known = read_json(learned.with_name("learned.json")).get("learnt_from") or {}
        now = learnt_from(entry, ())
    except (InputError, OSError):
        known, now = {}, {"model": ""}
    if not isinstance(known, dict) or known.get("model") != now["model"]:
        what = "another robot file"
    elif known.get("reading") != now["reading"]:
        what = "logs that were read with other keys"
    elif not any(_matches(str(log), entry["logs"]) for log in known.get("logs", ())):
        what = "other logs"
    else:
        return ""
    return f"{learned}: the learnt model of {what} is not used; run learn_normal"


def model_file(name: str, entry: Mapping[str, Any]) -> str:
    """Return the robot file that a robot is monitored with.

    What `learn_normal` wrote, if it has learnt from this robot file, read as now, and from logs of these patterns;
    else the entry's.
    """
    learned = Path(LEARNED.format(name=name))
    used = entry.get("use_learned", True) and learned.is_file() and not learnt_of_other(name, entry)
    return learned.as_posix() if used else entry["robot"]


def _matches(log: str, patterns: Iterable[str]) -> bool:
    """Return whether a log, there or not, has a name that a pattern stands for."""
    return any(fnmatchcase(Path(log).as_posix(), Path(p).as_posix().replace("**/", "*")) for p in patterns)
