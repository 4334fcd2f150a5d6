"""A crate as somebody handed it over: unpacked, and checked for what it says of itself before anything of it runs."""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from jointwear.files.errors import InputError, shown
from jointwear.files.json_documents import read_json
from jointwear.files.schemas import check
from jointwear.publishing.crate.layout import CODE, FILES, METADATA, REPORT, STAMP, files_of
from jointwear.publishing.soundness import checksum

#: Most files of a crate; that of the whole reproduction has about 500.
MOST_FILES = 100_000
#: Most folders inside each other; results have six. What walks a tree, and what removes one, calls itself at each.
DEEPEST = 50
#: How a zip file may be packed: `zip`, Python and every desktop do no more, and other ways pack a bomb far smaller.
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
#: Most that a file may unpack to, as a multiple of what it is packed to; text with many digits reaches 10. Files below
#: :data:`HARMLESS` bytes may be anything.
LARGEST_RATIO, HARMLESS = 100, 16 << 20
_SHA256 = "^[0-9a-f]{64}$"
_LISTING = {
    "type": "object",
    "required": ["results", "inputs", "wanted", "software", "seed"],
    "properties": {
        "results": {
            "type": "object",
            "additionalProperties": {
                "type": "object",
                "required": ["sha256", "bytes"],
                "properties": {
                    "sha256": {"type": "string", "pattern": _SHA256, "description": "a SHA-256 is 64 digits, a to f"},
                    "bytes": {"type": "integer", "minimum": 0},
                },
            },
        },
        "inputs": {"type": "array", "items": {"type": "string"}},
        "wanted": {"type": "array", "items": {"type": "string"}},
        "software": {"type": "object", "additionalProperties": {"type": "string"}},
        "seed": {"type": "integer"},
    },
}


@contextmanager
def unpacked(crate: str | Path) -> Iterator[Path]:
    """Give the folder of a crate, which may be a folder or a zip file.

    Raises
    ------
    InputError : if there is no crate of this project at the path, or it is too large for the disk.
    """
    path = Path(crate)
    try:
        kind = path.stat().st_mode
    except (OSError, ValueError):
        raise InputError(
            f"config: 'crate' is {crate}: no such file or folder; `make crate` writes one to crate"
        ) from None
    if stat.S_ISDIR(kind):
        yield _top(path, crate)
        return
    if not stat.S_ISREG(kind):
        raise InputError(f"config: 'crate' is {crate}: neither a folder nor a zip file")
    with tempfile.TemporaryDirectory(prefix="jointwear-crate-") as folder:
        try:
            with zipfile.ZipFile(path) as file:
                _check_size(file, folder, crate)
                file.extractall(folder)
        except (
            zipfile.BadZipFile,
            zlib.error,
            EOFError,
            NotImplementedError,
            RuntimeError,
            ValueError,
            OSError,
        ) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"config: 'crate' is {crate}: neither a folder nor a whole zip file ({error})") from None
        yield _top(Path(folder), crate)


def _check_size(file: zipfile.ZipFile, folder: str, crate: str | Path) -> None:
    """Check what an archive says of itself: the number, the names, the packing and the sizes of its files."""
    entries = file.infolist()
    if len(entries) > MOST_FILES:
        raise InputError(f"config: 'crate' is {crate}: holds {len(entries)} files (allowed: at most {MOST_FILES})")
    seen: set[str] = set()
    for entry in entries:
        name = entry.filename
        if not name.strip("/"):
            raise InputError(f"config: 'crate' is {crate}: holds a file without a name")
        if name in seen:
            raise InputError(f"config: 'crate' is {crate}: holds {shown(name)} twice")
        seen.add(name)
        plain = PureWindowsPath(name)  # knows the separators and drives of all systems
        if plain.anchor or ".." in plain.parts:
            raise InputError(f"config: 'crate' is {crate}: names {shown(name)}, which lies outside of it")
        if name.count("/") > DEEPEST:
            raise InputError(f"config: 'crate' is {crate}: {shown(name)} lies more than {DEEPEST} folders deep")
        if entry.compress_type not in METHODS:
            raise InputError(f"config: 'crate' is {crate}: {shown(name)} is packed in another way than deflate")
    # As one: entries may share what is packed, so that each alone looks harmless.
    size, packed = sum(entry.file_size for entry in entries), Path(file.filename).stat().st_size
    if size > max(HARMLESS, LARGEST_RATIO * packed):
        raise InputError(
            f"config: 'crate' is {crate}: {packed} bytes unpack to {size} (allowed: at most {LARGEST_RATIO} times them)"
        )
    room = shutil.disk_usage(folder).free
    if size > room // 2:
        raise InputError(f"config: 'crate' is {crate}: unpacks to {size} bytes; {folder} has room for {room}")


def _top(folder: Path, crate: str | Path) -> Path:
    found = sorted([*folder.glob(METADATA), *folder.glob(f"*/{METADATA}")])
    if not found or not (found[0].parent / FILES).is_file():
        raise InputError(f"config: 'crate' is {crate}: holds no {METADATA} with {FILES}; it is no crate of jointwear")
    if len(found) > 1:
        raise InputError(f"config: 'crate' is {crate}: holds {METADATA} in {len(found)} places; hand over one crate")
    return found[0].parent


def listing(crate: Path) -> dict[str, Any]:
    """Return what the crate lists: results with checksums, wanted files, software, seed.

    Raises
    ------
    InputError : if the list is broken, empty, lacks the report, or names files outside the results.
    """
    path = crate / FILES
    found = read_json(path)
    check(found, _LISTING, path)
    results, wanted = found["results"], found["wanted"]
    if not results or not wanted:
        raise InputError(f"{path}: lists no results; there is nothing to verify")
    if len(set(wanted)) < len(wanted):
        raise InputError(f"{path}: 'wanted' names a file twice")
    for name in (*results, *wanted):
        parts = PurePosixPath(name).parts
        if name != str(PurePosixPath(*parts)) or len(parts) < 2 or parts[0] != "results" or ".." in parts:
            raise InputError(f"{path}: lists '{name}', which is no file below results")
    for name in (*REPORT, *wanted):
        if name not in results:
            raise InputError(f"{path}: '{name}' is not among the results that it lists")
    return found


def check_contents(crate: Path) -> None:
    """Check that the crate holds what it lists and nothing else, every file with its size and SHA-256.

    Raises
    ------
    InputError : naming the first file that is missing, additional, a link, or not what its checksum says.
    """
    listed = listing(crate)["results"]
    described = _described(crate)
    there = set(_regular_files(crate))
    for name, facts in {**described, **listed}.items():
        if name not in there:
            raise InputError(f"{crate / name}: is listed but not there; the crate is not whole")
        own = checksum(crate / name)
        said = {facts["sha256"], described.get(name, facts)["sha256"]}
        if said != {own}:
            raise InputError(f"{crate / name}: its SHA-256 is not the one that the crate lists; the file was changed")
        if facts.get("bytes", (crate / name).stat().st_size) != (crate / name).stat().st_size:
            raise InputError(f"{crate / name}: its size is not the one that the crate lists")
    results = {name for name in there if name.startswith("results/")}
    more = sorted(there - described.keys() - {METADATA} | results - listed.keys())
    if more:
        raise InputError(f"{crate / more[0]}: is not listed; a crate holds nothing but what it lists")


def _described(crate: Path) -> dict[str, dict[str, Any]]:
    """Return the files with a checksum that the metadata of the crate describe."""
    path = crate / METADATA
    graph = read_json(path).get("@graph")
    if not isinstance(graph, list) or not all(isinstance(e, Mapping) for e in graph):
        raise InputError(f"{path}: '@graph' must be a list of entities")
    found: dict[str, dict[str, Any]] = {}
    for entity in graph:
        name = entity.get("@id")
        if not isinstance(entity.get("sha256"), str) or not name:
            continue
        if not isinstance(name, str) or name in found:
            what = "twice" if isinstance(name, str) else "by what is no text"
            raise InputError(f"{path}: describes the file {shown(name)} {what}")
        found[name] = {"sha256": entity["sha256"]}
    return found


def _regular_files(crate: Path) -> Iterator[str]:
    """Yield the names of the files of a crate; anything but files and folders is refused."""
    waiting, count = [(crate, 0)], 0
    while waiting:
        folder, depth = waiting.pop()
        if depth > DEEPEST:
            raise InputError(f"{crate}: has more than {DEEPEST} folders inside each other")
        for entry in sorted(os.scandir(folder), key=lambda e: e.name):
            path, count = folder / entry.name, count + 1
            if count > MOST_FILES:
                raise InputError(f"{crate}: holds more than {MOST_FILES} files")
            if entry.is_dir(follow_symlinks=False):
                waiting.append((path, depth + 1))
            elif not entry.is_file(follow_symlinks=False):
                raise InputError(f"{path}: is a link or a special file; a crate holds regular files only")
            elif entry.name != STAMP:
                yield path.relative_to(crate).as_posix()


def foreign_code(crate: Path, own: Path) -> list[str]:
    """Return the files of the crate's workflow that differ from those of the project in `own`, in either direction."""
    theirs, ours = ({name: checksum(root / name) for name in files_of(root, CODE)} for root in (crate, own))
    return sorted(name for name in theirs.keys() | ours.keys() if theirs.get(name) != ours.get(name))
