"""What the entries of monitored robots may say, checked without looking for their logs.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable, Mapping
from datetime import tzinfo
from functools import cache
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, shown
from jointwear.files.regular_files import nearest_file
from jointwear.files.wording import count, listed
from jointwear.measurement.log_entries import PER_JOINT, check_log_entry
from jointwear.measurement.timestamps import LATEST, meant, moment_of
from jointwear.monitor.events import events_of
from jointwear.monitor.lengths_of_time import LONGEST, window_seconds
from jointwear.monitor.local_time import odd_hour, zone_of
from jointwear.robots.robot_file import read_robot_file, robot_sources

#: Longest name of a robot [characters]: with an ending it is that of a file, which some systems end at 143.
LONGEST_NAME = 100
#: Robots that a message names before it counts the others.
MOST_NAMES = 5


def check_robots(config: Mapping[str, Any]) -> None:
    """Check the entries of ``monitor.robots``, without looking for their logs.

    Raises
    ------
    InputError : one line naming the robot, the key and what is allowed.
    """
    try:
        window_seconds(config["monitor"].get("stale_after", "72h"))
    except InputError as error:
        raise InputError(f"config: 'monitor.stale_after': {error}") from None
    read_once = cache(read_robot_file)  # a fleet shares its robot files
    for name, entry in config["monitor"]["robots"].items():
        where = f"monitor.robots.{name}"
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
            raise InputError(
                f"config: 'monitor.robots' has the name {shown(name)}; a robot's name is letters, digits and _, a "
                f"letter first{_plain_name(name, config['monitor']['robots'])}"
            )
        if len(name) > LONGEST_NAME:
            raise InputError(
                f"config: 'monitor.robots' holds {shown(name)}, a name of {len(name)} characters (allowed: up to "
                f"{LONGEST_NAME}, as files are named after it)"
            )
        path = Path(entry["robot"])
        if os.path.isdir(path):
            there = next(iter(sorted(path.glob("*.yaml"))), path / "my_arm.yaml").as_posix()
            raise InputError(f"config: '{where}.robot' is {shown(str(path))}, a folder; name a file, as '{there}'")
        if not os.path.isfile(path):
            raise InputError(f"config: '{where}.robot' is {shown(str(path))}: no such file{nearest_file(path)}")
        if path.suffix.lower() in (".urdf", ".xacro"):
            raise InputError(
                f"config: '{where}.robot' is {shown(str(path))}, a URDF; name a robot file (YAML) that holds "
                f"'urdf: {path.name}' and the drives"
            )
        zone = zone_of(entry.get("time_zone"), f"{where}.time_zone")
        try:
            robot = read_once(path)
        except InputError as error:
            raise InputError(f"{error}; {_robots_of(path, config)}") from None
        for source in robot_sources(entry["robot"])[1:]:
            if not Path(source).is_file():
                raise InputError(f"{path}: 'urdf' names {source}, which does not exist")
        check_log_entry(entry, where, robot, (*PER_JOINT, "dead_band"))
        _check_hours(entry, where, zone)
        try:
            for event in events_of(entry):
                most = len(robot["joints"])
                if (wrong := next((a + 1 for a in event.axes if not 0 <= a < most), None)) is not None:
                    raise InputError(
                        f"config: 'events' names axis {wrong}, robot '{robot['name']}' has {count(most, 'joint')} "
                        f"(allowed: 1 to {most}); the nearest valid value is {min(max(wrong, 1), most)}"
                    )
            _check_to_come(entry)
        except InputError as error:
            raise InputError(str(error).replace("config: 'events", f"config: '{where}.events", 1)) from None
        try:
            window_seconds(entry.get("window", "1h"))
        except InputError as error:
            raise InputError(f"config: '{where}.window': {error}") from None
        baseline = entry.get("baseline", {})
        if not {"until", "windows"} & set(baseline):
            raise InputError(f"config: '{where}.baseline' must hold 'until' or 'windows'")
        for key in ("from", "until"):
            try:
                moment_of(baseline.get(key, 0), zone)
            except ValueError:
                raise InputError(
                    f"config: '{where}.baseline.{key}' is {shown(baseline[key])}{meant(baseline[key])} "
                    "(allowed: ISO 8601, as 2026-01-15T00:00:00Z, or seconds for logs without a date, at most "
                    f"{LATEST:g} in size)"
                ) from None
        borders = [baseline.get(key) for key in ("from", "until")]
        if None not in borders and moment_of(borders[0], zone) >= moment_of(borders[1], zone):
            raise InputError(
                f"config: '{where}.baseline.from' is {shown(borders[0])}, not before 'until', {shown(borders[1])}"
            )


def _plain_name(name: str, taken: Iterable[str]) -> str:
    """Return the valid name nearest to that of a robot in words, empty where another robot has it or there is none."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", str(name)).strip("_")
    plain = f"robot_{plain}" if plain[:1].isdigit() else plain
    return f"; the nearest valid name is '{plain}'" if plain and plain not in taken else ""


def _check_hours(entry: Mapping[str, Any], where: str, zone: tzinfo) -> None:
    """Check that no time of an entry is one that the clock on the wall never shows, or shows twice.

    Raises
    ------
    InputError : with what to write.
    """
    given = {f"events[{k}].time": event.get("time") for k, event in enumerate(entry.get("events") or ())}
    given |= {f"baseline.{key}": (entry.get("baseline") or {}).get(key) for key in ("from", "until")}
    for key, text in given.items():
        try:
            words = odd_hour(text, zone) if isinstance(text, str) else ""
        except ValueError:
            continue  # told as what it is
        if words:
            raise InputError(f"config: '{where}.{key}' is {shown(text)}, {words}")


def _robots_of(path: Path, config: Mapping[str, Any]) -> str:
    """Return in words which monitored robots have a robot file; some of them where they are many."""
    names = [name for name, entry in config["monitor"]["robots"].items() if Path(entry["robot"]) == path]
    more = [f"{len(names) - MOST_NAMES} more"] if len(names) > MOST_NAMES else []
    told = listed([*(f"'{name}'" for name in names[:MOST_NAMES]), *more])
    return f"{path} is the robot file of {told}"


def _check_to_come(entry: Mapping[str, Any]) -> None:
    """Check that no event lies further ahead than an arm lives: nobody plans that; a nearer one acts from its time on.

    Raises
    ------
    InputError : naming the event.
    """
    for k, given in enumerate(entry.get("events") or ()):
        if isinstance(given["time"], str) and moment_of(given["time"]) > time.time() + LONGEST:
            raise InputError(
                f"config: 'events[{k}].time' is {shown(given['time'])}, which is yet to come, by more than "
                f"{LONGEST / 86400:g} d; allowed: what has been done, or is planned within that time"
            )
