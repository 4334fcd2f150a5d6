"""Scores of the tier over judged cases, with their targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jointwear.studies.challenge.reliability import calibration_error
from jointwear.studies.tallies import QUESTIONS, meets, share, single_value

Row = Mapping[str, Any]

#: Least share, or (least, largest); scores of `UPPER` are at most.
TARGETS: dict[str, Any] = {
    "name_first": 0.88,
    "axis": 0.95,
    "exact_set": 0.85,
    "false_names": 0.02,
    "unknown": 0.90,
    "two_found": 0.75,
    "two_exact": 0.60,
    "worse": 0.01,
    "gap_median": 0.85,
    "gap_tenth": 0.5,
    "coverage": (0.90, 0.98),
    "calibration_error": 0.05,
    "seconds": 4.0,
}
UPPER = {"false_names", "worse", "worse_than_truth", "refused", "calibration_error", "seconds"}

WORDS = {name: words for name, (_, _, words) in QUESTIONS.items()} | {
    "identifiable": "identifiable share, single effects",
    "false_names": "false names where nothing is hidden",
    "worse": "augmented worse than given on an axis by > 5 %, held-out measurement",
    "worse_than_truth": "the same against the torque without noise",
    "refused": "data set refused",
    "gap_median": "gap closed, median",
    "gap_tenth": "gap closed, 10th percentile",
    "coverage": "95 % intervals of parameters and peak torque hold the truth",
    "calibration_error": "expected calibration error of the probability",
    "seconds": "processor seconds, median",
}


def _seen(rows: Sequence[Row], kind: str) -> list[Row]:
    return [r for r in rows if r["kind"] == kind and r["identifiable"]]


def score(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """Return every score: value, count, 95 % interval of a share (Wilson), and whether the target is reached."""
    scores = {
        name: share([bool(r[field]) for r in _seen(rows, kind) if r.get(field) is not None])
        for name, (kind, field, _) in QUESTIONS.items()
    }
    scores["identifiable"] = share([bool(r["identifiable"]) for r in rows if r["kind"] == "single"])
    scores["false_names"] = share([bool(r["false_name"]) for r in rows if r["kind"] == "nothing"])
    for field in ("worse", "worse_than_truth"):
        scores[field] = share([bool(r[field]) for r in rows if r.get(field) is not None])
    scores["refused"] = share([r["verdict"] == "refused" for r in rows])
    gaps = [r["gap_closed"] for r in _seen(rows, "single") if r.get("gap_closed") is not None]
    scores["gap_median"] = single_value(float(np.median(gaps)) if gaps else None, len(gaps))
    scores["gap_tenth"] = single_value(float(np.percentile(gaps, 10)) if gaps else None, len(gaps))
    scores["coverage"] = share(intervals(rows))
    scores["calibration_error"] = single_value(*calibration_error(rows))
    seconds = [r["seconds"] for r in rows if r["seconds"] is not None]
    scores["seconds"] = single_value(float(np.median(seconds)) if seconds else None, len(seconds))
    return {name: {**s, "target": TARGETS.get(name), "reached": reached(name, s)} for name, s in scores.items()}


def intervals(rows: Sequence[Row]) -> list[bool]:
    """Return for every interval of a rightly named single effect whether it holds the truth."""
    found = []
    for row in rows:
        found += [bool(p["covered"]) for p in (row.get("parameters") or {}).values()]
        if row.get("covered") is not None:
            found.append(bool(row["covered"]))
    return found


def reached(name: str, found: Mapping[str, Any]) -> bool | None:
    """Whether a score reaches its target; None where it has none or nothing was counted."""
    return meets(found["value"], TARGETS.get(name), name in UPPER)
