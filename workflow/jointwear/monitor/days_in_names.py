"""Days in the names of logs, in every spelling that tells which number is the day and which the month.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from datetime import date

_YEAR = r"((?:19|20)\d\d)"
#: What stands between two numbers of a day, the same at both places or nothing; a time of the day may follow the day.
_BETWEEN, _END = r"([-_.]?)", r"(?!\d(?:\d{2})*(?!\d))"
_MONTH, _DAY, _DAY_ALONE = r"(0[1-9]|1[0-2])", r"(0[1-9]|[12]\d|3[01])", r"(1[3-9]|2\d|3[01])"
#: A day as 2026-10-28, 2026_10_28 or 20261028; as 28.10.2026 or 28102026; as 10-28-2026; and one of the last spelling
#: whose second number can be no month.
_YEAR_FIRST = re.compile(rf"(?<!\d){_YEAR}{_BETWEEN}{_MONTH}\2{_DAY}{_END}")
_DAY_FIRST = re.compile(rf"(?<!\d){_DAY}{_BETWEEN}{_MONTH}\2{_YEAR}{_END}")
_MONTH_FIRST = re.compile(rf"(?<!\d){_MONTH}{_BETWEEN}{_DAY}\2{_YEAR}{_END}")
_SURELY_MONTH_FIRST = re.compile(rf"(?<!\d){_MONTH}{_BETWEEN}{_DAY_ALONE}\2{_YEAR}{_END}")
#: Largest number of a month: a larger one in its place is a day.
_LAST_MONTH = 12


def spelling_of(logs: Iterable[str]) -> str | None:
    """Return what comes first where the year comes last, "day" or "month"; None where nothing tells, or both are there.

    A day beyond the twelfth in the name of any log tells it for all of them.
    """
    logs = list(logs)
    day = any(int(said[0]) > _LAST_MONTH for log in logs for said in _DAY_FIRST.findall(log))
    month = any(map(_SURELY_MONTH_FIRST.search, logs))
    return None if day == month else "day" if day else "month"


def year_first(logs: Iterable[str]) -> Callable[[str], str]:
    """Return how a name of these logs is written with the year first, where it tells which is the day and which the
    month."""
    match spelling_of(logs):
        case "day":
            return lambda log: _DAY_FIRST.sub(r"\4\2\3\2\1", log)
        case "month":
            return lambda log: _MONTH_FIRST.sub(r"\4\2\1\2\3", log)
    return lambda log: log


def days_of(logs: Iterable[str]) -> list[date | None]:
    """Return the day that the name of each log holds, the last one of several; None where it holds none for certain."""
    logs = list(logs)
    first = spelling_of(logs)
    return [_day_of(log, first) for log in logs]


def _day_of(log: str, first: str | None) -> date | None:
    found = [(m.start(), m[1], m[3], m[4]) for m in _YEAR_FIRST.finditer(log)]
    if first == "day":
        found += [(m.start(), m[4], m[3], m[1]) for m in _DAY_FIRST.finditer(log)]
    elif first == "month":
        found += [(m.start(), m[4], m[1], m[3]) for m in _MONTH_FIRST.finditer(log)]
    if not found:
        return None
    _, year, month, day = max(found)
    try:
        return date(int(year), int(month), int(day))
    except ValueError:
        return None
