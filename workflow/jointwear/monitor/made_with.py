"""What the windows of a log depend on besides the log: the robot, and how logs are read, whatever words say it.

Comments, the order of keys, `60min` for `1h` and defaults that are stated change nothing. Read by the Snakefile:
nothing heavy is imported here.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from jointwear.files.digests import digest
from jointwear.measurement.units import SPELLINGS
from jointwear.monitor.lengths_of_time import window_seconds
from jointwear.robots.robot_file import read_robot_file, robot_sources

#: Keys of an entry that decide how a log is read; its windows depend on no other.
READING_KEYS = (
    "variables", "units", "joints", "topic", "window", "dead_band", "torque_constant", "scale", "sign", "time_zone",
    "program",
)  # fmt: skip
#: Keys of a robot file that change no torque: its URDF counts by its content, wherever it lies.
TOLD_ONLY = ("name", "provenance", "urdf", "inertia_check")


def made_with(robot: str | Path, entry: Mapping[str, Any]) -> str:
    """Return a digest of the robot and of how its logs are read.

    Parameters
    ----------
    robot : file of the robot. entry : of ``monitor.robots``; of it the keys that decide how logs are read.

    Raises
    ------
    InputError : if the robot file is none.
    """
    names, window = joint_names(robot), window_seconds(entry.get("window", "1h"))
    return digest([model_of(robot), reading_of(entry, names), window, _each(entry.get("dead_band"), names)])


def model_of(robot: str | Path) -> str:
    """Return a digest of what the library reads of a robot file and its URDF, without comments and provenance."""
    content, _, urdf = _read(robot)
    return digest([content, urdf])


def joint_names(robot: str | Path) -> list[str]:
    """Return the names of the joints of a robot file, in order of the axes."""
    return _read(robot)[1]


def reading_of(entry: Mapping[str, Any], names: list[str]) -> dict[str, Any]:
    """Return what an entry says of samples of a log, in one wording; keys that say what holds anyway are left out.

    Parameters
    ----------
    names : of the joints of the robot.
    """
    program = entry.get("program") or {}
    columns = program.get("columns") or ()
    found = {
        "variables": {
            role: name for role, name in (entry.get("variables") or {}).items() if name not in (role, [role])
        },
        "units": {role: _unit(str(unit)) for role, unit in (entry.get("units") or {}).items()},
        "joints": None if (given := entry.get("joints")) is None or list(given) == names else list(given),
        "topic": entry.get("topic"),
        "torque_constant": _each(entry.get("torque_constant"), names),
        "scale": _unless_one(_each(entry.get("scale"), names)),
        "sign": _unless_one(_each(entry.get("sign"), names)),
        "time_zone": None if entry.get("time_zone") == "UTC" else entry.get("time_zone"),
        "columns": [columns] if isinstance(columns, str) else list(columns),
        "programs": list((program.get("logs") or {}).items()),
    }
    return {key: value for key, value in found.items() if value}


def _unit(unit: str) -> str:
    return SPELLINGS.get(unit.strip(), unit.strip())


def _each(given: Any, names: list[str]) -> list[float] | None:
    """Return one number a joint of a key that may be one number; None without the key."""
    if given is None:
        return None
    return [float(x) for x in given] if isinstance(given, (list, tuple)) else [float(given)] * len(names)


def _unless_one(given: list[float] | None) -> list[float] | None:
    return None if given is None or all(x == 1.0 for x in given) else given


def _read(robot: str | Path) -> tuple[dict[str, Any], list[str], list[str]]:
    """Return what a robot file says with its defaults, the names of its joints, and what its URDF holds as digests."""
    own, *urdf = (hashlib.sha256(Path(path).read_bytes()).hexdigest() for path in robot_sources(str(robot)))
    return *_content(str(robot), own, tuple(urdf)), urdf


@lru_cache(maxsize=64)
def _content(robot: str, own: str, urdf: tuple[str, ...]) -> tuple[dict[str, Any], list[str]]:
    """Return what a robot file says, and the names of its joints, anew for other bytes; a fleet shares robot files."""
    data = read_robot_file(robot)
    names = [joint["name"] for joint in data["joints"]]
    bodies = [*data.get("links", []), *([data["payload"]] if "payload" in data else [])]
    for body in bodies:
        body.setdefault("inertia", [0.0] * 6)
    for row in data.get("dh", []):
        row.setdefault("offset", 0.0)
    effects = [{key: x for key, x in effect.items() if x is not None and x != {}} for effect in data.get("effects", [])]
    content = {key: value for key, value in data.items() if key not in TOLD_ONLY} | {"effects": effects}
    return _plain(content), names


def _plain(value: Any) -> Any:
    """Return a value in which every number is a float, so that 1 is 1.0."""
    if isinstance(value, dict):
        return {key: _plain(x) for key, x in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(x) for x in value]
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else value
