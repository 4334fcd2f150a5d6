"""Time stamps of Arrow tables as seconds, those that name no zone by the clock on the wall."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
from pyarrow import compute

from jointwear.measurement.late_samples import first_long_run


class LocalStamps:
    """Turns the stamps of one log, batch after batch in order, into seconds since 1970 UTC.

    Where summer time ends an hour of the wall clock comes twice. Its stamps are of the first time until they fall back.

    Parameters
    ----------
    zone : of stamps that name none (IANA); default UTC.
    """

    def __init__(self, zone: str | None = None) -> None:
        self._zone = zone
        self._highest, self._second = -np.inf, False

    def seconds(self, column: pa.Array | pa.ChunkedArray) -> np.ndarray:
        """Return the next stamps as seconds since 1970 UTC, (m,), NaN where there is none."""
        if self._zone is None or column.type.tz is not None:
            return _seconds(column)
        found, later = (
            _seconds(compute.assume_timezone(column, self._zone, ambiguous=which, nonexistent="latest"))
            for which in ("earliest", "latest")
        )
        twice = later > found
        begin = 0 if self._second else self._fall(found, twice)
        if begin is not None:
            found = np.where(twice & (np.arange(len(found)) >= begin), later, found)
        known = np.flatnonzero(np.isfinite(found))
        if len(known):
            self._highest = float(np.fmax(self._highest, found[known].max()))
            self._second = bool(begin is not None and twice[known[-1]])
        return found

    def _fall(self, found: np.ndarray, twice: np.ndarray) -> int | None:
        """Return where stamps of an hour that comes twice fall back behind those before them, None where none do."""
        before = np.fmax.accumulate(np.concatenate([[self._highest], found]))[:-1]
        return first_long_run(twice & (found < before))


def _seconds(column: pa.Array | pa.ChunkedArray) -> np.ndarray:
    """Return time stamps as seconds since 1970, (m,)."""
    per_second = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}[column.type.unit]
    whole = column.cast(pa.int64())
    ticks = whole.fill_null(0).to_numpy(zero_copy_only=False) if isinstance(whole, pa.Array) else None
    if ticks is None:
        ticks = whole.fill_null(0).to_numpy()
    seconds = ticks // per_second + (ticks % per_second) / per_second
    if column.null_count:
        seconds = np.where(np.asarray(column.is_null()), np.nan, seconds)
    return seconds
