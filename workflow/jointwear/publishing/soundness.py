"""Are results whole? Every file is opened and read to its end before anything is packed or published."""

from __future__ import annotations

import csv
import hashlib
import io
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping
from pathlib import Path

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json
from jointwear.files.regular_files import check_regular
from jointwear.files.storage import open_dataset, read_variable
from jointwear.publishing.figures.seal import unsealed


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def check_results(root: Path, names: Iterable[str], read: Mapping[str, str] | None = None) -> None:
    """Check that results are there, whole, and what later jobs have read.

    Parameters
    ----------
    root : folder of the project.
    names : files relative to it.
    read : SHA-256 of files as later jobs have read them, by name.

    Raises
    ------
    InputError : naming the first file that is missing, cut, damaged, or changed since.
    """
    known = read or {}
    for name in names:
        path = check_regular(root / name)
        check_whole(path)
        if name in known and checksum(path) != known[name]:
            raise InputError(f"{path}: was changed after later jobs had read it; delete it and run again")


def check_whole(path: Path) -> None:
    """Open a result by its kind and read it to its end.

    Raises
    ------
    InputError : naming the file, if it is cut or damaged.
    """
    if path.suffix == ".nc":
        with open_dataset(path) as dataset:
            for name in dataset.variables:
                read_variable(dataset, path, name)
        return
    if path.suffix == ".json":
        read_json(path, object)
        return
    if path.suffix not in (".csv", ".html", ".svg", ".yaml", ".urdf"):
        return
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is damaged: it is not text in UTF-8; delete it and run again") from None
    fault = _fault(path.suffix, text)
    if path.suffix == ".svg":
        unsealed(text, path)
    if fault:
        raise InputError(f"{path}: is cut or damaged: {fault}; delete it and run again")


def _fault(kind: str, text: str) -> str:
    """Return what is wrong with a text file that this workflow wrote, empty if nothing is."""
    if not text.strip():
        return "it is empty"
    if kind == ".html" and not text.rstrip().endswith("</html>"):
        return "its end is missing"
    if kind in (".svg", ".urdf"):
        try:
            ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            return f"it is not valid XML ({error})"
    if kind == ".csv":
        if not text.endswith("\n"):
            return "its last line has no end"
        widths = {len(row) for row in csv.reader(io.StringIO(text))}
        if len(widths) > 1:
            return "its rows differ in length"
    return ""
