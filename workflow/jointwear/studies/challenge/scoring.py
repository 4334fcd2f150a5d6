"""Read truth and verdicts, judge every case, and write the scores. The only place where the two meet."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.json_documents import read_json, write_json
from jointwear.files.storage import read_variables
from jointwear.studies.challenge.case_files import read_truth
from jointwear.studies.challenge.generate import Truth
from jointwear.studies.challenge.judge import error_norm, judge, worse_axes
from jointwear.studies.challenge.scores import calibration, confusion, detection_limits, reached, score_tier
from jointwear.studies.challenge.tiers import TIERS

_MODELS = ("nominal", "retuned", "augmented")


def judge_batch(truth_json: str, truth_netcdf: str, verdict_json: str, verdict_netcdf: str) -> list[dict[str, Any]]:
    """Return one judged row a case of a batch.

    Raises
    ------
    InputError : if a file is missing or broken, or the files do not hold the same cases.
    """
    truths = read_truth(truth_json, truth_netcdf)
    said = read_json(verdict_json)["cases"]
    (predicted,) = read_variables(verdict_netcdf, "torque")
    if [t.facts["case"] for t in truths] != [s["case"] for s in said]:
        raise InputError(f"{verdict_json}: holds other cases than {truth_json}; delete both and run again")
    return [judge_case(t, s["verdict"], p, s["seconds"]) for t, s, p in zip(truths, said, predicted, strict=True)]


def judge_case(truth: Truth, verdict: dict[str, Any], predicted: np.ndarray, seconds: float | None) -> dict[str, Any]:
    """Judge one case; `predicted` (3, k, n) is the torque of nominal, retuned and augmented model [N m]."""
    errors = None
    if np.isfinite(predicted).any():
        errors = {m: error_norm(p, truth.torque) for m, p in zip(_MODELS, predicted, strict=True)}
        errors["floor"] = error_norm(predicted[0], truth.given)
    row = judge(truth.facts, verdict, errors, seconds)
    if errors:
        row["worse"] = worse_axes(predicted, truth.measured)
    for key in ("arm", "rate", "torque_kind", "controller"):
        row[key] = truth.facts.get(key)
    if row["kind"] == "single" and row.get("name_first_strict") and row["axis_right"]:
        row["covered"] = peak_covered(truth.facts["effects"][0], verdict["effects"][0])
    return row


def peak_covered(effect: dict[str, Any], named: dict[str, Any]) -> bool | None:
    """Whether the 95 % interval of the effect's largest torque over the held-out motion holds the true one.

    For a payload the axis with the largest true torque counts. None where the verdict gives no `peak_torque`.
    """
    peak = named.get("peak_torque")
    if peak is None or peak.get("low") is None:
        return None
    axis = named["axis"]
    true = effect["peak"][axis - 1] if axis is not None else max(effect["peak"])
    return peak["low"] <= true <= peak["high"]


def summarise(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return everything that the page shows, by tier."""
    result: dict[str, Any] = {"tiers": {}, "cases": len(rows)}
    for tier in TIERS:
        mine = [r for r in rows if r["tier"] == tier]
        if not mine:
            continue
        scores, everything = score_tier(mine), score_tier(mine, identifiable=False)
        seconds = [r["seconds"] for r in mine if r["seconds"] is not None]
        result["tiers"][tier] = {
            "cases": len(mine),
            "scores": {k: {**v, "reached": reached(k, tier, v)} for k, v in scores.items()},
            "all_cases": everything,
            "confusion": confusion(mine),
            "limits": detection_limits(mine),
            "calibration": calibration(mine),
            "seconds": {
                "median": float(np.median(seconds)) if seconds else None,
                "largest": max(seconds, default=None),
            },
        }
    return result


def write_scores(
    truths: Sequence[tuple[str, str]],
    verdicts: Sequence[tuple[str, str]],
    rows_path: str | Path,
    scores_path: str | Path,
) -> None:
    """Judge all batches and write one row a case and the summary, both JSON.

    Parameters
    ----------
    truths, verdicts : (JSON, netCDF) of every batch, in the same order.
    """
    rows = [row for t, v in zip(truths, verdicts, strict=True) for row in judge_batch(*t, *v)]
    rows.sort(key=lambda r: r["case"])
    write_json(rows_path, {"cases": rows})
    write_json(scores_path, summarise(rows))


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else str(value)
