"""How answers to many cases are counted: shares with their interval, and the questions that every plant is asked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jointwear.statistics.intervals import wilson_interval

#: Score -> kind of case that counts, field of a judged row, words. Rows whose field is None do not count.
QUESTIONS = {
    "name_first": ("single", "name_first", "right name first"),
    "axis": ("single", "axis_right", "right axis"),
    "exact_set": ("single", "exact_set", "exact set of names, single effects"),
    "retuned": ("retuned", "retuned", "one wrong parameter called retuned, no effect named"),
    "unknown": ("outside", "unknown_only", "outside the library: unknown, or suspects only"),
    "two_found": ("two", "both_found", "two effects, both found"),
    "two_exact": ("two", "two_exact", "two effects, exact"),
}


def share(answers: Sequence[bool]) -> dict[str, Any]:
    """Return value (None without answers), count and 95 % interval (Wilson) of the share of answers that are true."""
    low, high = wilson_interval(sum(answers), len(answers))
    return {"value": sum(answers) / len(answers) if answers else None, "count": len(answers), "low": low, "high": high}


def single_value(value: float | None, count: int) -> dict[str, Any]:
    """Return a score without an interval: its value and how many cases stand behind it."""
    return {"value": value, "count": count, "low": None, "high": None}


def meets(value: float | None, target: float | tuple[float, float] | None, upper: bool) -> bool | None:
    """Whether a value reaches its target, (least, largest) or a bound; None where either is missing.

    Parameters
    ----------
    upper : the target is the largest allowed value.
    """
    if target is None or value is None:
        return None
    if isinstance(target, tuple):
        return target[0] <= value <= target[1]
    return value <= target if upper else value >= target
