"""The order of logs by name: numbers by their size, days whose year is written last by the calendar.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from jointwear.monitor.days_in_names import year_first


def in_order(logs: Iterable[str]) -> list[str]:
    """Return logs each once, in order of their names; files inside a bag's folder belong to the bag.

    Numbers count by their size. Of days whose year is written last it counts first, then the month, where a day beyond
    the twelfth tells which of the two others is the month.
    """
    logs = set(logs)
    bags = {Path(m) for m in logs if os.path.isdir(m)}
    sortable = year_first(logs)

    def place(log: str) -> tuple[list[Any], str]:
        return _natural(sortable(log)), log

    return sorted((m for m in logs if not bags & set(Path(m).parents)), key=place)


def _natural(path: str) -> list[Any]:
    return [(1, int(part), "") if part.isdecimal() else (0, 0, part) for part in re.split(r"(\d{1,18})", path)]
