"""Tables II to VI as rows, and how well each reproduces the paper."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from jointwear.reproduction.verdicts import AGREES, CLOSE, DIFFERS, HOUR_TOLERANCE, NOT_COMPARABLE

Row = dict[str, Any]
VERDICTS = (AGREES, CLOSE, DIFFERS, NOT_COMPARABLE)


def count_verdicts(verdicts: Iterable[str]) -> dict[str, int]:
    """Return how often each verdict occurs, all four always present."""
    counted = Counter(verdicts)
    return {v: counted[v] for v in VERDICTS}


def median_of(values: Iterable[float]) -> float | None:
    """Return the median, None of nothing."""
    values = list(values)
    return float(np.median(values)) if values else None


def largest_of(values: Iterable[float]) -> float | None:
    """Return the largest value, None of nothing."""
    return max(values, default=None)


def lag_verdict(published: float, reproduced: float, low: float, high: float) -> str:
    """Compare a lag [h]. *agrees*: within 10 h, the paper's sign, and the paper's value in the range over replicates;
    *close*: within 10 h, or sign and range; else *differs*. The ranges are wide, so that they never suffice alone."""
    near = abs(reproduced - published) <= HOUR_TOLERANCE
    fits = np.sign(published) == np.sign(reproduced) and low <= published <= high
    return AGREES if near and fits else CLOSE if near or fits else DIFFERS


def score_lags(rows: list[Row]) -> dict[str, Any]:
    """Score Table II over the pairs of axes (the matrix is antisymmetric); adds `verdict` to every such row."""
    pairs = [r for r in rows if r["row_axis"] < r["column_axis"] and r["published"] is not None]
    for row in rows:
        row["verdict"] = None
        if row["row_axis"] != row["column_axis"] and row["published"] is not None:
            row["verdict"] = lag_verdict(
                row["published"], row["reproduced"], row["reproduced_low"], row["reproduced_high"]
            )
    return {
        "pairs": len(pairs),
        "verdicts": count_verdicts(r["verdict"] for r in pairs),
        "same_sign": sum(bool(np.sign(r["published"]) == np.sign(r["reproduced"])) for r in pairs),
        "inside_range": sum(r["reproduced_low"] <= r["published"] <= r["reproduced_high"] for r in pairs),
        "median_error_h": median_of(abs(r["reproduced"] - r["published"]) for r in pairs),
    }


def score_design(rows: list[Row], printed: dict[str, Any]) -> dict[str, Any]:
    """Compare the grid with the paper's design (Table III)."""
    wanted = {
        (task, int(axis), float(increase))
        for task in printed["tasks"]
        for increase in printed["increase_percent"]
        for axis in printed["axes"]
    }
    grid = {(r["task"], int(r["axis"]), float(r["increase_percent"])) for r in rows}
    pairs = sorted({(task, increase) for task, _, increase in grid | wanted})
    return {
        "rows": [
            {
                "task": task,
                "increase_percent": increase,
                "published": sum((t, g) == (task, increase) for t, _, g in wanted),
                "reproduced": sum((t, g) == (task, increase) for t, _, g in grid),
            }
            for task, increase in pairs
        ],
        "runs": len(grid),
        "published_runs": len(wanted),
        "in_both": len(grid & wanted),
        "replicates": max((int(r["replicates"]) for r in rows), default=0),
    }


def score_detection(rows: list[Row]) -> dict[str, Any]:
    """Score Table IV: verdicts, agreement of the pattern detected / not detected, hours where both detect."""
    ran = [r for r in rows if r["verdict"] != NOT_COMPARABLE]
    ours, paper = [r["detection_probability"] >= 0.5 for r in ran], [r["published"] is not None for r in ran]
    pattern = Counter(zip(paper, ours, strict=True))
    for row in rows:
        known = row["published"] is not None and row["hour_median"] is not None and row["verdict"] != NOT_COMPARABLE
        row["error_h"] = row["hour_median"] - row["published"] if known else None
    errors = [abs(r["error_h"]) for r, o in zip(ran, ours, strict=True) if o and r["error_h"] is not None]
    return {
        "verdicts": count_verdicts(r["verdict"] for r in rows),
        "compared": len(ran),
        "same_pattern": pattern[True, True] + pattern[False, False],
        "both_detect": pattern[True, True],
        "neither_detects": pattern[False, False],
        "only_paper_detects": pattern[True, False],
        "only_we_detect": pattern[False, True],
        "median_error_h": median_of(errors),
        "largest_error_h": largest_of(errors),
    }


def score_values(rows: list[Row], relative: bool) -> dict[str, Any]:
    """Score Table V (`relative`: errors as a share of the published value) or VI (errors as they are).

    Adds `error` to every row, ours less the paper's. A published 0 (axis at rest) has no relative error.
    """
    for row in rows:
        usable = row["published"] is not None and row["reproduced"] is not None and (row["published"] or not relative)
        usable = usable and row["verdict"] != NOT_COMPARABLE
        scale = row["published"] if relative else 1.0
        row["error"] = (row["reproduced"] - row["published"]) / scale if usable else None
        row["error_at_published_hour"] = (
            (row["at_published_hour"] - row["published"]) / scale
            if usable and row["at_published_hour"] is not None
            else None
        )
    own = [abs(r["error"]) for r in rows if r["error"] is not None]
    there = [abs(r["error_at_published_hour"]) for r in rows if r["error_at_published_hour"] is not None]
    return {
        "verdicts": count_verdicts(r["verdict"] for r in rows),
        "median_error": median_of(own),
        "largest_error": largest_of(own),
        "median_error_at_published_hour": median_of(there),
        "largest_error_at_published_hour": largest_of(there),
    }
