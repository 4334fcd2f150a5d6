"""What the page of the hidden-effect test shows of the tier, from its kept summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jointwear.studies.world.scores import TARGETS, UPPER, WORDS, reached

#: Scores that are no shares of cases.
_NO_SHARES = {"gap_median", "gap_tenth", "calibration_error", "seconds"}


def world_context(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the summary with its table: words, value, count, target in words, and whether it is reached today."""
    rows = []
    for name, words in WORDS.items():
        found = summary["scores"].get(name)
        if found is None:
            continue
        rows.append(
            {
                "words": words,
                "value": _shown(name, found),
                "count": found["count"],
                "target": _target(name),
                "reached": reached(name, found),
            }
        )
    missed = [r["words"] for r in rows if r["reached"] is False]
    points = [
        {**b, "share": b["right"] / b["names"], "mean": b["expected"] / b["names"]} for b in summary["reliability"]
    ]
    return {**summary, "table": rows, "missed": missed, "points": points}


def limits_context(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is kept of the limits with its table in words, and the same of what is `assumed` if it is kept."""
    words = ", ".join(f"{stored['right'][kind]} of {count} {kind}" for kind, count in stored["judged"].items() if count)
    rows = [{**entry, "words": _more_or_less(entry)} for entry in stored["limits"]]
    beside = {"assumed": limits_context(stored["assumed"])} if "assumed" in stored else {}
    return {**stored, "words": words, "table": rows} | beside


def _more_or_less(entry: Mapping[str, Any]) -> str:
    right = [f"{kind} {n:+d}" for kind, n in entry["right"].items() if n]
    worse = [f"worse than given {entry['worse']:+d}"] if entry.get("worse") else []
    return ", ".join(right + worse) or "the same"


def _shown(name: str, found: Mapping[str, Any]) -> str:
    if found["value"] is None:
        return "no cases"
    interval = f" ({found['low']:.2f} to {found['high']:.2f})" if found["low"] is not None else ""
    return f"{found['value']:.3f}{interval}" if name not in _NO_SHARES else f"{found['value']:.3g}"


def _target(name: str) -> str:
    target = TARGETS.get(name)
    if target is None:
        return ""
    if isinstance(target, tuple):
        return f"{target[0]:.2f} to {target[1]:.2f}"
    return f"{'at most' if name in UPPER else 'at least'} {target:g}"
