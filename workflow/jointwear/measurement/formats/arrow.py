"""What the readers of CSV and Parquet share: columns of Arrow tables as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import compute

from jointwear.files.errors import InputError
from jointwear.measurement.formats.chunk import Chunk, make_chunk
from jointwear.measurement.formats.layout import Layout
from jointwear.measurement.formats.local_stamps import LocalStamps
from jointwear.measurement.formats.programs import joined_labels, label_of
from jointwear.measurement.timestamps import to_write
from jointwear.measurement.units import spelled


def chunk_of(
    path: Path,
    batch: pa.RecordBatch | pa.Table,
    columns: dict[str, list[str]],
    layout: Layout,
    stamped: LocalStamps,
    units: Mapping[str, str | list[str]] | None = None,
) -> Chunk:
    """Return one record batch as a chunk; `columns` role -> names of its columns, `units` role -> unit in the log, or
    one for each column;
    `stamped`, of the log, has seen all batches before."""
    values, dated, none_such = {}, False, (0, "")
    for role, names in columns.items():
        if role == "program":
            values[role] = joined_labels(path, [_labels(batch.column(name)) for name in names])
            continue
        arrays = []
        for name in names:
            column = batch.column(name)
            if role == "time" and holds_text(column.type):
                column = stamps(path, column.cast(pa.string()))
            if role == "time" and pa.types.is_timestamp(column.type):
                arrays.append(stamped.seconds(column))
                dated, none_such = True, stamped.none_such
            else:
                arrays.append(_numbers(path, name, column))
        values[role] = arrays[0] if role in ("time", "trajectory") or len(arrays) == 1 else np.stack(arrays, axis=1)
        if role not in ("time", "trajectory", "temperature") and len(arrays) == 1:
            values[role] = arrays[0][:, None]
    said = layout.units.get("time") or (units or {}).get("time") or ""
    if not dated and spelled("time", str(said)) == "d":
        moments = stamped.of_serial_days(np.asarray(values["time"], dtype=float))
        if moments is not None:
            values["time"], dated, none_such = moments, True, stamped.none_such
    return replace(make_chunk(path, values, layout, units or {}, dated), none_such=none_such)


def stamps(path: Path, column: pa.Array | pa.ChunkedArray) -> pa.Array | pa.ChunkedArray:
    """Return times written as text as time stamps: ISO 8601, with slashes or a comma before the fraction too, or
    dd.mm.yyyy.

    Raises
    ------
    InputError : showing the first text that is none of these, or two of which only one names a zone.
    """
    try:
        # What is ISO 8601 already needs no mending, which takes several times as long as the reading.
        return column.cast(pa.timestamp("ns", tz="UTC"))
    except pa.ArrowException:
        text = _mended(column)
    zoned = compute.match_substring_regex(text, _ZONE)
    kind = pa.timestamp("ns", tz="UTC") if compute.any(zoned).as_py() else pa.timestamp("ns")
    try:
        return text.cast(kind)
    except pa.ArrowException:
        for given, value in zip(column.to_pylist(), text.to_pylist(), strict=True):
            if value is not None and not is_stamp(value):
                raise InputError(
                    f"{path}: the time '{str(given)[:40]}' is no number, nor ISO 8601 (2026-01-15T00:00:00Z), nor "
                    f"dd.mm.yyyy hh:mm:ss{to_write(str(given)[:40])}"
                ) from None
    odd = first_of_other_zone(column)
    raise InputError(f"{path}: {mixed_zones(column, odd) if odd is not None else 'the times cannot be read'}")


def first_of_other_zone(column: pa.Array | pa.ChunkedArray) -> int | None:
    """Return where the first time stands that names a zone unlike the first one, or the other way round; None where
    there is none."""
    zoned = compute.match_substring_regex(_mended(column), _ZONE).to_pylist()
    first = next((z for z in zoned if z is not None), None)
    return next((k for k, z in enumerate(zoned) if z is not None and z != first), None)


def mixed_zones(column: pa.Array | pa.ChunkedArray, odd: int, row: int | None = None) -> str:
    """Return in words that some times name a zone and some do not; `odd` as of :func:`first_of_other_zone`, in the row
    `row` of the file where that is known."""
    texts = column.to_pylist()
    first = next(text for text in texts if text is not None)
    zoned = compute.match_substring_regex(_mended(pa.array([first])), _ZONE)[0].as_py()
    place, has = "" if row is None else f" of row {row}", ("no time zone", "one") if zoned else ("a time zone", "none")
    return (
        f"times with a zone and without are mixed: '{texts[odd][:40]}'{place} names {has[0]}, '{first[:40]}' {has[1]}; "
        "write all of them one way"
    )


#: The zone at the end of a time.
_ZONE = r"(Z|z|[+-]\d\d:?\d\d)$"


def _mended(column: pa.Array | pa.ChunkedArray) -> pa.Array | pa.ChunkedArray:
    """Return times as ISO 8601 has them: the year first, two digits each, a point before the fraction."""
    text = compute.utf8_trim_whitespace(column)
    text = compute.replace_substring_regex(text, r"^(\d{1,2})\.(\d{1,2})\.(\d{4})", r"\3-\2-\1")
    text = compute.replace_substring_regex(text, r"^(\d{4})/(\d{1,2})/(\d{1,2})", r"\1-\2-\3")
    text = compute.replace_substring_regex(text, r"^(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)", r"\1-\2-\3T\4:\5:\6")
    text = compute.replace_substring_regex(text, r"^(\d{4})-(\d)-", r"\1-0\2-")
    text = compute.replace_substring_regex(text, r"^(\d{4}-\d\d)-(\d)([ T])", r"\1-0\2\3")
    text = compute.replace_substring_regex(text, r"^(\d{4}-\d\d-\d\d[ T])(\d:)", r"\10\2")
    return compute.replace_substring(text, ",", ".")


def is_stamp(text: str) -> bool:
    """Return whether a text is a time of :func:`stamps`, with a zone or without."""
    mended = _mended(pa.array([text]))
    zoned = compute.match_substring_regex(mended, _ZONE)[0].as_py()
    try:
        mended.cast(pa.timestamp("ns", tz="UTC") if zoned else pa.timestamp("ns"))
    except pa.ArrowException:
        return False
    return True


def _labels(column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    """Return the label of every row of a column."""
    whole = column.combine_chunks() if isinstance(column, pa.ChunkedArray) else column
    coded = whole.dictionary_encode() if not pa.types.is_dictionary(whole.type) else whole
    names = np.array([*(label_of(v) for v in coded.dictionary.to_pylist()), ""])
    return names[coded.indices.fill_null(len(names) - 1).to_numpy(zero_copy_only=False)]


def holds_text(kind: pa.DataType) -> bool:
    """Whether a column of this type holds texts; writers differ in which of the types they take for them."""
    inner = kind.value_type if pa.types.is_dictionary(kind) else kind
    return pa.types.is_string(inner) or pa.types.is_large_string(inner) or pa.types.is_string_view(inner)


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
