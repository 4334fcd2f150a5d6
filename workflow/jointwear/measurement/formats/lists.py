"""Columns of a Parquet log that hold the values of all joints as a list in each row."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pyarrow as pa
from pyarrow import compute, parquet

from jointwear.files.errors import InputError
from jointwear.files.wording import count
from jointwear.measurement.formats.chunk import JOINT_ROLES, NEEDED
from jointwear.measurement.formats.layout import Layout


def lists_of(file: parquet.ParquetFile, layout: Layout) -> dict[str, int]:
    """Return the columns of lists that are read for a joint role, each with how many values its first list has, 0
    where no row holds one.

    Of roles that nobody asks for they are those as wide as the positions.
    """
    names = {name: role for role in JOINT_ROLES if isinstance(name := layout.names[role], str)}
    found = {f.name: _width(file, f) for f in file.schema_arrow if f.name in names and _is_list(f.type)}
    wide = found.get(str(layout.names["position"]))
    asked = {*NEEDED, *layout.given}
    return {name: width for name, width in found.items() if names[name] in asked or width == wide}


def columns_beside_lists(names: list[str], lists: Mapping[str, int]) -> list[tuple[str, str]]:
    """Return names, each with its column of the file: those of `names` themselves, and `name_1`, `name_2` ... of one
    that holds lists."""
    found = [(name, name) for name in names if name not in lists]
    return found + [(one, name) for name, width in lists.items() for one in _names(name, width)]


def without_lists(path: Path, batch: pa.RecordBatch, lists: Mapping[str, int], row: int) -> pa.RecordBatch:
    """Return a batch with a column for each value of its lists.

    Parameters
    ----------
    row : how many rows of the file come before it.

    Raises
    ------
    InputError : naming the first row in which a list has another length than the first one.
    """
    columns = {name: batch.column(name) for name in batch.schema.names if name not in lists}
    for name in lists.keys() & set(batch.schema.names):
        values, width = batch.column(name), lists[name]
        lengths = compute.list_value_length(values)
        odd = compute.indices_nonzero(compute.fill_null(compute.not_equal(lengths, width), False))
        if len(odd):
            place = odd[0].as_py()
            raise InputError(
                f"{path}: row {row + place + 1} of the column '{name}' holds {count(lengths[place].as_py(), 'value')}, "
                f"the first one {width}"
            )
        columns |= {one: compute.list_element(values, k) for k, one in enumerate(_names(name, width))}
    return pa.RecordBatch.from_pydict(columns)


def _names(name: str, width: int) -> list[str]:
    """Return the names of the columns that a column of lists stands for."""
    return [f"{name}_{k + 1}" for k in range(width)]


def _width(file: parquet.ParquetFile, column: pa.Field) -> int:
    """Return how many values the first list of a column has, 0 where there is none."""
    if pa.types.is_fixed_size_list(column.type):
        return column.type.list_size
    for batch in file.iter_batches(batch_size=1000, columns=[column.name], use_threads=False):
        lengths = compute.drop_null(compute.list_value_length(batch.column(0)))
        if len(lengths):
            return lengths[0].as_py()
    return 0


def _is_list(kind: pa.DataType) -> bool:
    return pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind)
