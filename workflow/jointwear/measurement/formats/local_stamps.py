"""Time stamps of logs as seconds, those that name no zone by the clock on the wall."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import numpy as np
import pyarrow as pa
from pyarrow import compute

from jointwear.measurement.late_samples import first_long_run
from jointwear.measurement.timestamps import LATEST, zone_of_offset

#: Time [s since 1970], the year 2128, from which on rules of summer time are not asked for; nanoseconds still reach it.
FURTHEST = LATEST / 2
#: Longest step [s] of times that go on through an hour that comes twice. A clock on the wall takes it without falling
#: back where the logger pauses for an hour or more and ends within so much of when it began: by chance one in twenty.
GOES_ON = 180.0
#: Days that a spreadsheet counts, from 1899-12-30 by the clock on the wall: those of the years 2000 to 2069. As days
#: since 1970 they would be of 2070 and later.
SERIAL_DAYS, SERIAL_ORIGIN = (36526.0, 62094.0), 25569.0
#: What hours that do not exist prove.
UNTURNED = "the logger does not turn its clock"


class LocalStamps:
    """Turns the stamps of one log, batch after batch in order, into seconds since 1970 UTC.

    Where summer time ends an hour of the wall clock comes twice. Its stamps are of the first time until they fall back.
    Where it begins an hour is left out. A few stamps of it, rounded or astray, are of the moment at which it begins;
    more of them in a row prove that the logger does not turn its clock: they count for no time.

    Attributes
    ----------
    none_such : how many of the last stamps count for no time, and in words why, empty where none.

    Parameters
    ----------
    zone : of stamps that name none (IANA); default UTC.
    """

    def __init__(self, zone: str | None = None) -> None:
        self._zone = zone
        self._highest, self._second = -np.inf, False
        self._unturned = self._counted = False
        self.none_such: tuple[int, str] = (0, "")

    def seconds(self, column: pa.Array | pa.ChunkedArray) -> np.ndarray:
        """Return the next stamps as seconds since 1970 UTC, (m,), NaN where there is none."""
        self.none_such = (0, "")
        if self._zone is None or column.type.tz is not None:
            return _seconds(column)
        found, later = (_seconds(self._zoned(column, which)) for which in ("earliest", "latest"))
        twice = later > found
        begin = 0 if self._second else self._fall(found, twice)
        if begin is not None:
            found = np.where(twice & (np.arange(len(found)) >= begin), later, found)
        known = np.flatnonzero(np.isfinite(found))
        if len(known):
            self._highest = float(np.fmax(self._highest, found[known].max()))
            self._second = bool(begin is not None and twice[known[-1]])
        return self._without_none_such(column, found)

    def of_wall_clock(self, seconds: np.ndarray) -> np.ndarray:
        """Return the next times (m,) as seconds since 1970 UTC, NaN where there is none.

        Parameters
        ----------
        seconds : (m,) from 1970 to the time, both by the clock on the wall; from :data:`FURTHEST` on they stay.
        """
        self._counted = True
        known, shown = _shown(seconds)
        return np.where(known, seconds + (self.seconds(shown) - _seconds(shown)), seconds)

    def of_serial_days(self, days: np.ndarray) -> np.ndarray | None:
        """Return the next times (m,), days as a spreadsheet counts them (:data:`SERIAL_DAYS`), as seconds since 1970
        UTC; None where they are none."""
        known = days[np.isfinite(days)]
        if not len(known) or not SERIAL_DAYS[0] <= np.median(known) < SERIAL_DAYS[1]:
            return None
        # To the microsecond, finer than a day in a number tells.
        return self.of_wall_clock(np.round((days - SERIAL_ORIGIN) * 86400.0, 6))

    def comes_twice(self, seconds: np.ndarray) -> np.ndarray:
        """Return which times (m,), as of :meth:`of_wall_clock`, the clock on the wall shows twice."""
        if self._zone is None:
            return np.zeros(len(seconds), dtype=bool)
        _, shown = _shown(seconds)
        found, later = (_seconds(self._zoned(shown, which)) for which in ("earliest", "latest"))
        return later > found

    def _zoned(self, column: pa.Array | pa.ChunkedArray, ambiguous: str, nonexistent: str = "latest") -> pa.Array:
        """Return stamps by the clock on the wall with their zone."""
        return compute.assume_timezone(column, self._zone, ambiguous=ambiguous, nonexistent=nonexistent)

    def _without_none_such(self, column: pa.Array | pa.ChunkedArray, found: np.ndarray) -> np.ndarray:
        """Return `found` with NaN for stamps of an hour that does not exist, once more of them than a few follow each
        other."""
        try:
            self._zoned(column, "earliest", "raise")
            return found
        except pa.ArrowInvalid:
            # A nanosecond apart, which seconds would not show.
            ends = (self._zoned(column, "earliest", which) for which in ("earliest", "latest"))
            absent = np.asarray(compute.fill_null(compute.not_equal(*ends), False))
        self._unturned |= first_long_run(absent) is not None
        if not self._unturned:
            return found
        first = datetime.fromtimestamp(int(_seconds(column)[np.argmax(absent)]), tz=UTC).replace(tzinfo=None)
        self.none_such = (int(absent.sum()), _of_unturned(first, self._zone, self._counted))
        return np.where(absent, np.nan, found)

    def _fall(self, found: np.ndarray, twice: np.ndarray) -> int | None:
        """Return where stamps of an hour that comes twice fall back behind those before them, None where none do."""
        before = np.fmax.accumulate(np.concatenate([[self._highest], found]))[:-1]
        return first_long_run(twice & (found < before))


def goes_on_through(pieces: Iterable[np.ndarray], zone: str) -> bool:
    """Return whether times go on evenly through an hour that the clock on the wall shows twice, which they show once:
    they are counted, and follow no clock on the wall.

    Parameters
    ----------
    pieces : of the times [s] of one log in order, (m,) each, as of :meth:`LocalStamps.of_wall_clock`. zone : IANA.
    """
    stamps, highest, seen, inside = LocalStamps(zone), -np.inf, False, False
    for piece in pieces:
        wall = piece[np.isfinite(piece)]
        if not len(wall):
            continue
        twice, top = stamps.comes_twice(wall), np.fmax.accumulate(np.concatenate([[highest], wall]))
        touched = twice | np.concatenate([[inside], twice[:-1]])
        if (np.diff(top)[touched] > GOES_ON).any() or first_long_run(twice & (wall < top[:-1])) is not None:
            return False
        highest, seen, inside = float(top[-1]), seen or bool(twice.any()), bool(twice[-1])
    return seen and not inside


def _shown(seconds: np.ndarray) -> tuple[np.ndarray, pa.Array]:
    """Return which times (m,) [s] rules of summer time are asked for, and all as stamps that name no zone."""
    known = np.abs(seconds) < FURTHEST
    ticks = np.round(np.where(known, seconds, 0.0) * 1e9).astype(np.int64)
    return known, pa.array(ticks, mask=~known).cast(pa.timestamp("ns"))


def _of_unturned(stamp: datetime, zone: str, counted: bool) -> str:
    """Return in words that a time does not exist in a zone, and what to state in its place; `counted`: the times are
    numbers from an origin."""
    hours = ZoneInfo(zone).utcoffset(stamp).total_seconds() / 3600
    winter = f"'{zone_of_offset(int(hours))}' where it keeps winter time, " if hours and hours.is_integer() else ""
    return (
        f"the time {stamp.isoformat(sep=' ')} does not exist in {zone}, where summer time begins: {UNTURNED}, "
        "and its times in summer are read wrong; state 'time_zone' as "
        f"{winter}'UTC' where it keeps that"
        + (", or an offset behind the date of the unit of time where its numbers are seconds that go on" * counted)
    )


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
