"""Which logs the patterns of monitored robots match, and in words what of them cannot be read.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from glob import has_magic
from pathlib import Path
from typing import Any

from jointwear.files.errors import InputError, nearest, shown
from jointwear.files.patterns import matches
from jointwear.files.regular_files import broken_link
from jointwear.files.wording import count
from jointwear.measurement.log_kinds import (
    ALLOWED,
    is_folder_like_log,
    log_format,
    log_sources,
    no_kind_of_log,
    unpacked,
)
from jointwear.monitor.order_of_logs import in_order

#: What is said of a log whose name is in another encoding, and the mend.
_NO_UTF8 = "whose name is not UTF-8, so that it cannot be read; rename it"


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


def find_logs(patterns: Iterable[str], where: str = "logs") -> list[str]:
    """Return the logs that the patterns match, each once, in order of their names.

    Raises
    ------
    InputError : if a pattern matches nothing that can be read, a match is of an unknown kind, or lies (through a link)
        outside the folder that its pattern names.
    """
    return in_order(log for pattern in patterns for log in _matching(pattern, where)[0])


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


def _matching(pattern: str, where: str) -> tuple[list[str], list[str]]:
    """Return the logs that a pattern matches, and in words which others cannot be read; see :func:`find_logs`."""
    matching = matches(pattern)
    if not matching:
        folder = _folder(pattern)
        there = [p.name for p in folder.iterdir() if not _misnamed(p)] if folder.is_dir() else []
        hint = nearest(Path(pattern).name, there) if folder.is_dir() else _no_folder(pattern, folder)
        if "\\" in pattern:
            hint = f"; write folders with /, as '{pattern.replace(chr(92), '/')}'"
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
        match = (packed or matching or list(foreign.values()))[0]
        what = "is packed; unpack it" if packed else no_kind_of_log(match)
        if not packed and misnamed:
            match, what = misnamed[0], "its name is not UTF-8; rename it"
        elif not packed and links:
            match, what = next(iter(links.items()))
        elif not packed and folders:
            match, what = folders[0], f"is a folder; name the files in it, as '{folders[0]}/*'"
        raise InputError(f"{holds} '{match}': {what} (allowed: {ALLOWED})")
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


def _folder(pattern: str) -> Path:
    """The folder that a pattern names: its parts before the first with a wildcard, without the file name."""
    parts = Path(pattern).parts
    fixed = next((i for i, part in enumerate(parts) if has_magic(part)), len(parts) - 1)
    return Path(*parts[:fixed]) if fixed else Path(".")


def _no_folder(pattern: str, folder: Path) -> str:
    """Return in words that the folder of a pattern is not there, with the pattern of the nearest one that is."""
    there = next(p for p in (folder, *folder.parents) if p.is_dir())
    lost = folder.relative_to(there).parts[0]
    folders = [p.name for p in there.iterdir() if p.is_dir()] if may_be_read(there) else []
    if close := get_close_matches(lost, folders, n=1):
        parts = list(Path(pattern).parts)
        parts[len(there.parts)] = close[0]
        return f"; there is no folder {folder}; did you mean '{Path(*parts).as_posix()}'?"
    return f"; there is no folder {folder}"


def _misnamed(path: str | Path) -> str:
    """Return a path whose name is not UTF-8 as a message shows it, empty for all others: no table or record can hold
    such a name."""
    name = os.fsencode(path)
    try:
        name.decode()
    except UnicodeDecodeError:
        return name.decode(errors="backslashreplace")
    return ""
