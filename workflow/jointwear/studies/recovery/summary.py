"""The results of the recovery for the report's chapter, as plain data."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import read_json, write_json
from jointwear.files.json_values import six_digits
from jointwear.files.storage import open_dataset, read_variable
from jointwear.statistics.intervals import wilson_interval
from jointwear.studies.recovery.plan import CAUSES


def bound_summary(path: str | Path) -> dict[str, Any]:
    """Return, by axis, what the unloaded arm can reach and what Table V prints (results/recovery/bound.nc)."""
    with open_dataset(path) as data:
        largest, held, static, published, speed, times, reachable = (
            read_variable(data, path, name)
            for name in (
                "largest_torque",
                "largest_torque_held",
                "static_bound",
                "published",
                "largest_speed",
                "segment_time",
                "reachable_from_held",
            )
        )
        tasks = [str(t) for t in data["task"][:]]
    finite = times < 1e5
    slow = int(np.argmax(np.where(finite, times, -np.inf)))
    axes = []
    for a in range(largest.shape[1]):
        printed = published[:, :, a]
        axes.append(
            {
                "axis": a + 1,
                "static": six_digits(static[a]),
                "slow": six_digits(largest[slow, a]),
                "published": six_digits(printed.max()),
                "out_of_reach": int((printed > largest[slow, a]).sum()),
                "largest_speed": six_digits(speed[a]),
                "segment_time_needed": six_digits(reachable[:, :, a][printed > largest[slow, a]].min(initial=np.inf)),
            }
        )
    return {
        "segment_times": [six_digits(t) for t in times[finite]],
        "slow_segment_time": six_digits(times[slow]),
        "largest": [[six_digits(x) for x in row] for row in largest[finite]],
        "held": [[six_digits(x) for x in row] for row in held[finite]],
        "axes": axes,
        "tasks": tasks,
        "cells": int(published.size),
        "out_of_reach": int(sum(a["out_of_reach"] for a in axes)),
    }


def comparison_rows(path: str | Path) -> list[dict[str, Any]]:
    """Return results/recovery/comparison.csv with numbers; empty fields are None."""
    with Path(path).open(newline="", encoding="utf-8") as file:
        rows = [
            {k: (v if k == "candidate" else six_digits(v) if v else None) for k, v in r.items()}
            for r in csv.DictReader(file)
        ]
    return sorted(rows, key=lambda r: r["bic"])


def ensemble_summary(path: str | Path) -> dict[str, Any]:
    """Return what the pose sets share and where they differ (results/recovery/ensemble_*.nc)."""
    with open_dataset(path) as data:
        start, stop, effect, shape, outward = (
            read_variable(data, path, name) for name in ("start", "stop", "effect", "shape", "outward")
        )
        names = [str(n) for n in data["parameter"][:]]
    mass, z = effect[:, names.index("mass")], effect[:, names.index("com_z")]
    moved = np.degrees(np.abs(stop - start))
    return {
        "solutions": len(start),
        "mass": [six_digits(x) for x in mass],
        "com_z": [six_digits(x) for x in z],
        "shape": [six_digits(x) for x in shape],
        "product": {
            "low": six_digits((mass * z).min()),
            "median": six_digits(np.median(mass * z)),
            "high": six_digits((mass * z).max()),
        },
        "shape_range": {
            "low": six_digits(shape.min()),
            "median": six_digits(np.median(shape)),
            "high": six_digits(shape.max()),
        },
        "mass_range": {"low": six_digits(mass.min()), "high": six_digits(mass.max())},
        "travel": {
            "low": [[six_digits(x) for x in row] for row in np.quantile(moved, 0.05, axis=0)],
            "high": [[six_digits(x) for x in row] for row in np.quantile(moved, 0.95, axis=0)],
        },
        "outward": [six_digits(x) for x in outward],
    }


def prediction_summary(path: str | Path) -> dict[str, Any]:
    """Return Table IV as predicted with the hours unknown, beside the paper (results/recovery/prediction.nc)."""
    with open_dataset(path) as data:
        probability, low, high, hour, published, increase = (
            read_variable(data, path, name)
            for name in ("probability", "probability_low", "probability_high", "hour", "published", "increase")
        )
        tasks = [str(t) for t in data["task"][:]]
        scores = {
            name: six_digits(data.getncattr(name))
            for name in ("plain", "balanced", "brier", "base_brier", "hour_error")
        }
    cells = [
        {
            "task": tasks[t],
            "axis": a + 1,
            "increase_percent": six_digits(increase[c]),
            "probability": six_digits(probability[t, a, c]),
            "low": six_digits(low[t, a, c]),
            "high": six_digits(high[t, a, c]),
            "hour": six_digits(hour[t, a, c]),
            "published": six_digits(published[t, a, c]),
        }
        for t, a, c in np.ndindex(probability.shape)
    ]
    return {
        **scores,
        "cells": cells,
        "agreement": sum((c["published"] is not None) == (c["probability"] >= 0.5) for c in cells),
    }


def transfer_rows(path: str | Path) -> list[dict[str, Any]]:
    """Return what is left on the task that was left out, by candidate (results/recovery/transfer.nc)."""
    with open_dataset(path) as data:
        left = read_variable(data, path, "mean_square")
        names, tasks = [str(n) for n in data["candidate"][:]], [str(t) for t in data["task"][:]]
    rows = [
        {
            "candidate": n,
            "mean": six_digits(row.mean()),
            "tasks": dict(zip(tasks, (six_digits(x) for x in row), strict=True)),
        }
        for n, row in zip(names, left, strict=True)
    ]
    return sorted(rows, key=lambda r: r["mean"])


def reproduced_cells(verdict: Mapping[str, Any]) -> dict[str, Any]:
    """Return the cells of Tables V and VI with their errors before and after, and the largest and middle error."""
    gap, cells = verdict["gap"], []
    for cell, before, after in zip(verdict["cells"], gap["nominal"], gap["augmented"], strict=True):
        published = cell["published_maximum"]
        cells.append(
            {
                **cell,
                "before_percent": 100 * before / published if published else None,
                "after_percent": 100 * after / published if published else None,
            }
        )
    error = np.array([c["after_percent"] for c in cells if c["after_percent"] is not None])
    before = np.array([c["before_percent"] for c in cells if c["before_percent"] is not None])
    variation = np.array(
        [abs(c["reproduced_variation"] - c["published_variation"]) for c in cells if c["published_maximum"] > 0]
    )
    return {
        "cells": cells,
        "median_percent": six_digits(np.median(error)),
        "worst_percent": six_digits(error.max()),
        "median_percent_before": six_digits(np.median(before)),
        "worst_percent_before": six_digits(before.max()),
        "median_variation": six_digits(np.median(variation)),
        "worst_variation": six_digits(variation.max()),
    }


def summarise_recovery(
    bound: str | Path,
    verdict: str | Path,
    comparison: str | Path,
    transfer: str | Path,
    ensemble: str | Path,
    prediction: str | Path,
    output: str | Path,
) -> None:
    """Write the chapter's results as JSON; the arguments before `output` are the results of `recover`."""
    found = read_json(verdict)
    content = {
        "bound": bound_summary(bound),
        "verdict": {k: v for k, v in found.items() if k not in ("cells", "gap")},
        "tables": reproduced_cells(found),
        "comparison": comparison_rows(comparison),
        "transfer": transfer_rows(transfer),
        "ensemble": ensemble_summary(ensemble),
        "prediction": prediction_summary(prediction),
    }
    write_json(output, content)


def summarise_validation_chapter(validation: str | Path, output: str | Path) -> None:
    """Write how often hidden causes were named rightly, as JSON, from results/recovery/validation.nc."""
    with open_dataset(validation) as data:
        right, needless = (read_variable(data, validation, name).astype(bool) for name in ("right", "needless"))
        cause, chosen = ([str(x) for x in data[name][:]] for name in ("cause", "chosen"))
    low, high = wilson_interval(int(right.sum()), len(right))
    answers = list(dict.fromkeys([*CAUSES, *sorted(chosen)]))
    content = {
        "cases": len(right),
        "right": int(right.sum()),
        "low": six_digits(low),
        "high": six_digits(high),
        "needless": int(needless.sum()),
        "answers": answers,
        "causes": [
            {
                "cause": name,
                "cases": cause.count(name),
                "right": int(sum(r for r, c in zip(right, cause, strict=True) if c == name)),
                "needless": int(sum(n for n, c in zip(needless, cause, strict=True) if c == name)),
                "chosen": {a: sum(c == name and k == a for c, k in zip(cause, chosen, strict=True)) for a in answers},
            }
            for name in CAUSES
        ],
    }
    write_json(output, content)
