"""Parquet logs, one column an axis, or a list of all axes in each row."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
from pyarrow import parquet

from jointwear.files.errors import TRUNCATED, InputError
from jointwear.measurement.formats.arrow import chunk_of
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.formats.columns import find_columns
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.lists import columns_beside_lists, lists_of, without_lists
from jointwear.measurement.formats.local_stamps import LocalStamps
from jointwear.measurement.formats.named_units import units_in_names
from jointwear.measurement.formats.two_times import with_one_time


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a Parquet file; see :func:`jointwear.measurement.formats.read_log`.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    """
    try:
        with parquet.ParquetFile(path, pre_buffer=False, buffer_size=1 << 20) as file:
            lists = lists_of(file, layout)
            there = columns_beside_lists(file.schema_arrow.names, lists)
            columns, column_of = find_columns(path, [name for name, _ in there], layout), dict(there)
            wanted = list(dict.fromkeys(column_of[c] for group in columns.values() for c in group))
            stamped, units, done = LocalStamps(layout.time_zone), units_in_names(columns), 0
            times = columns["time"]
            columns = {**columns, "time": times[:1]}
            for batch in file.iter_batches(batch_size=rows, columns=wanted, use_threads=False):
                plain = with_one_time(path, without_lists(path, batch, lists, done), times)
                yield chunk_of(path, plain, columns, layout, stamped, units)
                done += batch.num_rows
    except (pa.ArrowException, OSError) as error:
        first = next(iter(str(error).splitlines()), "unknown reason")
        raise InputError(f"{path}: {TRUNCATED} Parquet file ({first})") from None
