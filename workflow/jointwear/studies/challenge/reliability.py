"""Does the probability of a name mean what it says?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

Row = Mapping[str, Any]

#: Bins of the probability of a name: finer where names are given.
PROBABILITY_EDGES = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 1.0)


def reliability(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return for bins of the probability: how many names were given, how many right, how many expected to be right."""
    names = [n for r in rows for n in r["names"] if n.get("probability") is not None]
    result = []
    for low, high in pairwise(PROBABILITY_EDGES):
        last = high == PROBABILITY_EDGES[-1]
        inside = [n for n in names if low <= n["probability"] < high or (last and n["probability"] >= high)]
        if inside:
            result.append(
                {
                    "low": low,
                    "high": high,
                    "names": len(inside),
                    "right": int(sum(n["right"] for n in inside)),
                    "expected": float(sum(n["probability"] for n in inside)),
                }
            )
    return result


def calibration_error(rows: Sequence[Row]) -> tuple[float | None, int]:
    """Return the expected calibration error over all names, weighted by the names of each bin, and their count."""
    bins = reliability(rows)
    total = sum(b["names"] for b in bins)
    return (sum(abs(b["right"] - b["expected"]) for b in bins) / total if total else None), total
