"""Times of day as text. Read by the Snakefile at every call: nothing heavy is imported here."""

from __future__ import annotations

import math
import re
from calendar import monthrange
from collections.abc import Mapping
from datetime import UTC, datetime, tzinfo

#: Latest time [s], the year 2286 on a clock that counts from 1970; the earliest lies as far before.
LATEST = 1e10
#: A day as it is written elsewhere, 31.1.2026, 1/31/26 or 2026/1/31; a time of the day may follow.
_OTHERWISE = re.compile(
    r"(\d{1,4})([./-])(\d{1,2})\2(\d{4}|\d\d?)"
    r"(?:[T ]+(\d{1,2})[:.](\d\d)(?:[:.](\d\d(?:[.,]\d+)?))?(?: ?([AaPp])\.?[Mm]\.?)?(Z|[+-]\d\d:?\d\d)?)?"
)
#: A time of the day alone.
_TIME_OF_DAY = re.compile(r"(\d{1,2})(:\d\d(?::\d\d(?:[.,]\d+)?)?)")


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
    """Return a hint ``; did you mean '2026-01-31'?`` for a time that is written otherwise, or an empty string.

    Seconds in quotation marks are text, which is taken for a day.
    """
    if isinstance(given, str) and re.fullmatch(r"[-+]?\d+\.?\d*", given.strip(), re.ASCII):
        return f"; did you mean {given.strip()}, without quotation marks?"
    if last := _last_of_month(str(given).strip()):
        return f"; that day does not exist, the nearest valid value is '{last}'"
    found = _iso_of(str(given).strip())
    return f"; did you mean {_or(found)}?" if found else ""


def _last_of_month(given: str) -> str:
    """Return an ISO 8601 time whose day its month does not have with the last day of that month, else an empty
    string."""
    said = re.match(r"(\d{4})-(0[1-9]|1[0-2])-(29|3[01])(?!\d)", given)
    if said is None or int(said[1]) == 0:
        return ""
    last = monthrange(int(said[1]), int(said[2]))[1]
    moved = f"{said[1]}-{said[2]}-{last:02d}{given[said.end() :]}"
    try:
        utc_seconds(moved)
    except ValueError:
        return ""
    return moved if int(said[3]) > last else ""


def to_write(given: str) -> str:
    """Return what to write for the times of a log, of which one is written otherwise, ``; write all times of the log as
    ISO 8601, this one as '2026-01-31T06:00:00'``, or an empty string."""
    if alone := _TIME_OF_DAY.fullmatch(given.strip()):
        time = f"{int(alone[1]):02d}{alone[2].replace(',', '.')}"
        return (
            f"; the day is lacking: write '2026-01-15T{time}', or seconds, or name the column of the date before that "
            "of the time, as variables: {time: [date, time]}"
        )
    found = _iso_of(given.strip())
    return f"; write all times of the log as ISO 8601, this one as {_or(found)}" if found else ""


def _or(found: Mapping[str, str]) -> str:
    """Return readings of a day in words; what comes first in it tells them apart."""
    if len(found) == 1:
        return f"'{next(iter(found))}'"
    return " or ".join(f"'{text}' ({what} first)" for text, what in found.items())


def _iso_of(given: str) -> dict[str, str]:
    """Return as ISO 8601 what a time that is written otherwise can mean -> what comes first: day, month or year."""
    said = _OTHERWISE.fullmatch(given)
    if said is None:
        return {}
    (one, between, two, three), time = said.groups()[:4], ""
    if said[5]:
        hour = int(said[5]) % 12 + 12 * (said[8] in "Pp") if said[8] else int(said[5])
        time = f"T{hour:02d}:{said[6]}" + (f":{said[7].replace(',', '.')}" if said[7] else "") + (said[9] or "")
    if len(one) == 4:
        orders = [("year", one, two, three)]
    else:
        orders = [("day", three, two, one)]
        # Dots stand behind days alone; 26-01-15 may begin with the year.
        orders += [("month", three, one, two)] if between != "." else []
        orders += [("year", one, two, three)] if between == "-" and len(three) == 2 else []
    found: dict[str, str] = {}
    for what, year, month, day in orders:
        text = f"{year if len(year) == 4 else f'20{int(year):02d}'}-{int(month):02d}-{int(day):02d}{time}"
        try:
            utc_seconds(text)
        except ValueError:
            continue
        found.setdefault(text, what)
    return found


def zone_of_offset(hours: int) -> str:
    """Return the IANA name of an offset all year, `hours` east of Greenwich; these names count to the west."""
    return f"Etc/GMT{-hours:+d}"


def utc_seconds(text: str, zone: tzinfo = UTC) -> float:
    """Return seconds since 1970 UTC of an ISO 8601 time; without a zone it counts in `zone`.

    Raises
    ------
    ValueError : if the text is no such time.
    """
    moment = datetime.fromisoformat(text)
    return (moment if moment.tzinfo else moment.replace(tzinfo=zone)).timestamp()


def names_zone(text: str) -> bool:
    """Return whether an ISO 8601 time names its zone, as ``2026-02-01T06:00:00+01:00``.

    Raises
    ------
    ValueError : if the text is no such time.
    """
    return datetime.fromisoformat(text).tzinfo is not None


def stamp(seconds: float, dated: bool) -> str:
    """Return a time as ISO 8601 UTC, or as seconds for logs without a date."""
    if not math.isfinite(seconds):
        return ""
    if not dated:
        return f"{seconds:.10g}"
    moment = datetime.fromtimestamp(round(seconds, 3), tz=UTC)
    digits = "milliseconds" if moment.microsecond else "seconds"
    return moment.isoformat(timespec=digits).replace("+00:00", "Z")
