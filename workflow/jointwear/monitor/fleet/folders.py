"""Which folder of a fleet is whose: robots of one name do not share a history, one robot under other patterns does."""

from __future__ import annotations

import zlib
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from jointwear.files.digests import digest
from jointwear.files.errors import InputError
from jointwear.files.regular_files import read_text
from jointwear.files.text_files import replace_text
from jointwear.monitor.fleet.plan import WHOSE
from jointwear.monitor.fleet.reading import Readings

#: Largest mark of whose a folder is: two digests, a checksum and a line's end. Bytes.
LARGEST_MARK = 200


def own_folder(
    folder: Path,
    name: str,
    entry: Mapping[str, Any],
    logs: Sequence[str] = (),
    configuration: str = "",
    complete: bool = True,
) -> Path:
    """Return the folder of a robot: `folder`/`name`, made if it is not there.

    A robot of the same name with other logs, or with some of the same logs and of another configuration, has a folder
    of its own. Within one configuration other patterns that match logs which were read before are the same robot.

    Parameters
    ----------
    logs : that can be reached now. configuration : which configuration names the robot, a word without spaces.
    complete : whether `logs` are all that the patterns match; others that are there are left out of what was read.
    """
    whose = digest(list(entry.get("logs", ())))
    known = [folder / name, *sorted(folder.glob(f"{name}_{'[0-9a-f]' * 8}"))]
    marks = {own: _mark(own / WHOSE) for own in known if (own / WHOSE).exists()}
    own = next((own for own, mark in marks.items() if mark[:1] == [whose]), None)
    if own is None:
        own = next((own for own, mark in marks.items() if _taken_on(own, mark, logs, configuration)), None)
        if own is not None and complete:
            Readings(own).leave_out(logs)
    own = own or folder / (name if folder / name not in marks else f"{name}_{whose[:8]}")
    mark = f"{whose} {configuration}".strip()
    if marks.get(own) != mark.split():
        replace_text(own / WHOSE, f"{mark} {_checksum(mark)}\n")
    return own


def _taken_on(own: Path, mark: Sequence[str], logs: Sequence[str], configuration: str) -> bool:
    """Return whether a folder with another mark is of the same robot: one configuration, and logs read before.

    Of a mark that is damaged the logs alone tell.
    """
    if mark and (not configuration or list(mark[1:]) != [configuration]):
        return False
    return not set(Readings(own).logs).isdisjoint(logs)


def namesakes(own: Path, folder: Path, name: str) -> list[str]:
    """Return in words that another robot of this name has a folder, or nothing."""
    if own == folder / name:
        return []
    words = (
        f"Another robot of the name {name}, with other logs or of another configuration, is judged in {folder / name}; "
        f"this one has its own history, in {own}, and learnt what is normal anew. Give one of the two another name; if "
        "they are one robot, let its patterns match the logs that were read before."
    )
    return [words]


def further_folders(folder: Path, known: Collection[str], configuration: str) -> tuple[list[str], list[str]]:
    """Return the names of the folders of robots that a configuration named once and does not any more, and of those
    that other configurations named, both in order.

    Parameters
    ----------
    folder : of the robots. known : names of the folders of the robots that the configuration names now.
    configuration : see :func:`own_folder`.
    """
    paths = [path for path in sorted(folder.glob(f"*/{WHOSE}")) if path.parent.name not in known]
    marks = {path.parent.name: _mark(path)[1:] for path in paths}
    left = [name for name, whose in marks.items() if whose == [configuration]]
    return left, [name for name, whose in marks.items() if whose not in ([], [configuration])]


def _mark(file: Path) -> list[str]:
    """Return the words of a mark; of one that cannot be read, or is damaged, none."""
    try:
        text = read_text(file, LARGEST_MARK).strip()
    except InputError:
        return []
    words, _, checksum = text.rpartition(" ")
    return words.split() if checksum == _checksum(words) else []


def _checksum(words: str) -> str:
    """Return the CRC-32 of the words of a mark, so that one with a changed letter is not that of another robot."""
    return f"{zlib.crc32(words.encode()):08x}"
