"""What the readers of CSV and Parquet share: columns of Arrow tables as arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa

from jointwear.files.errors import InputError
from jointwear.measurement.formats.chunk import Chunk, Layout, make_chunk


def chunk_of(path: Path, batch: pa.RecordBatch | pa.Table, columns: dict[str, list[str]], layout: Layout) -> Chunk:
    """Return one record batch as a chunk; `columns` role -> names of its columns."""
    values, dated = {}, False
    for role, names in columns.items():
        arrays = []
        for name in names:
            column = batch.column(name)
            if role == "time" and pa.types.is_timestamp(column.type):
                arrays.append(_seconds(column))
                dated = True
            else:
                arrays.append(_numbers(path, name, column))
        values[role] = arrays[0] if role in ("time", "trajectory") or len(arrays) == 1 else np.stack(arrays, axis=1)
        if role not in ("time", "trajectory", "temperature") and len(arrays) == 1:
            values[role] = arrays[0][:, None]
    return make_chunk(path, values, layout, {}, dated)


def _seconds(column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    """Return time stamps as seconds since 1970 UTC; a stamp without a zone counts as UTC."""
    per_second = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}[column.type.unit]
    whole = column.cast(pa.int64())
    ticks = whole.fill_null(0).to_numpy(zero_copy_only=False) if isinstance(whole, pa.Array) else None
    if ticks is None:
        ticks = whole.fill_null(0).to_numpy()
    seconds = ticks // per_second + (ticks % per_second) / per_second
    if column.null_count:
        seconds = np.where(np.asarray(column.is_null()), np.nan, seconds)
    return seconds


def holds_numbers(kind: pa.DataType) -> bool:
    """Whether a column of this type can be read as floats."""
    return pa.types.is_decimal(kind) or pa.types.is_integer(kind) or pa.types.is_floating(kind)


def _numbers(path: Path, name: str, column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    kind = column.type
    if holds_numbers(kind):
        column = column.cast(pa.float64())
    elif pa.types.is_null(kind):
        return np.full(len(column), np.nan)
    else:
        raise InputError(f"{path}: column '{name}' holds {kind}, not numbers")
    return np.asarray(column.to_numpy(zero_copy_only=False) if isinstance(column, pa.Array) else column.to_numpy())
