"""Cells of a CSV log that hold something else than a number or a time: left out where nearly all others are sound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
from pyarrow import compute

from jointwear.files.errors import InputError, shown
from jointwear.files.wording import count
from jointwear.measurement.formats.arrow import first_of_other_zone, is_stamp, mixed_zones, stamps

#: Share of the rows of a log, read so far, that may hold such a cell.
MOST = 0.1
#: Numbers as the CSV reader takes them.
_NUMBER = r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$|^[-+]?(?i:nan|inf|infinity)$"
#: What to do where trajectories have names.
_NUMBERED = (
    "; labels of trajectories are whole numbers: count every run of samples apart, as 0, 1, 2, and keep names in a "
    "column of their own"
)


@dataclass
class Cells:
    """Reads batches of text of one log at `path` as numbers; `decimal` sign, `time`: its column, `stamped` where it
    holds times of day, `text`: columns of text, `names`: of all columns in their order. `rows` read so far, `line` of
    the file before the first of them, `left_out`: rows of the file that the batches lack, in order, `label`: the column
    of the labels of trajectories."""

    path: Path
    decimal: str
    time: str
    stamped: bool
    text: tuple[str, ...]
    names: tuple[str, ...]
    rows: int
    line: int
    left_out: Sequence[int] = ()
    label: str = ""
    unread: int = 0

    def up_to_another_header(self, batch: pa.RecordBatch) -> tuple[pa.RecordBatch, str]:
        """Return a batch up to a header that names its columns in another order, and in words which that is, empty
        where none does: a logger that was restarted appends one."""
        for index in _places(self._headers(batch)):
            row = {name: str(batch.column(name)[index]).strip() for name in batch.schema.names}
            other = next(((name, cell) for name, cell in row.items() if name != cell), None)
            if other is not None:
                return batch.slice(0, index), (
                    f"{self.path}: row {self._row(self.rows + index)} names the columns anew, in another order: "
                    f"'{other[1]}' where '{other[0]}' was. What comes before it was read; write what follows into a "
                    "log of its own"
                )
        return batch, ""

    def _headers(self, batch: pa.RecordBatch) -> pa.Array:
        """Return which rows hold names of columns alone, as the header does."""
        known, found = pa.array(self.names), None
        for name in batch.schema.names:
            named = compute.is_in(compute.utf8_trim_whitespace(batch.column(name)), known)
            found = named if found is None else compute.and_(found, named)
        return found

    def numbers(self, batch: pa.RecordBatch) -> tuple[pa.Table, tuple[int, str]]:
        """Return a batch with null in place of what is no number, rows whose time is none left out, and how many rows
        were concerned with the first of them in words.

        Raises
        ------
        InputError : naming row and column where more than :data:`MOST` of the rows so far are.
        """
        # The header once more says nothing.
        header = self._headers(batch)
        columns, wrong = {}, {}
        for name in batch.schema.names:
            given = batch.column(name)
            if name in self.text:
                columns[name] = given
                continue
            sound = self._sound(name, given)
            wrong[name] = compute.and_not(compute.and_not(compute.is_valid(given), sound), header)
            kept = compute.if_else(sound, self._plain(name, given), pa.scalar(None, pa.string()))
            columns[name] = kept if self._is_time(name) else kept.cast(pa.float64())
        begin, self.rows = self.rows, self.rows + batch.num_rows
        concerned = [index for mask in wrong.values() for index in _places(mask)]
        if not concerned:
            return pa.table(columns).filter(compute.invert(header)), (0, "")
        first = min(concerned)
        column = next(name for name, mask in wrong.items() if mask[first].as_py())
        self.unread += len(set(concerned))
        cell = batch.column(column)[first].as_py()
        told = f"row {self._row(begin + first)} has {shown(cell)} in column '{column}'{of_open_quote(cell)}"
        if self.unread > MOST * self.rows:
            kind = "a time" if self._is_time(column) else "a number"
            raise InputError(
                f"{self.path}: cannot be read as CSV ({told}, which is not {kind}; so have {self.unread} of {self.rows}"
                f" rows){_NUMBERED if column == self.label else ''}"
            )
        table = pa.table(columns)
        return table.filter(compute.invert(compute.or_(wrong[self.time], header))), (len(set(concerned)), told)

    def _row(self, index: int) -> int:
        """Return the row of the file, from 1, of the row `index` of all batches."""
        row = self.line + index + 1
        for gone in self.left_out:
            row += gone <= row
        return row

    def _is_time(self, name: str) -> bool:
        return self.stamped and name == self.time

    def _plain(self, name: str, given: pa.Array) -> pa.Array:
        trimmed = compute.utf8_trim_whitespace(given)
        if self._is_time(name) or self.decimal == ".":
            return trimmed
        return compute.replace_substring(trimmed, self.decimal, ".")

    def _sound(self, name: str, given: pa.Array) -> pa.Array:
        """Return which cells are read, false for those that are missing."""
        if self._is_time(name):
            try:
                stamps(self.path, given)
                return compute.is_valid(given)
            except InputError:
                sound = pa.array([text is not None and is_stamp(text) for text in given.to_pylist()])
            known = compute.if_else(sound, given, pa.scalar(None, pa.string()))
            odd = first_of_other_zone(known)
            if odd is not None:
                words = mixed_zones(known, odd, self._row(self.rows + odd))
                raise InputError(f"{self.path}: {words}")
            return sound
        sound = compute.match_substring_regex(self._plain(name, given), _NUMBER)
        if self.decimal != ".":
            sound = compute.and_(sound, compute.invert(compute.match_substring(given, ".")))
        return compute.fill_null(sound, False)


def of_open_quote(text: str) -> str:
    """Return in words that a quotation mark takes lines with it that follow, where a row or a cell holds line ends;
    else nothing."""
    more = text.count("\n")
    return (
        f" (a quotation mark that is not closed in its line takes {count(more, 'more line')} with it)" if more else ""
    )


def _places(mask: pa.Array) -> list[int]:
    """Return where a mask is true."""
    return compute.indices_nonzero(compute.fill_null(mask, False)).to_pylist()
