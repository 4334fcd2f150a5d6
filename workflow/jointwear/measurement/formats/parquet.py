"""Parquet logs, one column an axis."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
from pyarrow import parquet

from jointwear.files.errors import TRUNCATED, InputError
from jointwear.measurement.formats.arrow import chunk_of
from jointwear.measurement.formats.chunk import Chunk, find_columns
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.local_stamps import LocalStamps


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a Parquet file; see :func:`jointwear.measurement.formats.read_log`.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    """
    try:
        with parquet.ParquetFile(path, pre_buffer=False, buffer_size=1 << 20) as file:
            columns = find_columns(path, file.schema_arrow.names, layout)
            wanted = list(dict.fromkeys(c for group in columns.values() for c in group))
            stamped = LocalStamps(layout.time_zone)
            for batch in file.iter_batches(batch_size=rows, columns=wanted, use_threads=False):
                yield chunk_of(path, batch, columns, layout, stamped)
    except (pa.ArrowException, OSError) as error:
        first = next(iter(str(error).splitlines()), "unknown reason")
        raise InputError(f"{path}: {TRUNCATED} Parquet file ({first})") from None
