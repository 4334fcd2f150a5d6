"""Parquet logs, one column an axis."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
from pyarrow import parquet

from jointwear.files.errors import TRUNCATED, InputError
from jointwear.measurement.formats.arrow import chunk_of
from jointwear.measurement.formats.chunk import JOINT_ROLES, NEEDED, Chunk, find_columns, numbered_columns
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.local_stamps import LocalStamps
from jointwear.measurement.formats.named_units import units_in_names


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a Parquet file; see :func:`jointwear.measurement.formats.read_log`.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    """
    try:
        with parquet.ParquetFile(path, pre_buffer=False, buffer_size=1 << 20) as file:
            _check_plain(path, file.schema_arrow, layout)
            columns = find_columns(path, file.schema_arrow.names, layout)
            wanted = list(dict.fromkeys(c for group in columns.values() for c in group))
            stamped, units = LocalStamps(layout.time_zone), units_in_names(columns)
            for batch in file.iter_batches(batch_size=rows, columns=wanted, use_threads=False):
                yield chunk_of(path, batch, columns, layout, stamped, units)
    except (pa.ArrowException, OSError) as error:
        first = next(iter(str(error).splitlines()), "unknown reason")
        raise InputError(f"{path}: {TRUNCATED} Parquet file ({first})") from None


def _check_plain(path: Path, schema: pa.Schema, layout: Layout) -> None:
    """Check that no role that is wanted is a column of lists.

    Raises
    ------
    InputError : with how to write it.
    """
    for role in [role for role in JOINT_ROLES if role in NEEDED or role in layout.given]:
        given = layout.names[role]
        for name in [given] if isinstance(given, str) else given:
            if name not in schema.names or numbered_columns(schema.names, name):
                continue
            kind = schema.field(name).type
            if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
                raise InputError(
                    f"{path}: the column '{name}' holds lists, which are not read: write one column for each joint, "
                    f"'{name}_1', '{name}_2' ..., as pandas does by table['{name}'].apply(pandas.Series)"
                )
