"""Times of day as text. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

import math
import re
from datetime import UTC, datetime, tzinfo

#: Latest time [s], the year 2286 on a clock that counts from 1970; the earliest lies as far before.
LATEST = 1e10
#: A day as it is written with dots, 31.1.2026, a time of the day may follow.
_DAY_FIRST = re.compile(r"(\d{1,2})\.(\d{1,2})\.(\d{4})(?:[T ]+(\d\d:\d\d(?::\d\d)?))?")


def moment_of(given: float | str, zone: tzinfo = UTC) -> float:
    """Return a time of the config in seconds: a number, or ISO 8601; without a zone it counts in `zone`.

    Raises
    ------
    ValueError : if it is none, or beyond :data:`LATEST`.
    """
    seconds = float(given) if isinstance(given, (int, float)) else utc_seconds(given, zone)
    if abs(seconds) > LATEST:
        raise ValueError(f"{given} is beyond {LATEST:g} s")
    return seconds


def meant(given: object) -> str:
    """Return a hint ``; did you mean '2026-01-31'?`` for a day that is written day first, or an empty string."""
    said = _DAY_FIRST.fullmatch(str(given).strip())
    if said is None:
        return ""
    day, month, year, time = said.groups()
    text = f"{year}-{int(month):02d}-{int(day):02d}{'T' + time if time else ''}"
    try:
        utc_seconds(text)
    except ValueError:
        return ""
    return f"; did you mean '{text}'?"


def utc_seconds(text: str, zone: tzinfo = UTC) -> float:
    """Return seconds since 1970 UTC of an ISO 8601 time; without a zone it counts in `zone`.

    Raises
    ------
    ValueError : if the text is no such time.
    """
    moment = datetime.fromisoformat(text)
    return (moment if moment.tzinfo else moment.replace(tzinfo=zone)).timestamp()


def stamp(seconds: float, dated: bool) -> str:
    """Return a time as ISO 8601 UTC, or as seconds for logs without a date."""
    if not math.isfinite(seconds):
        return ""
    if not dated:
        return f"{seconds:.10g}"
    moment = datetime.fromtimestamp(round(seconds, 3), tz=UTC)
    digits = "milliseconds" if moment.microsecond else "seconds"
    return moment.isoformat(timespec=digits).replace("+00:00", "Z")
