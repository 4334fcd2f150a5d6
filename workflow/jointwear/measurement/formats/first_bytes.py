"""What a log is by its first bytes, where its name says another thing: what a server or a repository sent in its place,
or a log of another format."""

from __future__ import annotations

from pathlib import Path

from jointwear.files.errors import InputError

#: Bytes that tell it.
ENOUGH = 64
#: How logs of each kind begin, and how they are called.
_BEGINS = {"netcdf": (b"CDF", b"\x89HDF\r\n\x1a\n"), "parquet": (b"PAR1",)}
_NAMES = {"netcdf": "netCDF", "parquet": "Parquet", "csv": "CSV"}
#: What the name of a log of each kind ends with.
_ENDINGS = {"netcdf": ".nc", "parquet": ".parquet"}
#: How a web page begins, and a pointer that git-lfs leaves where a file has not been fetched.
_PAGES, _POINTER = (b"<!doctype html", b"<html"), b"version https://git-lfs"


def check_kind(path: Path, kind: str, begin: bytes) -> None:
    """Check that a log with the name of a `kind` does not begin as something else does.

    Parameters
    ----------
    begin : its first bytes, :data:`ENOUGH` or more, unpacked.

    Raises
    ------
    InputError : with what it is, and what to do.
    """
    name = _NAMES[kind]
    text = begin.lstrip(b"\xef\xbb\xbf \t\r\n")
    if text[:ENOUGH].lower().startswith(_PAGES):
        raise InputError(
            f"{path}: is a web page, not {name}, as a server sends in place of a file after a failed login"
        )
    if text.startswith(_POINTER):
        raise InputError(f"{path}: is a pointer of git-lfs, not the file itself; fetch that, as by 'git lfs pull'")
    for other, begins in _BEGINS.items():
        if other != kind and begin.startswith(begins):
            raise InputError(f"{path}: is {_NAMES[other]}, not {name}; let its name end with {_ENDINGS[other]}")
