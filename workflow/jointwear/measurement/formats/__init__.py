"""Logs in any supported format as a stream of :class:`Chunk`: a log may be larger than memory.

One module a format; each has ``read(path, layout, rows)``. Names, units and the order of the axes come from the
config (:class:`Layout`). Nothing in a log is ever evaluated.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from jointwear.files.errors import NO_SAMPLES, InputError
from jointwear.files.regular_files import check_regular
from jointwear.measurement.formats.bursts import without_bursts
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.formats.first_bytes import ENOUGH, check_kind
from jointwear.measurement.formats.layout import Layout, layout_of
from jointwear.measurement.formats.rows_apart import in_one_row
from jointwear.measurement.log_kinds import FORMATS, log_format
from jointwear.measurement.possible import check_clock

#: First samples of a log by which its clock is judged.
CLOCK_LOOK = 1000


def read_log(path: str | Path, layout: Layout, rows: int = 100_000) -> Iterator[Chunk]:
    """Yield the samples of one log in its order, at most about `rows` at a time, without bursts in their times, and
    with positions and torques in one row.

    Raises
    ------
    InputError : one line naming the file, what is wrong, and what there is.
    """
    kind = log_format(path)
    if kind is None:
        raise InputError(f"{path}: no kind of log (allowed: {', '.join(FORMATS)}, or a bag's folder)")
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
    for chunk in read(Path(path), layout, rows):
        if len(chunk.time):
            if empty:
                check_clock(path, chunk.time[:CLOCK_LOOK], chunk.units.get("time", "s"))
            empty = False
            yield without_bursts(in_one_row(chunk))
    if empty:
        raise InputError(f"{path}: {NO_SAMPLES}")


def _begin(path: Path) -> bytes:
    """Return the first bytes of a file; of one that cannot be read none, as its reader tells why."""
    try:
        with path.open("rb") as file:
            return file.read(ENOUGH)
    except OSError:
        return b""


__all__ = ["Chunk", "Layout", "layout_of", "read_log"]
