"""CSV logs: a header line, one column an axis; separated by commas, semicolons or tabs."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
from pyarrow import csv as arrow_csv

from jointwear.files.errors import InputError
from jointwear.measurement.formats.arrow import chunk_of
from jointwear.measurement.formats.chunk import Chunk, Layout, check_count, find_columns
from jointwear.measurement.timestamps import utc_seconds

_MISSING = ["", "nan", "NaN", "NAN", "null", "NULL", "NA", "N/A", "-nan", "None"]
_BYTES_A_NUMBER = 18


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a CSV file; see :func:`jointwear.measurement.formats.read_log`."""
    header, first, delimiter = _head(path)
    columns = find_columns(path, header, layout)
    wanted = list(dict.fromkeys(c for group in columns.values() for c in group))
    types: dict[str, pa.DataType] = {name: pa.float64() for name in wanted}
    decimal = "," if delimiter == ";" and any("," in cell for cell in first) else "."
    if first:
        place = header.index(columns["time"][0])
        cell = first[place].strip() if place < len(first) else ""
        if not _is_number(cell.replace(",", ".")):
            types[columns["time"][0]] = _kind_of_stamp(path, cell)
    try:
        with arrow_csv.open_csv(
            path,
            read_options=arrow_csv.ReadOptions(
                use_threads=False,
                block_size=max(1 << 16, rows * _BYTES_A_NUMBER * len(header)),
                column_names=header,
                skip_rows=1,
            ),
            parse_options=arrow_csv.ParseOptions(delimiter=delimiter),
            convert_options=arrow_csv.ConvertOptions(
                column_types=types,
                include_columns=wanted,
                null_values=_MISSING,
                decimal_point=decimal,
                timestamp_parsers=[arrow_csv.ISO8601],
            ),
        ) as reader:
            for batch in reader:
                yield chunk_of(path, batch, columns, layout)
    except (pa.ArrowException, OSError) as error:
        first_line = next(iter(str(error).splitlines()), "unknown reason").rstrip(".")
        if "Empty CSV" in first_line:
            raise InputError(f"{path}: holds no samples") from None
        raise InputError(f"{path}: cannot be read as CSV ({first_line})") from None


def _head(path: Path) -> tuple[list[str], list[str], str]:
    """Return the names of the columns, the cells of the first row (may be empty), and the delimiter."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = [file.readline(1 << 20), file.readline(1 << 20)]
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file in UTF-8") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if not lines[0].strip():
        raise InputError(f"{path}: is empty")
    delimiter = max(",;\t", key=lines[0].count)
    try:
        rows = [next(csv.reader([line], delimiter=delimiter), []) for line in lines]
    except csv.Error as error:
        raise InputError(f"{path}: cannot be read as CSV ({error})") from None
    header = [name.strip() for name in rows[0]]
    check_count(path, len(header))
    seen: set[str] = set()
    twice = next((name for name in header if name in seen or seen.add(name)), None)
    if twice is not None:
        raise InputError(f"{path}: the header names the column '{twice}' twice")
    if all(_is_number(name) for name in header):
        raise InputError(f"{path}: the first line holds numbers; a header line with the names of the columns is needed")
    return header, rows[1], delimiter


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _kind_of_stamp(path: Path, text: str) -> pa.DataType:
    try:
        utc_seconds(text)
    except ValueError:
        raise InputError(
            f"{path}: the time '{text[:40]}' is neither a number nor ISO 8601, as 2026-01-15T00:00:00Z"
        ) from None
    zone = text.endswith(("Z", "z")) or "+" in text[10:] or "-" in text[10:]
    return pa.timestamp("ns", tz="UTC") if zone else pa.timestamp("ns")
