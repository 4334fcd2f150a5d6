"""Logs in any supported format as a stream of :class:`Chunk`: a log may be larger than memory.

One module a format; each has ``read(path, layout, rows)``. Names, units and the order of the axes come from the
config (:class:`Layout`). Nothing in a log is ever evaluated.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from jointwear.files.errors import NO_SAMPLES, InputError
from jointwear.files.regular_files import check_regular
from jointwear.files.wording import count as counted
from jointwear.measurement.formats.bursts import without_bursts
from jointwear.measurement.formats.chunk import Chunk, RowsLeftOut, rows_of
from jointwear.measurement.formats.first_bytes import ENOUGH, check_kind
from jointwear.measurement.formats.layout import Layout, layout_of
from jointwear.measurement.formats.rows_apart import in_one_row
from jointwear.measurement.formats.two_sources import check_one_source
from jointwear.measurement.log_kinds import ALLOWED, log_format, no_kind_of_log
from jointwear.measurement.possible import check_clock

#: First samples of a log by which its clock is judged.
CLOCK_LOOK = 1000


def read_log(path: str | Path, layout: Layout, rows: int = 100_000) -> Iterator[Chunk]:
    """Yield the samples of one log in its order, at most about `rows` at a time, without bursts in their times, and
    with positions and torques in one row.

    Raises
    ------
    InputError : one line naming the file, what is wrong, and what there is; so where the rows of two robots are in it.
    RowsLeftOut : after the last sample, if rows were left out, of a wrong length or of times that do not exist.
    """
    kind = log_format(path)
    if kind is None:
        raise InputError(f"{path}: {no_kind_of_log(path)} (allowed: {ALLOWED})")
    if not Path(path).is_dir():
        check_regular(path)
    if kind in ("netcdf", "parquet"):
        check_kind(Path(path), kind, _begin(Path(path)))
    if kind == "netcdf":
        from jointwear.measurement.formats.netcdf import read
    elif kind == "csv":
        from jointwear.measurement.formats.text import read
    elif kind == "parquet":
        from jointwear.measurement.formats.parquet import read
    else:
        from jointwear.measurement.formats.bag import read
    empty = True
    for chunk in _existing(path, read(Path(path), layout, rows)):
        if len(chunk.time):
            if empty:
                check_clock(path, chunk.time[:CLOCK_LOOK], chunk.units.get("time", "s"))
            empty = False
            whole = in_one_row(chunk)
            check_one_source(path, whole)
            yield without_bursts(whole)
    if empty:
        raise InputError(f"{path}: {NO_SAMPLES}")


def ends_within_a_row(path: str | Path, layout: Layout) -> bool:
    """Return whether a log was cut off within its last row, as while it is written; only texts show it."""
    from jointwear.measurement.formats.text import ends_within_a_row

    return log_format(path) == "csv" and Path(path).is_file() and ends_within_a_row(Path(path), layout)


def _existing(path: str | Path, chunks: Iterator[Chunk]) -> Iterator[Chunk]:
    """Yield chunks without rows of times that do not exist where the log was written.

    Raises
    ------
    RowsLeftOut : after the last one, if rows were left out here or by the reader.
    """
    told, left_out, words = "", 0, ""
    try:
        for chunk in chunks:
            count, why = chunk.none_such
            left_out, words = left_out + count, words or why
            yield rows_of(chunk, np.isfinite(chunk.time)) if count else chunk
    except RowsLeftOut as error:
        told = str(error)
    if left_out:
        told = f"{told}; " if told else f"{path}: "
        told += f"{counted(left_out, 'row')} left out: {words}"
    if told:
        raise RowsLeftOut(told)


def _begin(path: Path) -> bytes:
    """Return the first bytes of a file; of one that cannot be read none, as its reader tells why."""
    try:
        with path.open("rb") as file:
            return file.read(ENOUGH)
    except OSError:
        return b""


__all__ = ["Chunk", "Layout", "ends_within_a_row", "layout_of", "read_log"]
