"""What the readers of CSV and Parquet share: columns of Arrow tables as arrays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import compute

from jointwear.files.errors import InputError
from jointwear.measurement.formats.chunk import Chunk, make_chunk
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.programs import joined_labels, label_of


def chunk_of(
    path: Path,
    batch: pa.RecordBatch | pa.Table,
    columns: dict[str, list[str]],
    layout: Layout,
    units: dict[str, str] | None = None,
) -> Chunk:
    """Return one record batch as a chunk; `columns` role -> names of its columns, `units` role -> unit in the log."""
    values, dated = {}, False
    for role, names in columns.items():
        if role == "program":
            values[role] = joined_labels(path, [_labels(batch.column(name)) for name in names])
            continue
        arrays = []
        for name in names:
            column = batch.column(name)
            if role == "time" and pa.types.is_string(column.type):
                column = stamps(path, column)
            if role == "time" and pa.types.is_timestamp(column.type):
                arrays.append(_seconds(column, layout.time_zone))
                dated = True
            else:
                arrays.append(_numbers(path, name, column))
        values[role] = arrays[0] if role in ("time", "trajectory") or len(arrays) == 1 else np.stack(arrays, axis=1)
        if role not in ("time", "trajectory", "temperature") and len(arrays) == 1:
            values[role] = arrays[0][:, None]
    return make_chunk(path, values, layout, units or {}, dated)


def stamps(path: Path, column: pa.Array | pa.ChunkedArray) -> pa.Array | pa.ChunkedArray:
    """Return times written as text as time stamps: ISO 8601, with a comma before the fraction, or dd.mm.yyyy.

    Raises
    ------
    InputError : showing the first text that is none of these.
    """
    try:
        # What is ISO 8601 already needs no mending, which takes several times as long as the reading.
        return column.cast(pa.timestamp("ns", tz="UTC"))
    except pa.ArrowException:
        text = compute.utf8_trim_whitespace(column)
    text = compute.replace_substring_regex(text, r"^(\d{1,2})\.(\d{1,2})\.(\d{4})", r"\3-\2-\1")
    text = compute.replace_substring_regex(text, r"^(\d{4})-(\d)-", r"\1-0\2-")
    text = compute.replace_substring_regex(text, r"^(\d{4}-\d\d)-(\d)([ T])", r"\1-0\2\3")
    text = compute.replace_substring(text, ",", ".")
    zoned = compute.match_substring_regex(text, r"(Z|z|[+-]\d\d:?\d\d)$")
    kind = pa.timestamp("ns", tz="UTC") if compute.any(zoned).as_py() else pa.timestamp("ns")
    try:
        return text.cast(kind)
    except pa.ArrowException:
        for value in text.to_pylist():
            try:
                pa.scalar(value).cast(kind)
            except pa.ArrowException:
                raise InputError(
                    f"{path}: the time '{str(value)[:40]}' is no number, nor ISO 8601 (2026-01-15T00:00:00Z), nor "
                    "dd.mm.yyyy hh:mm:ss"
                ) from None
        raise InputError(f"{path}: the times cannot be read") from None


def _seconds(column: pa.Array | pa.ChunkedArray, zone: str | None = None) -> np.ndarray:
    """Return time stamps as seconds since 1970 UTC; a stamp without a zone counts as of `zone`, default UTC."""
    if zone is not None and column.type.tz is None:
        column = compute.assume_timezone(column, zone, ambiguous="earliest", nonexistent="latest")
    per_second = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}[column.type.unit]
    whole = column.cast(pa.int64())
    ticks = whole.fill_null(0).to_numpy(zero_copy_only=False) if isinstance(whole, pa.Array) else None
    if ticks is None:
        ticks = whole.fill_null(0).to_numpy()
    seconds = ticks // per_second + (ticks % per_second) / per_second
    if column.null_count:
        seconds = np.where(np.asarray(column.is_null()), np.nan, seconds)
    return seconds


def _labels(column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    """Return the label of every row of a column."""
    whole = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    coded = whole.dictionary_encode() if not pa.types.is_dictionary(whole.type) else whole
    names = np.array([*(label_of(v) for v in coded.dictionary.to_pylist()), ""])
    return names[coded.indices.fill_null(len(names) - 1).to_numpy(zero_copy_only=False)]


def holds_numbers(kind: pa.DataType) -> bool:
    """Whether a column of this type can be read as floats."""
    return pa.types.is_decimal(kind) or pa.types.is_integer(kind) or pa.types.is_floating(kind)


def _numbers(path: Path, name: str, column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    kind = column.type
    if holds_numbers(kind):
        # Nanoseconds since 1970 have more digits than a float holds; what is lost is a fraction of a microsecond.
        column = column.cast(pa.float64(), safe=False)
    elif pa.types.is_null(kind):
        return np.full(len(column), np.nan)
    else:
        raise InputError(f"{path}: column '{name}' holds {kind}, not numbers")
    return np.asarray(column.to_numpy(zero_copy_only=False) if isinstance(column, pa.Array) else column.to_numpy())
