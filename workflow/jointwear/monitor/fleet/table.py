"""The table of the fleet: one CSV row per robot, the most urgent first."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC
from pathlib import Path
from typing import Any

from jointwear.files.text_files import replace_text
from jointwear.measurement.timestamps import stamp
from jointwear.monitor.fleet.page import what_to_do
from jointwear.monitor.fleet.ranking import REFUSED
from jointwear.monitor.presentation.condition import UNJUDGED
from jointwear.monitor.presentation.words import change_words, growth_now, until_words

#: What each column holds is told in docs/howto/fleet.md.
COLUMNS = (
    "robot", "result", "alarms", "axes_changed", "reason", "urgency", "axis_to_check", "what_to_check",
    "growth_percent", "viscous_growth_percent", "limit_percent", "hours_to_limit", "hours_to_limit_low",
    "hours_to_limit_high", "alarms_unresolved", "axes_unresolved", "axes_unjudged", "axes_higher", "logs",
    "refused_logs", "copied_logs", "stale_logs", "unjudged_logs", "kept_logs", "windows", "refused_windows",
    "stale_windows", "unjudged_windows", "last_sample",
)  # fmt: skip


def table_row(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the cells of one robot; an empty cell is a value that is not known, or a limit that may never come."""
    first = next((axis for axis in row["axes"] if axis["check"]), None)
    hours = (first and first["hours"]) or [None] * 3
    check = first["check"] if first else what_to_do(row, UTC)
    if first and first.get("event"):
        # No number of now: it is told in words, until when it holds.
        check = f"{change_words(first, until_words(row, first, UTC))}; {check}"
    growth, viscous = growth_now(first) if first else ("", "")

    def axes(held: Callable[[Mapping[str, Any]], bool]) -> str:
        return " ".join(str(a) for a in sorted(axis["axis"] for axis in row["axes"] if held(axis)))

    cells = {
        **{name: row[name] for name in COLUMNS if name in row},
        "reason": row["reason"] or _refusal(row),
        "axis_to_check": first["axis"] if first else "",
        "what_to_check": check,
        "growth_percent": growth,
        "viscous_growth_percent": viscous,
        "limit_percent": first["limit"] if first else "",
        **dict(zip(("hours_to_limit", "hours_to_limit_low", "hours_to_limit_high"), hours, strict=True)),
        "alarms_unresolved": len(row["episodes"]),
        "axes_unresolved": axes(lambda axis: axis["alarms"] > 0),
        "axes_unjudged": axes(lambda axis: axis["level"] == UNJUDGED),
        "axes_higher": axes(lambda axis: bool(axis.get("rising"))),
        "last_sample": "" if row["last_sample"] is None else stamp(row["last_sample"], row["dated"]),
    }
    return {name: "" if cells[name] is None else cells[name] for name in COLUMNS}


def _refusal(row: Mapping[str, Any]) -> str:
    """Return why the newest log of a robot is refused that counts as refused for it; else empty."""
    return row["refusals"][-1] if row["urgency"] == REFUSED and row["refusals"] else ""


def write_table(rows: Sequence[Mapping[str, Any]], output: str | Path) -> None:
    """Write rows of :func:`~jointwear.monitor.fleet.ranking.as_of` as CSV."""
    text = io.StringIO()
    table = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    table.writeheader()
    table.writerows(table_row(row) for row in rows)
    replace_text(output, text.getvalue())
