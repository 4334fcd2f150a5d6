"""Robots that share logs though they may be two machines.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from jointwear.files.errors import InputError, shown

#: Keys that say which part of a log a robot takes, and those with which two robots are one in the same logs.
_COLUMNS = ("variables", "joints", "topic")
_ALIKE = (*_COLUMNS, "robot", "use_learned")


def check_shared_logs(logs: Mapping[str, Sequence[str]], config: Mapping[str, Any]) -> list[str]:
    """Return in words which robots share some of their logs, though they may be two machines.

    Files are the same under any name, links included. Robots of one controller may share its logs if they take other
    columns of them.

    Parameters
    ----------
    logs : of each robot, as :func:`find_all_logs` returns them.

    Raises
    ------
    InputError : naming two robots that are judged alike from the same logs: one of the machines would not be watched.
    """
    robots = config["monitor"]["robots"]
    if len(robots) < 2:
        return []
    files = {name: {_identity(log): log for log in found} for name, found in logs.items()}
    first: dict[Any, str] = {}
    told: dict[tuple[str, str], str] = {}
    for name, known in files.items():
        for file, log in known.items():
            other = first.setdefault((file, repr(_taken(robots[name], _COLUMNS))), name)
            if other != name:
                told.setdefault((other, name), log)
    for (other, name), log in told.items():
        if files[other].keys() == files[name].keys() and _taken(robots[name], _ALIKE) == _taken(robots[other], _ALIKE):
            raise InputError(
                f"config: 'monitor.robots.{name}.logs' holds the logs of '{other}', as {shown(log)}; allowed: the logs "
                "of one machine for each robot, or other 'variables', 'joints' or 'topic' where both are in the same "
                "files"
            )
    return [
        f"config: 'monitor.robots.{name}.logs' holds {shown(log)}, which '{other}' holds too; name the logs of one "
        "machine for each robot"
        for (other, name), log in told.items()
    ]


def _identity(log: str) -> Any:
    """Return what is the same of two names of one file: device and inode, or the path of what is not there yet."""
    try:
        found = os.stat(log)
    except OSError:
        return os.path.abspath(log)
    return found.st_dev, found.st_ino


def _taken(entry: Mapping[str, Any], keys: Iterable[str]) -> list[Any]:
    """Return the values of some keys of an entry."""
    return [entry.get(key) for key in keys]
