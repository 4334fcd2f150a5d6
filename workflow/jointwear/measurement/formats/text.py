"""CSV logs: a header line, one column an axis; separated by commas, semicolons, tabs or |.

A preamble before the header, a row of units after or above it, decimal commas and code page 1252 are read as they are.
So are files that a logger packs by gzip, if their name ends with .gz: they are unpacked block by block.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path

import pyarrow as pa
from pyarrow import csv as arrow_csv

from jointwear.files.errors import EMPTY, NO_SAMPLES, InputError, shown
from jointwear.files.wording import count
from jointwear.measurement.formats.arrow import chunk_of, stamps
from jointwear.measurement.formats.cells import Cells, of_open_quote
from jointwear.measurement.formats.chunk import Chunk, RowsLeftOut, check_count, find_columns
from jointwear.measurement.formats.first_bytes import check_kind
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.local_stamps import LocalStamps
from jointwear.measurement.formats.named_units import is_unit, unit_of, with_names
from jointwear.measurement.formats.number_signs import decimal_sign
from jointwear.measurement.formats.unpacked import is_broken, is_packed, open_text
from jointwear.measurement.units import UNITS

_MISSING = ["", "nan", "NaN", "NAN", "null", "NULL", "NA", "N/A", "-nan", "None"]
#: What loggers and spreadsheets write besides where a value is missing; in a row of units "-" is one.
_ALSO_MISSING = ["#N/A", "#NA", "n/a", "-", "--", "---", "#VALUE!", "ERROR", "Error", "error"]
_BYTES_A_NUMBER = 18


#: First bytes of what is given the name of a CSV file by mistake, and what to do about it.
_OTHER_FILES = {
    b"\xff\xfe": "is text in UTF-16; save it as UTF-8",
    b"\xfe\xff": "is text in UTF-16; save it as UTF-8",
    b"PK\x03\x04": "is a workbook of a spreadsheet or a zip file, not text; export it as CSV, or unpack it",
    b"\x1f\x8b": "is packed by gzip; unpack it, or let its name end with .csv.gz",
}
#: How lines of JSON begin, and a list of it.
_JSON = (b'{"', b"[{")
#: What the reader says of a cell that is not of its column's type.
_CONVERSION = "conversion error"
#: Lines looked at for the header and for the form of the numbers.
_LOOK = 60
#: Bytes at the end of a log in which a row that was cut is looked for.
_LAST = 1 << 16
#: Rows of a wrong length up to which the others are still read: each is a write that was cut, many are another layout.
MOST_TORN = 10


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


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a CSV file; see :func:`jointwear.measurement.formats.read_log`.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    RowsLeftOut : after the last sample, if rows of a wrong length were left out.
    """
    head = _head(path, layout)
    columns = find_columns(path, head.names, layout)
    wanted = list(dict.fromkeys(c for group in columns.values() for c in group))
    types: dict[str, pa.DataType] = {name: pa.float64() for name in wanted}
    types |= {name: pa.string() for name in columns.get("program", [])}
    if head.first:
        place = head.names.index(columns["time"][0])
        cell = head.first[place].strip() if place < len(head.first) else ""
        if not _is_number(cell.replace(",", ".")):
            stamps(path, pa.array([cell]))
            types[columns["time"][0]] = pa.string()
    head = replace(head, units=with_names(path, columns, head.units, layout.units))
    done, time = 0, columns["time"][0]
    torn = _TornRow(path, head.encoding)
    local = LocalStamps(layout.time_zone)
    try:
        try:
            for batch in _batches(path, head, types, rows, torn):
                ahead = copy(local)
                chunk = chunk_of(path, batch, columns, layout, ahead, head.units)
                local, done = ahead, done + batch.num_rows
                yield chunk
        except pa.ArrowInvalid as error:
            if _CONVERSION not in str(error):
                raise
        except InputError:
            if types[time] != pa.string():
                raise
        else:
            torn.check()
            return
        # A cell holds something else than its column: what was not read yet is read as text, which takes longer.
        torn, stamped = _TornRow(path, head.encoding), types[time] == pa.string()
        words = tuple(columns.get("program", ()))
        label = columns.get("trajectory", [""])[0]
        names = tuple(head.names)
        cells = Cells(path, head.decimal, time, stamped, words, names, done, head.skip, torn.rows, label)
        for whole in _rest(_batches(path, head, dict.fromkeys(types, pa.string()), rows, torn), done):
            batch, ended = cells.up_to_another_header(whole)
            table, unread = cells.numbers(batch)
            yield replace(chunk_of(path, table, columns, layout, local, head.units), unread=unread)
            if ended:
                raise InputError(ended)
        torn.check()
    except (pa.ArrowException, OSError) as error:
        if torn.fault:
            raise InputError(torn.fault) from None
        first_line = next(iter(str(error).splitlines()), "unknown reason").rstrip(".")
        # The lines before the first row are skipped, which fails where the last of them has no end yet.
        if "Empty CSV" in first_line or "Could not skip" in first_line:
            raise InputError(f"{path}: {NO_SAMPLES}") from None
        raise InputError(f"{path}: cannot be read as CSV ({first_line})") from None


def _batches(
    path: Path, head: Head, types: dict[str, pa.DataType], rows: int, torn: _TornRow
) -> Iterator[pa.RecordBatch]:
    """Yield the columns of `types` as these, about `rows` rows at a time."""
    # pyarrow would lose the whole block in which a packed file was cut.
    file = open_text(path) if is_packed(path) else pa.input_stream(str(path), compression=None)
    with (
        file,
        arrow_csv.open_csv(
            file,
            read_options=arrow_csv.ReadOptions(
                use_threads=False,
                block_size=max(1 << 16, rows * _BYTES_A_NUMBER * len(head.names)),
                column_names=head.names,
                skip_rows=head.skip,
                encoding=head.encoding,
            ),
            parse_options=arrow_csv.ParseOptions(delimiter=head.delimiter, invalid_row_handler=torn),
            convert_options=arrow_csv.ConvertOptions(
                column_types=types,
                include_columns=list(types),
                null_values=[*_MISSING, *_ALSO_MISSING],
                strings_can_be_null=True,
                decimal_point=head.decimal,
            ),
        ) as reader,
    ):
        yield from reader
        if is_broken(file):
            raise OSError("its packing was cut or is damaged; what could be unpacked was read")


def _rest(batches: Iterator[pa.RecordBatch], done: int) -> Iterator[pa.RecordBatch]:
    """Yield what follows the first `done` rows."""
    for batch in batches:
        skipped = min(done, batch.num_rows)
        done -= skipped
        if skipped < batch.num_rows:
            yield batch.slice(skipped)


class _TornRow:
    """Leaves out `rows` of a wrong length. Any but a last row that was cut while it was written is a `fault`, which is
    raised once the others have been read; more than :data:`MOST_TORN` end the reading."""

    def __init__(self, path: Path, encoding: str) -> None:
        self._path, self._encoding, self.fault = path, encoding, ""
        self.rows: list[int] = []

    def check(self) -> None:
        """Raise a RowsLeftOut that tells of the first row that was left out and of their number, if any was."""
        if self.fault:
            others = len(self.rows) - 1
            more = f" and {count(others, 'more row')} of a wrong length were" if others else " was"
            raise RowsLeftOut(f"{self.fault}; it{more} left out")

    def __call__(self, row: arrow_csv.InvalidRow) -> str:
        """Return what pyarrow is to do with a row; an error raised here would be lost."""
        if row.actual_columns < row.expected_columns and row.text == _unfinished(self._path, self._encoding):
            return "skip"
        number = "a row" if row.number is None else f"row {row.number}"
        self.fault = self.fault or (
            f"{self._path}: {number} has {count(row.actual_columns, 'cell')}, the header names "
            f"{count(row.expected_columns, 'column')}: "
            f"{shown(row.text)}{of_open_quote(row.text)}"
        )
        self.rows.append(row.number or 0)
        return "skip" if len(self.rows) <= MOST_TORN else "error"


def ends_within_a_row(path: Path, layout: Layout) -> bool:
    """Return whether no line end follows the last row of a log, and cells are missing in it; False where the log cannot
    be read.

    Parameters
    ----------
    layout : as of :func:`read`.
    """
    try:
        head = _head(path, layout)
        row = _unfinished(path, head.encoding)
    except (InputError, OSError):
        return False
    if row is None or not row.strip():
        return False
    return len(next(csv.reader([row], delimiter=head.delimiter, strict=False), [])) < len(head.names)


def _unfinished(path: Path, encoding: str) -> str | None:
    """Return the last line of a log where no line end follows it, None where one does.

    A file in which no line ends, or whose last row is longer than what is looked at, shows no row.
    """
    end = _last_bytes(path).decode("utf-8" if encoding == "utf8" else encoding, errors="replace")
    _, ended, row = end.rpartition("\n")
    return row if ended and row else None


def _last_bytes(path: Path) -> bytes:
    """Return the last :data:`_LAST` bytes of the text of a log; a packed one is read through for them."""
    with open_text(path) as file:
        if not is_packed(path):
            file.seek(max(0, path.stat().st_size - _LAST))
            return file.read()
        end = b""
        while more := file.read(_LAST):
            end = (end + more)[-_LAST:]
        return end


def _head(path: Path, layout: Layout) -> Head:
    """Look at the first lines: a preamble may come before the header, a row of units after it."""
    lines, encoding = _first_lines(path)
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: {EMPTY}")
    place, names, delimiter = _find_header(path, lines, layout)
    check_count(path, len(names))
    seen: set[str] = set()
    twice = next((name for name in names if name in seen or seen.add(name)), None)
    if twice is not None:
        raise InputError(f"{path}: the header names the column '{twice}' twice")
    if all(_is_number(name.replace(",", ".")) for name in names):
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
    names = _with_last(names, rows)
    decimal = decimal_sign(path, _numbers(path, names, rows, layout))
    if delimiter == "," and rows and len(rows[0]) > len(names):
        raise InputError(
            f"{path}: the header names {count(len(names), 'column')}, the first row has "
            f"{count(len(rows[0]), 'cell')}: are its decimals commas? "
            "Write them with points, or separate the columns by semicolons"
        )
    return Head(names, skip, rows[0] if rows else [], delimiter, decimal, encoding, units)


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
    """Return the line that names the columns, the names and the delimiter; the first line where none fits."""
    fallback: tuple[int, list[str], str] | None = None
    for k, line in enumerate(lines):
        if not line.strip():
            continue
        delimiter = max(",;\t|", key=line.count)
        try:
            names = [name.strip() for name in next(csv.reader([line], delimiter=delimiter), [])]
        except csv.Error as error:
            raise InputError(f"{path}: cannot be read as CSV ({error})") from None
        check_count(path, len(names))
        fallback = fallback or (k, names, delimiter)
        if _has_columns(path, names, layout):
            return k, names, delimiter
    if any(_has_columns(path, line.split(), layout) for line in lines):
        raise InputError(
            f"{path}: its columns are separated by blanks, which is not read; write it with commas, semicolons or "
            "tabs, as pandas does by pandas.read_csv(..., sep=r'\\s+').to_csv(..., index=False)"
        )
    return fallback


def _has_columns(path: Path, names: list[str], layout: Layout) -> bool:
    """Return whether names are those of the columns that the layout asks for."""
    try:
        return len(names) >= 3 and bool(find_columns(path, names, layout))
    except InputError:
        return False


def _is_value(cell: str) -> bool:
    """Return whether a cell is a number, a time or a missing value rather than a unit."""
    text = cell.strip()
    return _is_number(text.replace(",", ".")) or bool(re.match(r"\d", text)) or text in _MISSING[1:]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
