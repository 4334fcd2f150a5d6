"""Monitored robots as the config asks for them: which logs there are, and what is done with them.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import time
import zlib
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cache
from glob import has_magic
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.patterns import matches
from jointwear.files.regular_files import broken_link, nearest_file
from jointwear.files.wording import count, listed
from jointwear.measurement.log_entries import PER_JOINT, check_log_entry
from jointwear.measurement.log_kinds import FORMATS, is_folder_like_log, log_format, log_sources, unpacked
from jointwear.measurement.timestamps import LATEST, meant, moment_of
from jointwear.monitor.events import events_of
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.order_of_logs import in_order
from jointwear.robots.robot_file import read_robot_file, robot_sources

#: Keys of an entry that decide how a log is read; its windows depend on no other.
READING_KEYS = (
    "variables", "units", "joints", "topic", "window", "dead_band", "torque_constant", "scale", "sign", "time_zone",
    "program",
)  # fmt: skip
#: Keys that say which part of a log a robot takes, and those with which two robots are one in the same logs.
_COLUMNS = ("variables", "joints", "topic")
_ALIKE = (*_COLUMNS, "robot", "use_learned")
#: Logs that one job reads [bytes]: they take as long to read as the job takes to start (a second or two on one core).
BATCH_BYTES = 8e6
#: Longest name of a robot [characters]: with an ending it is that of a file, which some systems end at 143.
LONGEST_NAME = 100
#: Robots that a message names before it counts the others.
MOST_NAMES = 5
#: Shortest and longest length of time [s] in a config: a stroke of an arm, and the life of one.
SHORTEST, LONGEST = 1.0, 3650 * 86400.0
_SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
#: What is said of a log whose name is in another encoding, and the mend.
_NO_UTF8 = "whose name is not UTF-8, so that it cannot be read; rename it"
#: Units as people write them, without the s of the plural: (how many, of which unit). Not "m", which may be a month.
_SAID = {
    "sec": (1, "s"), "second": (1, "s"), "minute": (1, "min"), "min": (1, "min"), "h": (1, "h"), "hr": (1, "h"),
    "hour": (1, "h"), "d": (1, "d"), "day": (1, "d"), "w": (7, "d"), "wk": (7, "d"), "week": (7, "d"),
    "fortnight": (14, "d"),
}  # fmt: skip


def window_seconds(text: str | float) -> float:
    """Return the length of a window [s] from `1h`, `30min`, `600s`, `1d` or a number of seconds, as text or not.

    Raises
    ------
    InputError : if the text is no length of time, or the length is out of range.
    """
    if isinstance(text, (int, float)):
        length = float(text)
    else:
        match = re.fullmatch(r"\s*([0-9.]+)\s*(s|min|h|d)?\s*", text)
        try:
            length = float(match[1]) * _SECONDS[match[2] or "s"]
        except (TypeError, ValueError):
            raise InputError(
                f"{shown(text)} is no length of time (allowed: a number with s, min, h or d, as 1h){_meant(text)}"
            ) from None
    if not SHORTEST <= length <= LONGEST:
        raise InputError(f"{shown(text)} is out of range (allowed: {SHORTEST:g} s to {LONGEST / 86400:g} d)")
    return length


def _meant(text: str) -> str:
    """Return the length of time that a text most likely means, as a proposal; empty where nothing comes near."""
    said = re.fullmatch(r"\s*([0-9]{1,9}(?:\.[0-9]{1,9})?)\s*([A-Za-z]+?)s?\.?\s*", text)
    if said is None or said[2].lower() not in _SAID:
        return ""
    times, unit = _SAID[said[2].lower()]
    return f"; the nearest valid value is {times * float(said[1]):g}{unit}"


def may_be_read(path: str | Path) -> bool:
    """Return whether nothing forbids to read a file or folder; of one that is not there, or not yet, nothing does."""
    try:
        os.stat(path)
    except PermissionError:
        return False
    except OSError:
        return True
    return os.access(path, os.R_OK)


def readable_files(logs: Iterable[str]) -> list[str]:
    """Return the files of logs that may be read: Snakemake fails on another one, of which the reader tells why it is
    refused."""
    return [path for log in logs for path in log_sources(log) if may_be_read(path)]


def _folder(pattern: str) -> Path:
    """The folder that a pattern names: its parts before the first with a wildcard, without the file name."""
    parts = Path(pattern).parts
    fixed = next((i for i, part in enumerate(parts) if has_magic(part)), len(parts) - 1)
    return Path(*parts[:fixed]) if fixed else Path(".")


def find_logs(patterns: Iterable[str], where: str = "logs") -> list[str]:
    """Return the logs that the patterns match, each once, in order of their names.

    Raises
    ------
    InputError : if a pattern matches nothing that can be read, a match is of an unknown kind, or lies (through a link)
        outside the folder that its pattern names.
    """
    return in_order(log for pattern in patterns for log in _matching(pattern, where)[0])


def _matching(pattern: str, where: str) -> tuple[list[str], list[str]]:
    """Return the logs that a pattern matches, and in words which others cannot be read; see :func:`find_logs`."""
    matching = matches(pattern)
    if not matching:
        folder = _folder(pattern)
        there = [p.name for p in folder.iterdir() if not _misnamed(p)] if folder.is_dir() else []
        hint = nearest(Path(pattern).name, there) if folder.is_dir() else f"; there is no folder {folder}"
        raise InputError(f"config: '{where}' holds '{pattern}', which matches no file{hint}")
    holds = f"config: '{where}' holds '{pattern}', which matches"
    root = os.path.realpath(_folder(pattern))
    foreign = {m: word for m in matching if (word := _misnamed(m))}
    misnamed = [word for m, word in foreign.items() if log_format(m)]
    matching = [m for m in matching if m not in foreign]
    links = {m: fault for m in matching if log_format(m) and (fault := broken_link(m))}
    known = [m for m in matching if log_format(m) and m not in links]
    packed = [m for m in matching if unpacked(m)]
    folders = [m for m in matching if is_folder_like_log(m)]
    if not known:
        allowed = f"{', '.join(FORMATS)}, or a bag's folder with metadata.yaml"
        match = (packed or matching or list(foreign.values()))[0]
        what = "is packed; unpack it" if packed else "no kind of log"
        if not packed and misnamed:
            match, what = misnamed[0], "its name is not UTF-8; rename it"
        elif not packed and links:
            match, what = next(iter(links.items()))
        elif not packed and folders:
            match, what = folders[0], f"is a folder; name the files in it, as '{folders[0]}/*'"
        raise InputError(f"{holds} '{match}': {what} (allowed: {allowed})")
    for match in known:
        if not Path(os.path.realpath(match)).is_relative_to(root):
            raise InputError(
                f"config: '{where}' holds '{pattern}'; '{match}' leads outside the folder {_folder(pattern)}; "
                "name the folder that it is in"
            )
    unread = [f"{holds} '{match}', which is {fault}" for match, fault in links.items()]
    if misnamed:
        unread.append(f"{holds} {count(len(misnamed), 'log')}, as '{misnamed[0]}', {_NO_UTF8}")
    if left := sorted(set(packed) - {m for m in packed if unpacked(m) in known}):
        unread.append(
            f"{holds} {count(len(left), 'packed log')}, as '{left[0]}', which cannot be read; unpack what was not read "
            "before it was packed"
        )
    # The files of a folder may be logs of the same pattern.
    if left := [m for m in folders if not any(Path(m) in Path(k).parents for k in known)]:
        unread.append(
            f"{holds} {count(len(left), 'folder')} with the name of a log, as '{left[0]}', which cannot be read; name "
            f"the files in it, as '{left[0]}/*'"
        )
    return known, unread


def _misnamed(path: str | Path) -> str:
    """Return a path whose name is not UTF-8 as a message shows it, empty for all others: no table or record can hold
    such a name."""
    name = os.fsencode(path)
    try:
        name.decode()
    except UnicodeDecodeError:
        return name.decode(errors="backslashreplace")
    return ""


def log_key(path: str) -> str:
    """Return a name for the results of one log: readable, safe in file names, different for every path."""
    stem = re.sub(r"[^A-Za-z0-9_-]+", "_", Path(path).stem)[:40].strip("_") or "log"
    return f"{stem}-{hashlib.sha256(os.fsencode(path)).hexdigest()[:8]}"


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
            raise InputError(f"config: '{where}': a robot's name is letters, digits and _, a letter first")
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


def find_all_logs(config: Mapping[str, Any]) -> tuple[dict[str, list[str]], dict[str, str]]:
    """Return the logs of every robot, and for every robot whose logs could not all be reached the reason.

    A folder that cannot be reached concerns its robot alone: a call for many robots goes on without it.
    """
    logs, silent = {}, {}
    for name, entry in config["monitor"]["robots"].items():
        found: set[str] = set()
        reasons = []
        for pattern in entry["logs"]:
            where = f"monitor.robots.{name}.logs"
            try:
                known, unread = _matching(pattern, where)
                found.update(known)
                reasons += unread
            except InputError as error:
                reasons.append(str(error))
            except OSError as error:
                reasons.append(f"config: '{where}' holds '{pattern}': {error.strerror or error}")
        logs[name] = in_order(found)
        if reasons:
            silent[name] = reasons[0]
    return logs, silent


def programs_without_logs(name: str, entry: Mapping[str, Any], logs: Sequence[str]) -> str:
    """Return in words that `program.logs` of a robot stands for none of its logs, so that it does nothing; empty where
    it stands for one, or there is no log.

    One of several patterns may wait for a program that is still to run.
    """
    patterns = (entry.get("program") or {}).get("logs") or {}
    if not patterns or not logs or any(fnmatchcase(Path(log).as_posix(), p) for log in logs for p in patterns):
        return ""
    listed = ", ".join(shown(str(p)) for p in patterns)
    return (
        f"config: 'monitor.robots.{name}.program.logs' holds {listed}; no log of this robot has such a name, as "
        f"'{logs[-1]}', and no program is named by it (allowed: patterns of the whole path, as '*/weld_*')"
    )


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


def batches_of(logs: Sequence[str], entry: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return key -> logs of every batch; a batch is read by one job and named after its first log.

    A batch ends after a log whose name and size say so, one name in `files_per_job` or, where the entry has none, one
    in :data:`BATCH_BYTES` over its size: a log that is added or removed anywhere changes the batch that it falls into
    and no other.
    """
    groups: list[list[str]] = [[]]
    for log in logs:
        groups[-1].append(log)
        per_job = entry.get("files_per_job") or BATCH_BYTES / _size(log)
        if zlib.crc32(os.fsencode(log)) < 2**32 / per_job:
            groups.append([])
    return {log_key(group[0]): group for group in groups if group}


def _size(log: str) -> float:
    """Return the size of a log [bytes], rounded up to a power of two, or a full batch for a folder and a log that is
    yet to be fetched.

    Sizes are asked for at every start of Snakemake, on a cluster for every job: a log that grows meanwhile must not
    move the end of its batch, which it now does only on passing a power of two.
    """
    try:
        found = os.stat(log)
    except OSError:
        return BATCH_BYTES
    return 1 << max(found.st_size - 1, 0).bit_length() if stat.S_ISREG(found.st_mode) else BATCH_BYTES
