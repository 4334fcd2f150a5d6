"""What decides whether wear is detected: the paper's claim about load and variability, tested on the grid."""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.files.storage import open_dataset, read_variable, read_variables
from jointwear.reproduction.grid import Cell, by_cell
from jointwear.reproduction.published import Published

RESAMPLES = 2000


def ranks(values: np.ndarray) -> np.ndarray:
    """Return ranks along the last axis, ties sharing their mean rank; (..., m) -> (..., m)."""
    below = (values[..., None, :] < values[..., :, None]).sum(axis=-1)
    equal = (values[..., None, :] == values[..., :, None]).sum(axis=-1)
    return below + (equal + 1) / 2


def rank_correlation(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return Spearman's rank correlation along the last axis, NaN where a series does not vary."""
    a, b = (r - r.mean(axis=-1, keepdims=True) for r in (ranks(x), ranks(y)))
    scale = np.sqrt((a**2).sum(axis=-1) * (b**2).sum(axis=-1))
    return np.divide((a * b).sum(axis=-1), scale, out=np.full(scale.shape, np.nan), where=scale > 0)


def correlate(x: np.ndarray, y: np.ndarray, seed: int) -> dict[str, Any]:
    """Return Spearman's correlation of cells (m,) with a 95 % bootstrap interval; None where it is not defined."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    empty = {"value": None, "low": None, "high": None, "cells": len(x)}
    if len(x) < 4:
        return empty
    value = float(rank_correlation(x, y))
    if np.isnan(value):
        return empty
    picks = np.random.default_rng(np.random.SeedSequence(seed)).integers(len(x), size=(RESAMPLES, len(x)))
    low, high = np.nanquantile(rank_correlation(x[picks], y[picks]), [0.025, 0.975])
    return {"value": value, "low": float(low), "high": float(high), "cells": len(x)}


def median_onset(onset: np.ndarray) -> float:
    """Return the hour by which half of the replicates are detected, infinite where fewer ever are."""
    return float(np.quantile(np.where(np.isnan(onset), np.inf, onset), 0.5, method="higher"))


def predictors(features: dict[str, str], simulations: list[str]) -> dict[Cell, dict[str, float]]:
    """Return what might decide detection, for every worn run.

    Parameters
    ----------
    features : file of the features of normal operation, by task.
    simulations : files of the worn runs.

    Returns
    -------
    by cell: `variation`, coefficient of variation of |torque| in normal operation; `load`, mean |torque| in normal
    operation [N m]; `growth_share`, mean change of the commanded torque by the end of the wear as a share of the
    axis's largest commanded torque at its beginning.
    """
    normal = {}
    for task, path in features.items():
        load, variation = read_variables(path, "mean_absolute_torque", "variation")
        normal[task] = load.mean(axis=(0, 1)), variation.mean(axis=(0, 1))
    result = {}
    for cell, path in by_cell(simulations).items():
        j = cell.axis - 1
        with open_dataset(path) as dataset:
            first, last = (
                read_variable(dataset, path, "commanded_torque", (hour, slice(None), j)).astype(float)
                for hour in (0, -1)
            )
        largest = np.abs(first).max()
        load, variation = normal[cell.task]
        result[cell] = {
            "variation": float(variation[j]),
            "load": float(load[j]),
            "growth_share": float(np.abs(last - first).mean() / largest) if largest > 0 else 0.0,
        }
    return result


def measured_drivers(
    found: dict[Cell, dict[str, float]], onsets: dict[Cell, np.ndarray], seed: int
) -> list[dict[str, Any]]:
    """Return, for every growth, how each predictor goes with the probability and the earliness of detection.

    A positive correlation helps detection. `onsets`: hours of detection (r,) by cell, NaN where none.
    """
    rows = []
    for increase in sorted({c.increase_percent for c in found}):
        cells = [c for c in found if c.increase_percent == increase]
        probability = [float(np.isfinite(onsets[c]).mean()) for c in cells]
        earliness = [-median_onset(onsets[c]) for c in cells]
        for name in ("variation", "load", "growth_share"):
            x = [found[c][name] for c in cells]
            rows.append(
                {
                    "increase_percent": increase,
                    "predictor": name,
                    "probability": correlate(x, probability, seed),
                    "earliness": correlate(x, earliness, seed),
                }
            )
    return rows


def published_drivers(printed: Published, seed: int) -> list[dict[str, Any]]:
    """Return the same for the paper's own values: Tables V (load) and VI (variation) against the hours of IV."""
    rows = []
    design = printed.data["table_iii_design"]
    for increase in design["increase_percent"]:
        cells = [Cell(task, float(increase), axis) for task in design["tasks"] for axis in design["axes"]]
        earliness = [-(printed.detection_hour(c) or np.inf) for c in cells]
        for name, value in (("variation", printed.variation), ("load", printed.maximum_torque)):
            rows.append(
                {
                    "increase_percent": float(increase),
                    "predictor": name,
                    "earliness": correlate([value(c) for c in cells], earliness, seed),
                }
            )
    return rows
