"""The first lines of a CSV log: a preamble, the header, a row of units, and how its numbers are written."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from jointwear.files.errors import EMPTY, NO_SAMPLES, InputError
from jointwear.files.wording import count
from jointwear.measurement.formats.blanks import BLANK, single
from jointwear.measurement.formats.chunk import NEEDED
from jointwear.measurement.formats.columns import check_count, find_columns
from jointwear.measurement.formats.first_bytes import check_kind
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.named_units import is_unit, unit_of
from jointwear.measurement.formats.number_signs import decimal_sign
from jointwear.measurement.formats.unpacked import is_broken, open_text
from jointwear.measurement.units import UNITS

#: What stands for a missing value in a cell.
MISSING = ["", "nan", "NaN", "NAN", "null", "NULL", "NA", "N/A", "-nan", "None"]

#: First bytes of what is given the name of a CSV file by mistake, and what to do about it.
_OTHER_FILES = {
    b"\xff\xfe": "is text in UTF-16; save it as UTF-8",
    b"\xfe\xff": "is text in UTF-16; save it as UTF-8",
    b"PK\x03\x04": "is a workbook of a spreadsheet or a zip file, not text; export it as CSV, or unpack it",
    b"\x1f\x8b": "is packed by gzip; unpack it, or let its name end with .csv.gz",
}
#: How lines of JSON begin, and a list of it.
_JSON = (b'{"', b"[{")
#: Lines looked at for the header and for the form of the numbers.
_LOOK = 60


@dataclass(frozen=True)
class Head:
    """What the first lines tell: `names` of the columns, lines to `skip`, `first` row of values (may be empty),
    `delimiter`, `decimal` sign, `encoding`, and role -> unit of a row of units,
    or one for each column."""

    names: list[str]
    skip: int
    first: list[str]
    delimiter: str
    decimal: str
    encoding: str
    units: dict[str, str | list[str]]


def head_of(path: Path, layout: Layout) -> Head:
    """Return what the first lines of a log tell: a preamble may come before the header, a row of units after it.

    Raises
    ------
    InputError : if there is no text, no header or no table of numbers.
    """
    lines, encoding = _first_lines(path)
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: {EMPTY}")
    place, names, delimiter = _find_header(path, lines, layout)
    lines = [single(line) for line in lines] if delimiter == BLANK else lines
    check_count(path, len(names))
    seen: set[str] = set()
    twice = next((name for name in names if name in seen or seen.add(name)), None)
    if twice is not None:
        raise InputError(f"{path}: the header names the column '{twice}' twice")
    if 2 * sum(is_number(name.replace(",", ".")) for name in names) > len(names):
        raise InputError(f"{path}: the first line holds numbers; a header line with the names of the columns is needed")
    try:
        rows = [r for r in csv.reader(lines[place + 1 :], delimiter=delimiter) if r]
    except csv.Error as error:
        raise InputError(f"{path}: cannot be read as CSV ({error})") from None
    skip, units = place + 1, {}  # role -> unit, or the units of its columns
    while rows and [cell.strip() for cell in rows[0]] == names:
        skip, rows = skip + 1, rows[1:]
    if rows and len(rows[0]) == len(names) and not any(_is_value(cell) for cell in rows[0]):
        cells = dict(zip(names, (cell.strip().strip("[]() ") for cell in rows[0]), strict=True))
        for role, columns in find_columns(path, names, layout).items():
            if role in UNITS and (unit := unit_of([cells[column] for column in columns], role)):
                units[role] = unit
        skip, rows = skip + 1, rows[1:]
    elif place:
        units = _units_above(path, lines[place - 1], names, delimiter, layout)
    _check_no_lists(path, names, rows, layout)
    names = _with_last(names, rows)
    decimal = decimal_sign(path, _numbers(path, names, rows, layout))
    if delimiter == "," and rows and len(rows[0]) > len(names):
        raise InputError(
            f"{path}: the header names {count(len(names), 'column')}, the first row has "
            f"{count(len(rows[0]), 'cell')}: are its decimals commas? "
            "Write them with points, or separate the columns by semicolons"
        )
    return Head(names, skip, rows[0] if rows else [], delimiter, decimal, encoding, units)


def _check_no_lists(path: Path, names: list[str], rows: list[list[str]], layout: Layout) -> None:
    """Check that no role that is needed is a column of lists.

    Raises
    ------
    InputError : with how to write it.
    """
    first = dict(zip(names, rows[0], strict=False)) if rows else {}
    for name in (str(layout.names[role]) for role in NEEDED):
        if first.get(name, "").lstrip().startswith("["):
            raise InputError(
                f"{path}: the column '{name}' holds lists, which are not read from text: write one column for each "
                f"joint, '{name}_1', '{name}_2' ..., or the table as Parquet, whose lists are read"
            )


def _units_above(path: Path, line: str, names: list[str], delimiter: str, layout: Layout) -> dict[str, str | list[str]]:
    """Return role -> unit, or one for each column, of the line above the header where it holds units; else nothing."""
    cells = [cell.strip().strip("[]() ") for cell in next(csv.reader([line], delimiter=delimiter), [])]
    if len(cells) != len(names) or any(_is_value(cell) for cell in cells):
        return {}
    there, found = dict(zip(names, cells, strict=True)), {}
    for role, columns in find_columns(path, names, layout).items():
        said = [there[column] for column in columns]
        if role not in UNITS or role == "trajectory" or not any(said):
            continue
        if not all(is_unit(role, cell) for cell in said if cell):
            return {}
        found[role] = unit_of(said, role)
    return found


def _with_last(names: list[str], rows: list[list[str]]) -> list[str]:
    """Return the names of the columns with one more, or less, where a delimiter ends each row and not the header, or
    the header and no row."""
    if rows and all(len(row) == len(names) + 1 and not row[-1].strip() for row in rows) and "" not in names:
        return [*names, ""]
    if rows and not names[-1] and all(len(row) == len(names) - 1 for row in rows):
        return names[:-1]
    return names


def _numbers(path: Path, names: list[str], rows: list[list[str]], layout: Layout) -> dict[str, list[str]]:
    """Return name -> cells of the columns that are read as numbers; those of others say nothing of the decimal sign."""
    try:
        columns = find_columns(path, names, layout)
    except InputError:
        return {}  # told by the one who reads on
    places = {name: names.index(name) for role, group in columns.items() if role != "program" for name in group}
    return {name: [row[place] for row in rows if place < len(row)] for name, place in places.items()}


def _first_lines(path: Path) -> tuple[list[str], str]:
    """Return the first lines and the encoding: UTF-8, or the code page that Western Windows writes.

    Raises
    ------
    InputError : if the file is no text; if it holds a single line without a line end, which no sample follows.
    """
    raw: list[bytes] = []
    try:
        with open_text(path) as file:
            for _ in range(_LOOK):
                raw.append(file.readline(1 << 20))
            if is_broken(file) and not any(raw):
                raise InputError(f"{path}: cannot be read (it is not packed by gzip, or was cut or damaged)")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    whole = b"".join(raw)
    for start, words in _OTHER_FILES.items():
        if whole.startswith(start):
            raise InputError(f"{path}: {words}")
    check_kind(path, "csv", whole)
    if whole.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(_JSON):
        raise InputError(
            f"{path}: holds JSON, not CSV; write one row for each time and one column for each name, as pandas does by "
            "pandas.read_json(..., lines=True).to_csv(..., index=False)"
        )
    if b"\x00" in whole:
        raise InputError(f"{path}: is not a text file in UTF-8")
    for encoding in ("utf-8-sig", "cp1252"):
        try:
            text = whole.decode(encoding)
        except UnicodeDecodeError:
            continue
        lines = text.splitlines()
        if lines == [text] and text.strip():
            # Its logger has just begun it: half a header would be taken for one that lacks columns.
            raise InputError(f"{path}: {NO_SAMPLES}")
        return lines, "utf8" if encoding == "utf-8-sig" else encoding
    raise InputError(f"{path}: is not a text file in UTF-8")


def _find_header(path: Path, lines: list[str], layout: Layout) -> tuple[int, list[str], str]:
    """Return the line that names the columns, the names and the delimiter; where none fits, of the first line that a
    line of values follows, else of the first."""
    rows: list[tuple[int, list[str], str]] = []
    for k, line in enumerate(lines):
        if not line.strip():
            continue
        delimiter = max(",;\t|", key=line.count)
        try:
            names = [name.strip() for name in next(csv.reader([line], delimiter=delimiter), [])]
        except csv.Error as error:
            raise InputError(f"{path}: cannot be read as CSV ({error})") from None
        check_count(path, len(names))
        rows.append((k, names, delimiter))
        if _has_columns(path, names, layout):
            return rows[-1]
    for k, line in enumerate(lines):
        names = next(csv.reader([single(line)], delimiter=BLANK), [])
        if _has_columns(path, names, layout):
            return k, names, BLANK
    return next((row for row, (k, *_) in pairwise(rows) if _heads(row[1], lines[k], row[2])), rows[0])


def _heads(names: list[str], following: str, delimiter: str) -> bool:
    """Return whether a line of names stands above a line of as many values."""
    cells = next(csv.reader([following], delimiter=delimiter, strict=False), [])
    above, below = (sum(map(_is_value, row)) for row in (names, cells))
    return len(names) == len(cells) > 2 and 2 * above < len(names) < 2 * below


def _has_columns(path: Path, names: list[str], layout: Layout) -> bool:
    """Return whether names are those of the columns that the layout asks for."""
    try:
        return len(names) >= 3 and bool(find_columns(path, names, layout))
    except InputError:
        return False


def _is_value(cell: str) -> bool:
    """Return whether a cell is a number, a time or a missing value rather than a unit."""
    text = cell.strip()
    return is_number(text.replace(",", ".")) or bool(re.match(r"\d", text)) or text in MISSING[1:]


def is_number(text: str) -> bool:
    """Return whether a text is a number with a decimal point."""
    try:
        float(text)
    except ValueError:
        return False
    return True
