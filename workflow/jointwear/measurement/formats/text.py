"""CSV logs: a header line, one column an axis; separated by commas, semicolons, tabs, | or blanks.

A preamble before the header, a row of units after or above it, decimal commas and code page 1252 are read as they are.
So are files that a logger packs by gzip, if their name ends with .gz: they are unpacked block by block.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from copy import copy
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
from pyarrow import csv as arrow_csv

from jointwear.files.errors import NO_SAMPLES, InputError, shown
from jointwear.files.wording import count
from jointwear.measurement.formats.arrow import chunk_of, stamps
from jointwear.measurement.formats.blanks import BLANK, single, with_single_blanks
from jointwear.measurement.formats.cells import Cells, of_open_quote
from jointwear.measurement.formats.chunk import Chunk, RowsLeftOut
from jointwear.measurement.formats.columns import find_columns
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.local_stamps import LocalStamps
from jointwear.measurement.formats.named_units import with_names
from jointwear.measurement.formats.text_head import MISSING, Head, head_of, is_number
from jointwear.measurement.formats.two_times import with_one_time
from jointwear.measurement.formats.unpacked import is_broken, is_packed, open_text

#: What loggers and spreadsheets write besides where a value is missing; in a row of units "-" is one.
_ALSO_MISSING = ["#N/A", "#NA", "n/a", "-", "--", "---", "#VALUE!", "ERROR", "Error", "error"]
_BYTES_A_NUMBER = 18


#: What the reader says of a cell that is not of its column's type.
_CONVERSION = "conversion error"
#: Bytes at the end of a log in which a row that was cut is looked for.
_LAST = 1 << 16
#: Rows of a wrong length up to which the others are still read: each is a write that was cut, many are another layout.
MOST_TORN = 10


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a CSV file; see :func:`jointwear.measurement.formats.read_log`.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    RowsLeftOut : after the last sample, if rows of a wrong length were left out.
    """
    head = head_of(path, layout)
    columns = find_columns(path, head.names, layout)
    wanted = list(dict.fromkeys(c for group in columns.values() for c in group))
    types: dict[str, pa.DataType] = {name: pa.float64() for name in wanted}
    types |= {name: pa.string() for name in columns.get("program", [])}
    times = columns["time"]
    stamped = _is_stamped(path, head, times)
    if stamped:
        types[times[0]] = pa.string()
    head = replace(head, units=with_names(path, columns, head.units, layout.units))
    done, time = 0, times[0]
    columns = {**columns, "time": [time]}
    torn = _TornRow(path, head)
    local = LocalStamps(layout.time_zone)
    try:
        try:
            # What is joined of two columns is text.
            for batch in _batches(path, head, types, rows, torn) if len(times) == 1 else ():
                ahead = copy(local)
                chunk = chunk_of(path, batch, columns, layout, ahead, head.units)
                local, done = ahead, done + batch.num_rows
                yield chunk
        except pa.ArrowInvalid as error:
            if _CONVERSION not in str(error):
                raise
        except InputError:
            if not stamped:
                raise
        else:
            if len(times) == 1:
                torn.check()
                return
        # A cell holds something else than its column: what was not read yet is read as text, which takes longer.
        torn = _TornRow(path, head)
        words = tuple(columns.get("program", ()))
        label = columns.get("trajectory", [""])[0]
        names = tuple(head.names)
        cells = Cells(path, head.decimal, time, stamped, words, names, done, head.skip, torn.rows, label)
        for whole in _rest(_batches(path, head, dict.fromkeys(types, pa.string()), rows, torn), done):
            batch, ended = cells.up_to_another_header(with_one_time(path, whole, times, as_text=True))
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


def _is_stamped(path: Path, head: Head, times: list[str]) -> bool:
    """Return whether the times of a log are no numbers, by its first row.

    Raises
    ------
    InputError : if they are no times either.
    """
    if not head.first:
        return False
    row = dict(zip(head.names, head.first, strict=False))
    first = pa.RecordBatch.from_pydict({name: [row.get(name, "").strip()] for name in times})
    cell = with_one_time(path, first, times, as_text=True).column(times[0])
    if is_number(cell[0].as_py().replace(",", ".")):
        return False
    stamps(path, cell)
    return True


def _batches(
    path: Path, head: Head, types: dict[str, pa.DataType], rows: int, torn: _TornRow
) -> Iterator[pa.RecordBatch]:
    """Yield the columns of `types` as these, about `rows` rows at a time."""
    # pyarrow would lose the whole block in which a packed file was cut.
    if head.delimiter == BLANK:
        file = with_single_blanks(open_text(path))
    else:
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
                null_values=[*MISSING, *_ALSO_MISSING],
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

    def __init__(self, path: Path, head: Head) -> None:
        self._path, self._head, self.fault = path, head, ""
        self.rows: list[int] = []

    def check(self) -> None:
        """Raise a RowsLeftOut that tells of the first row that was left out and of their number, if any was."""
        if self.fault:
            others = len(self.rows) - 1
            more = f" and {count(others, 'more row')} of a wrong length were" if others else " was"
            raise RowsLeftOut(f"{self.fault}; it{more} left out")

    def __call__(self, row: arrow_csv.InvalidRow) -> str:
        """Return what pyarrow is to do with a row; an error raised here would be lost."""
        if row.actual_columns < row.expected_columns and row.text == _unfinished(self._path, self._head):
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
        head = head_of(path, layout)
        row = _unfinished(path, head)
    except (InputError, OSError):
        return False
    if row is None or not row.strip():
        return False
    return len(next(csv.reader([row], delimiter=head.delimiter, strict=False), [])) < len(head.names)


def _unfinished(path: Path, head: Head) -> str | None:
    """Return the last line of a log where no line end follows it, None where one does.

    A file in which no line ends, or whose last row is longer than what is looked at, shows no row.
    """
    encoding = "utf-8" if head.encoding == "utf8" else head.encoding
    _, ended, row = _last_bytes(path).decode(encoding, errors="replace").rpartition("\n")
    return (single(row) if head.delimiter == BLANK else row) if ended and row else None


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
