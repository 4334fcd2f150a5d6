"""Which paths are opened at all: regular files of a stated size. A pipe would be waited for without end."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from itertools import islice
from pathlib import Path

from jointwear.files.errors import InputError, nearest

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
#: Top folder of the project that this library belongs to.
ROOT = Path(__file__).resolve().parents[3]
#: Neighbours that a hint is looked for among.
_NEIGHBOURS = 1000


def check_regular(path: str | Path, largest: int | None = None) -> Path:
    """Return `path` if it is a regular file (or a link to one) of at most `largest` bytes.

    Raises
    ------
    InputError : one line naming the path and what it is instead; for a missing file the one with the nearest name.
    """
    try:
        found = Path(path).stat()
    except OSError as error:
        if fault := broken_link(path):
            raise InputError(f"{path}: is {fault}") from None
        if isinstance(error, (FileNotFoundError, NotADirectoryError)):
            raise InputError(f"{path}: no such file{nearest_file(Path(path))}") from None
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise InputError(f"{path}: is no path ({error})") from None
    if not stat.S_ISREG(found.st_mode):
        kind = _KINDS.get(stat.S_IFMT(found.st_mode), "no file")
        raise InputError(f"{path}: is {kind}; only regular files are read")
    if largest is not None and found.st_size > largest:
        raise InputError(f"{path}: has {found.st_size} bytes (allowed: at most {largest})")
    return Path(path)


def broken_link(path: str | Path) -> str:
    """Return in words what is wrong with a symbolic link that leads to nothing, with the mend; empty for all else."""
    if not os.path.islink(path):
        return ""
    try:
        os.stat(path)
    except FileNotFoundError:
        there = os.readlink(path)
        return f"a symbolic link to '{there}', which does not exist; point it at the file, or remove it"
    except OSError as error:
        if error.errno == errno.ELOOP:
            return "one of symbolic links that lead in a circle; point it at the file, or remove it"
    return ""


def read_text(path: str | Path, largest: int) -> str:
    """Return the text of a regular file of at most `largest` bytes.

    Raises
    ------
    InputError : if it is no such file, cannot be read, or is not UTF-8.
    """
    path = check_regular(path, largest)
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file in UTF-8") from None


def nearest_file(path: Path) -> str:
    """Return a hint at the file with the nearest name, here or beside the workflow, where a path is looked up too."""
    names: set[str] = set()
    for folder in (path.parent, ROOT / path.parent):
        with suppress(OSError, ValueError, NotImplementedError):
            names.update(p.name for p in islice(folder.glob(f"*{path.suffix}"), _NEIGHBOURS) if p != path)
    return nearest(path.name, sorted(names))
