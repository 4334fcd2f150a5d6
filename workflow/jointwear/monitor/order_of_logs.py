"""The order of logs by name: numbers by their size, days that are written day first by the calendar.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

#: A day as 28.10.2026, 28-10-2026, 28_10_2026 or 28102026, and one as 10282026; a time of the day may follow.
_AFTER = r"((?:19|20)\d\d)(?!\d(?:\d{2})*(?!\d))"
_DAY_FIRST = re.compile(rf"(?<!\d)(0[1-9]|[12]\d|3[01])([-_.]?)(0[1-9]|1[0-2])\2{_AFTER}")
_MONTH_FIRST = re.compile(rf"(?<!\d)(0[1-9]|1[0-2])([-_.]?)(1[3-9]|2\d|3[01])\2{_AFTER}")
#: Largest number of a month: a larger one in its place is a day.
_LAST_MONTH = 12


def in_order(logs: Iterable[str]) -> list[str]:
    """Return logs each once, in order of their names; files inside a bag's folder belong to the bag.

    Numbers count by their size. Of days that are written day first the year counts first, then the month, where a day
    beyond the twelfth tells that they are, and none that the month comes first.
    """
    logs = set(logs)
    bags = {Path(m) for m in logs if Path(m).is_dir()}
    day_first = any(int(said[0]) > _LAST_MONTH for log in logs for said in _DAY_FIRST.findall(log))
    day_first &= not any(map(_MONTH_FIRST.search, logs))

    def place(log: str) -> tuple[list[Any], str]:
        return _natural(_DAY_FIRST.sub(r"\4\2\3\2\1", log) if day_first else log), log

    return sorted((m for m in logs if not bags & set(Path(m).parents)), key=place)


def _natural(path: str) -> list[Any]:
    return [(1, int(part), "") if part.isdecimal() else (0, 0, part) for part in re.split(r"(\d{1,18})", path)]
