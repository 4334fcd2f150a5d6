"""A time that a table tells in two columns: the date and the time of day, or whole seconds and nanoseconds."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa
from pyarrow import compute

from jointwear.files.errors import InputError

#: A whole number, and one below a thousand million: nanoseconds behind a second.
_WHOLE, _NANOSECONDS = r"^\s*-?[0-9]+\s*$", r"^\s*[0-9]{1,9}\s*$"


def with_one_time(path: Path, batch: pa.RecordBatch, time: list[str], as_text: bool = False) -> pa.RecordBatch:
    """Return a batch of a table in which the columns of the time are the first of them alone.

    That holds a date and a time of day with a blank between, as text, or seconds.

    Parameters
    ----------
    time : one name, which changes nothing, or two. as_text : whether seconds are text too.

    Raises
    ------
    InputError : if numbers of the second column are no nanoseconds.
    """
    if len(time) < 2:
        return batch
    first, second = (batch.column(name).cast(pa.string()) for name in time)
    if _all(first, _WHOLE):
        if not _all(second, _NANOSECONDS):
            odd = next(x for x in second.to_pylist() if x is not None)
            raise InputError(
                f"{path}: '{time[0]}' holds whole seconds, and '{time[1]}' is no whole number of nanoseconds below a "
                f"second: '{odd[:40]}'"
            )
        digits = compute.utf8_lpad(compute.utf8_trim_whitespace(second), 9, "0")
        whole = compute.binary_join_element_wise(compute.utf8_trim_whitespace(first), digits, ".")
        whole = whole if as_text else whole.cast(pa.float64())
    else:
        whole = compute.binary_join_element_wise(first, second, " ")
    kept = {name: batch.column(name) for name in batch.schema.names if name not in time}
    return pa.RecordBatch.from_pydict({**kept, time[0]: whole})


def _all(column: pa.Array, pattern: str) -> bool:
    """Return whether all texts of a column that are there fit a pattern."""
    return bool(compute.all(compute.match_substring_regex(column, pattern), min_count=0).as_py())
