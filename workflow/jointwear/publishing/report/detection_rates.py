"""Detection by Q and by T2, false alarms of normal weeks, and location, from the files of all runs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.storage import read_variables
from jointwear.reproduction.detection import alarms
from jointwear.reproduction.grid import by_cell
from jointwear.reproduction.location import shift_at
from jointwear.statistics.intervals import spread_over_replicates, wilson_interval

WEEK = 168.0  # h
# Share of the variance of training that is no more than round-off.
NO_VARIANCE = 1e-9
# Names in the location files of the ways to name the worn axis.
RULES = {"chosen": "source", "raw": "source_raw", "means_removed": "source_means_removed", "shift": "largest_shift"}


def _proportion(count: int, total: int) -> dict[str, Any]:
    low, high = wilson_interval(count, total)
    return {"count": count, "total": total, "share": count / total if total else None, "low": low, "high": high}


def proportion(hits: np.ndarray) -> dict[str, Any]:
    """Return a share with Wilson's 95 % interval; None where nothing was counted."""
    return _proportion(int(np.sum(hits)), int(np.size(hits)))


def mean_interval(values: np.ndarray, exposure: float) -> dict[str, float]:
    """Return the mean of counts (r,) per `exposure` with a 95 % interval over replicates.

    Alarms of one replicate depend on each other, so that the spread between replicates is what counts. Where no
    count differs from zero, the upper end is that of Poisson counts, 3 in the whole exposure ("rule of three").
    """
    values = np.asarray(values, dtype=float) / exposure
    mean = float(values.mean())
    half = 1.96 * float(values.std(ddof=1)) / np.sqrt(len(values)) if len(values) > 1 else np.nan
    if mean == 0:
        return {"mean": 0.0, "low": 0.0, "high": 3.0 / (len(values) * exposure)}
    if np.isnan(half):
        return {"mean": mean, "low": 0.0, "high": np.nan}
    return {"mean": mean, "low": max(0.0, mean - half), "high": mean + half}


def models_without_residual(models: Mapping[str, str | Path]) -> dict[str, dict[str, Any]]:
    """Return for each task how many of its normal models keep all the variance that there is.

    Their Q-statistic and its limit are zero but for round-off. It exceeds the limit as soon as anything changes that
    was constant in training (a series of an axis that rests, say), and shows nothing else. It happens with few joints,
    when the rule for the number of components keeps every one, and where axes rest.

    Parameters
    ----------
    models : task -> file of its normal models.
    """
    shares = {}
    for task, path in models.items():
        variance, kept = read_variables(path, "eigenvalues", "kept")
        left = np.where(np.arange(variance.shape[1]) < kept[:, None], 0.0, variance).sum(axis=1)
        shares[task] = proportion(left <= NO_VARIANCE * variance.sum(axis=1))
    return shares


def false_alarms(path: str | Path, rule: str, consecutive: int) -> dict[str, Any]:
    """Return the false alarms of a task's normal test period, by Q and by T2.

    Parameters
    ----------
    path : scores of the normal run.
    rule, consecutive : onset rule of the config, for T2, whose alarms the file does not hold.
    """
    q, t2, q_limit, t2_limit, count = read_variables(path, "q", "t2", "q_limit", "t2_limit", "alarms")
    weeks = q.shape[1] / WEEK
    result: dict[str, Any] = {"hours": q.shape[1], "replicates": q.shape[0]}
    for name, values, limit in (("q", q, q_limit), ("t2", t2, t2_limit)):
        above = values > limit[:, None]
        raised = count if name == "q" else alarms(above, rule, consecutive)
        result[name] = {
            "alarms_per_week": mean_interval(raised, weeks),
            "periods_with_alarm": proportion(raised > 0),
            "hours_above_limit": mean_interval(above.mean(axis=1), 1.0),
        }
    return result


def compare_statistics(detections: list[str]) -> list[dict[str, Any]]:
    """Return detection by Q and by T2 of every worn run, side by side."""
    rows = []
    for cell, path in by_cell(detections).items():
        row: dict[str, Any] = {
            "task": cell.task,
            "axis": cell.axis,
            "increase_percent": cell.increase_percent,
            "file": f"{cell.task}/{Path(path).name}",
        }
        for name, variable in (("q", "onset"), ("t2", "onset_t2")):
            (onset,) = read_variables(path, variable)
            median, low, high = spread_over_replicates(onset)
            row[name] = {**proportion(np.isfinite(onset)), "hour": median, "hour_low": low, "hour_high": high}
        rows.append(row)
    return rows


def _named_axes(path: str | Path, onset: np.ndarray) -> list[np.ndarray]:
    """Return the axis that each rule names, (r,) each, 0 = none; the largest shift is that at the onset."""
    *sources, shift = read_variables(path, *RULES.values())
    return [*sources, shift_at(shift, onset)]


def locations(files: list[str], detections: list[str]) -> list[dict[str, Any]]:
    """Return, for every worn run, in how many of its detected replicates each rule names the worn axis."""
    detection_files = by_cell(detections)
    rows = []
    for cell, path in by_cell(files).items():
        (onset,) = read_variables(detection_files[cell], "onset")
        detected = np.isfinite(onset)
        sources = _named_axes(path, onset)
        row: dict[str, Any] = {"task": cell.task, "axis": cell.axis, "increase_percent": cell.increase_percent}
        row.update({n: proportion(s[detected] == cell.axis) for n, s in zip(RULES, sources, strict=True)})
        rows.append(row)
    return rows


def pooled(parts: list[Mapping[str, Any]]) -> dict[str, Any]:
    """Add up proportions; the interval takes the replicates of all runs as independent."""
    return _proportion(sum(p["count"] for p in parts), sum(p["total"] for p in parts))


def located_without_wear(files: list[str], detections: list[str]) -> dict[str, Any]:
    """Return in how many normal test periods each rule names an axis although nothing wears.

    Parameters
    ----------
    files, detections : location and scores of the normal runs, in the same order of tasks.
    """
    named: dict[str, list[np.ndarray]] = {name: [] for name in RULES}
    for path, scores in zip(files, detections, strict=True):
        (onset,) = read_variables(scores, "onset")
        for name, source in zip(RULES, _named_axes(path, onset), strict=True):
            named[name].append(source > 0)
    return {name: proportion(np.concatenate(parts)) for name, parts in named.items()}
