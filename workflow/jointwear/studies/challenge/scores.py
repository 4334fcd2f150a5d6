"""Scores over many judged cases: the table with its targets, confusion, detection limits, calibration."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from jointwear.statistics.intervals import wilson_interval
from jointwear.studies.challenge.reliability import calibration_error
from jointwear.studies.challenge.tiers import EFFECTS, TARGETS, TIERS
from jointwear.studies.tallies import QUESTIONS, meets, share, single_value

Row = Mapping[str, Any]

#: Score -> kind of case, field of a row, words.
SHARES = QUESTIONS | {
    "tie_holds": ("single", "tie_holds", "tie set holds the truth"),
    "coverage": ("single", "covered", "95 % interval covers the true peak torque"),
}
#: Scores where less is better.
UPPER_LIMITS = {"false_names", "tie_size", "worse", "calibration_error", "seconds"}
#: Edges of the bins of evidence in which names are counted, and the ridge of the logistic regression.
_EDGES, _RIDGE = (0, 10, 15, 20, 30, 50, 100, 300, 1000, 1e12), 0.1


def _of(rows: Sequence[Row], kind: str, identifiable: bool) -> list[Row]:
    return [r for r in rows if r["kind"] == kind and (r["identifiable"] or not identifiable)]


def _share(rows: Sequence[Row], field: str) -> dict[str, Any]:
    return share([bool(r[field]) for r in rows if r.get(field) is not None])


def score_tier(rows: Sequence[Row], identifiable: bool = True) -> dict[str, dict[str, Any]]:
    """Return every score of one tier: value, count, and for shares a 95 % interval.

    Parameters
    ----------
    rows : of :func:`jointwear.studies.challenge.judge.judge`, one tier.
    identifiable : count only cases that the motion can show at all (the published score), or all cases.
    """
    scores = {name: _share(_of(rows, kind, identifiable), field) for name, (kind, field, _) in SHARES.items()}
    singles = _of(rows, "single", identifiable)
    scores["identifiable_share"] = _share(_of(rows, "single", False), "identifiable")
    scores["name_first_strict"] = _share(singles, "name_first_strict")
    scores["exact_set_strict"] = _share(singles, "exact_set_strict")
    scores["right_parameter"] = _share(_of(rows, "retuned", identifiable), "right_parameter")
    nothing = [r for r in rows if r["kind"] == "nothing"]
    scores["false_names"] = _share(nothing, "false_name")
    scores["worse"] = _share(rows, "worse")
    error, names = calibration_error(rows)
    scores["calibration_error"] = single_value(error, names)
    seconds = [r["seconds"] for r in rows if r.get("seconds") is not None]
    scores["seconds"] = single_value(float(np.median(seconds)) if seconds else None, len(seconds))
    gaps = [r["gap_closed"] for r in singles if r.get("gap_closed") is not None]
    scores["gap_median"] = single_value(float(np.median(gaps)) if gaps else None, len(gaps))
    scores["gap_tenth"] = single_value(float(np.percentile(gaps, 10)) if gaps else None, len(gaps))
    scores["not_worse"] = _share([r for r in rows if r.get("not_worse") is not None], "not_worse")
    scores["not_worse_named"] = _share([r for r in rows if r["named"] and r.get("not_worse") is not None], "not_worse")
    sizes = [r["tie_size"] for r in singles if r.get("tie_size")]
    scores["tie_size"] = single_value(float(np.mean(sizes)) if sizes else None, len(sizes))
    return scores


def reached(name: str, tier: str, score: Mapping[str, Any]) -> bool | None:
    """Whether a score reaches its target; None where it has none or nothing was counted."""
    target = TARGETS[name][list(TIERS).index(tier)] if name in TARGETS else None
    return meets(score["value"], target, name in UPPER_LIMITS)


def confusion(rows: Sequence[Row]) -> dict[str, dict[str, int]]:
    """Return truth -> answer -> number of cases: identifiable single effects, then the other kinds by verdict."""
    table: dict[str, Counter] = {name: Counter() for name in (*EFFECTS, "nothing", "retuned", "outside")}
    for row in rows:
        if row["kind"] == "two" or (row["kind"] in ("single", "outside", "retuned") and not row["identifiable"]):
            continue
        truth = row["subject"] if row["kind"] == "single" else row["kind"]
        table[truth][row["first_name"] or row["verdict"]] += 1
    return {truth: dict(answers) for truth, answers in table.items()}


def detection_limits(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return for every effect the size at which half and nine tenths of the cases get the right name.

    From a logistic curve in the logarithm of the size with a weak ridge, over all single cases, identifiable or not.
    None where the curve leaves the range of sizes tried; `always` and `never` say on which side.
    """
    result = []
    for name in EFFECTS:
        cases = [r for r in rows if r["kind"] == "single" and r["subject"] == name]
        if not cases:
            continue
        size = np.abs([r["size"] for r in cases])
        right = np.array([r["name_first_strict"] and r["axis_right"] for r in cases], dtype=float)
        x = np.log(size)
        centre, spread = x.mean(), max(x.std(), 1e-9)
        beta = _logistic((x - centre) / spread, right)
        limits = {}
        for level in (0.5, 0.9):
            odds = np.log(level / (1 - level))
            at = np.exp(centre + spread * (odds - beta[0]) / beta[1]) if abs(beta[1]) > 1e-3 else np.nan
            limits[level] = float(at) if size.min() <= at <= size.max() else None
        result.append(
            {
                "effect": name,
                "cases": len(cases),
                "right": int(right.sum()),
                "identifiable": int(sum(bool(r["identifiable"]) for r in cases)),
                "smallest": float(size.min()),
                "largest": float(size.max()),
                "half": limits[0.5],
                "ninety": limits[0.9],
                "grows_with_size": bool(beta[1] > 0),
            }
        )
    return result


def _logistic(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Fit intercept and slope of a logistic curve by Newton's method with a ridge; returns (2,)."""
    design = np.column_stack([np.ones_like(x), x])
    beta = np.zeros(2)
    for _ in range(50):
        p = 1 / (1 + np.exp(-np.clip(design @ beta, -30, 30)))
        hessian = design.T @ (design * (p * (1 - p))[:, None]) + _RIDGE * np.eye(2)
        step = np.linalg.solve(hessian, design.T @ (y - p) - _RIDGE * beta)
        beta = beta + step
        if np.abs(step).max() < 1e-9:
            break
    return beta


def calibration(rows: Sequence[Row]) -> list[dict]:
    """Return for bins of evidence [nats] how many names were given and how many of them were right, over all cases.

    A name is right where that effect (or one that the motion cannot tell from it) acts on that axis.
    """
    names = [n for r in rows for n in r["names"] if n["evidence"] is not None]
    result = []
    for low, high in pairwise(_EDGES):
        inside = [n["right"] for n in names if low <= n["evidence"] < high]
        interval = wilson_interval(sum(inside), len(inside))
        result.append(
            {
                "low": float(low),
                "high": float(high),
                "names": len(inside),
                "right": int(sum(inside)),
                "share_low": interval[0],
                "share_high": interval[1],
            }
        )
    return result
