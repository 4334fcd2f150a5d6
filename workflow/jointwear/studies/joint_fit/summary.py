"""The numbers of the joint fit for the report's chapter, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import write_json
from jointwear.files.storage import open_dataset, read_variable
from jointwear.robots.robot import load_robot
from jointwear.studies.joint_fit.detection import READINGS
from jointwear.studies.joint_fit.paper import Paper, read_paper
from jointwear.studies.joint_fit.posterior import Scores, nearest, read_confirmed, score

# What the joint fit is to reach on random numbers that took no part: name of the score, limits, unit.
AIMS = {
    "cells": (32.0, 36.0, "of 36"),
    "hour_error": (0.0, 8.0, "h"),
    "torque_median": (0.0, 0.01, "share"),
    "torque_worst": (0.0, 0.06, "share"),
    "variation_median": (0.0, 0.01, "1"),
    "variation_worst": (0.0, 0.04, "1"),
    "signs": (11.0, 15.0, "of 15"),
    "kl": (8.0, 12.0, "nat"),
}
MOMENT_TOLERANCE = 0.15


def _quantiles(values: np.ndarray) -> dict[str, float]:
    return dict(zip(("low", "middle", "high"), np.quantile(values, [0.05, 0.5, 0.95]), strict=True))


def _aims(scores: Scores, kept: np.ndarray) -> list[dict[str, Any]]:
    result = []
    for name, (low, high, unit) in AIMS.items():
        values = getattr(scores, name)
        met = (values >= low) & (values <= high)
        result.append(
            {
                "name": name,
                "low": low,
                "high": high,
                "unit": unit,
                "nearest": values[kept[0]],
                "all": _quantiles(values[kept]),
                "met": int(met[kept].sum()),
                "best": values[kept].max() if name in ("cells", "signs") else values[kept].min(),
            }
        )
    return result


def _cells(found: dict[str, np.ndarray], paper: Paper, kept: np.ndarray) -> list[dict[str, Any]]:
    """Table IV cell by cell: the nearest experiment, and how many of those kept agree."""
    hours = paper.tables.hours.swapaxes(1, 2)
    wanted = np.isfinite(hours)
    right = (found["probability"][kept] >= 0.5) == wanted
    late = found["hour"][kept] - hours
    maximum = found["maximum"][kept, 0] / np.where(paper.tables.maximum > 0, paper.tables.maximum, np.nan).swapaxes(
        1, 2
    )
    result = []
    for t, c, a in np.ndindex(wanted.shape):
        off = late[:, t, c, a][np.isfinite(late[:, t, c, a])]
        result.append(
            {
                "task": t + 1,
                "column": c + 1,
                "increase": paper.tables.increase_percent[c],
                "axis": a + 1,
                "published": hours[t, c, a],
                "probability": found["probability"][kept[0], t, c, a],
                "hour": found["hour"][kept[0], t, c, a],
                "agree": int(right[:, t, c, a].sum()),
                "agrees": bool(right[0, t, c, a]),
                "smallest_hour_error": np.abs(off).min() if len(off) else None,
                "median_hour_error": np.median(off) if len(off) else None,
                "torque": [maximum[:, t, c, a].min() - 1, maximum[:, t, c, a].max() - 1],
                "lowest_probability": found["probability"][kept, t, c, a].min(),
                "highest_probability": found["probability"][kept, t, c, a].max(),
            }
        )
    return result


def contradictions(found: dict[str, np.ndarray], paper: Paper, kept: np.ndarray) -> dict[str, Any]:
    """What the paper contradicts itself in, measured on the experiments that are kept.

    `axis_1`: growth of Table V between the columns of T1 and of T2 [N m], printed and ours (range): same hours, same
    axis, same friction. `task_3`: cells of T3 axis 1.
    """
    tables = paper.tables
    printed = tables.maximum[:2, 0, 1] - tables.maximum[:2, 0, 0]
    ours = found["maximum"][kept, 0][:, :2, 1, 0] - found["maximum"][kept, 0][:, :2, 0, 0]
    return {
        "axis_1": [
            {"task": t + 1, "printed": printed[t], "low": ours[:, t].min(), "high": ours[:, t].max()} for t in range(2)
        ]
    }


def controls(paths: Sequence[str | Path]) -> dict[str, Any]:
    """Return the controls by kind, and what those of known origin recovered."""
    rows = []
    for path in paths:
        with open_dataset(path) as data:
            names = [n for n in data.ncattrs() if n in _CONTROL_NUMBERS or n.startswith(("reading_", "true_reading_"))]
            rows.append({"kind": str(data.kind), **{n: data.getncattr(n) for n in names}})
    result: dict[str, Any] = {"rows": rows}
    for kind in dict.fromkeys(r["kind"] for r in rows):
        own = [r for r in rows if r["kind"] == kind]
        result[kind] = {
            "papers": len(own),
            **{k: [float(r[k]) for r in own] for k in ("cells", "hour_error", "distance")},
        }
    known = [r for r in rows if r["kind"] == "known"]
    if known:
        fields = ("scaling", "components")
        right = [all(r[f"reading_{f}"] == r[f"true_reading_{f}"] for f in fields) for r in known]
        hours = [r["reading_consecutive_hours"] == r["true_reading_consecutive_hours"] for r in known]
        error = np.array([float(r["moment"]) / float(r["true_moment"]) - 1 for r in known])
        result["known"] |= {
            "moment_error": error,
            "moment_within": int((np.abs(error) <= MOMENT_TOLERANCE).sum()),
            "moment_median_error": np.median(np.abs(error)),
            "reading_right": int(sum(right)),
            "reading_right_with_hours": int(sum(a and b for a, b in zip(right, hours, strict=True))),
        }
    return result


_CONTROL_NUMBERS = ("cells", "hour_error", "distance", "moment", "shape", "true_moment", "true_shape")


def readings(path: str | Path) -> dict[str, Any]:
    """Return the readings before the local search, best first, and the payloads that Tables V and VI gave."""
    with open_dataset(path) as data:
        cost, agreement = (read_variable(data, path, n).astype(float) for n in ("cost", "agreement"))
        fitted = read_variable(data, path, "fitted_moment"), read_variable(data, path, "fitted_evidence")
        chosen = int(data.chosen_reading)
        arms = len(read_variable(data, path, "mass"))
    order = np.argsort(cost.mean(axis=0))
    return {
        "arms": arms,
        "screened": len(cost),
        "fitted_moment": fitted[0],
        "fitted_evidence": fitted[1],
        "chosen": vars(READINGS[chosen]),
        "ranked": [
            {
                **vars(READINGS[k]),
                "cost": cost[:, k].mean(),
                "cells": agreement[:, k].mean(),
                "most_cells": agreement[:, k].max(),
            }
            for k in order
        ],
    }


def write_chapter(
    robot: str | Path,
    published: str | Path,
    screened: str | Path,
    confirmed: Sequence[str | Path],
    checked: str | Path,
    output: str | Path,
    kept: int,
) -> None:
    """Write everything that the chapter says as JSON.

    Parameters
    ----------
    robot : arm with torque limits; kept : how many experiments make the posterior.
    """
    paper = read_paper(published)
    experiments, found = read_confirmed(confirmed)
    order = nearest(found["distance"], kept)
    scores = score(found, paper)
    _, once_more = read_confirmed([checked])
    again, again_own = score(once_more, paper), score(once_more, paper, at=1)
    limit = load_robot(robot).torque_limit
    moment = np.array([e.arm.moment for e in experiments])
    shape = np.array([e.arm.shape for e in experiments])
    best = experiments[order[0]]
    cells = _cells(found, paper, order)
    missing = [c for c in cells if c["agree"] == 0]
    checks = [
        {
            "name": name,
            "value": getattr(again, name)[0],
            "own_hours": getattr(again_own, name)[0],
            "low": low,
            "high": high,
            "unit": unit,
            "met": bool(low <= getattr(again, name)[0] <= high),
        }
        for name, (low, high, unit) in AIMS.items()
    ]
    content = {
        "experiments": len(experiments),
        "kept": len(order),
        "reading": vars(best.reading),
        "arm": {"mass": best.arm.mass, "offset": best.arm.offset, "moment": best.arm.moment, "shape": best.arm.shape},
        "moment": _quantiles(moment[order]),
        "shape": _quantiles(shape[order]),
        "aims": _aims(scores, order),
        "checks": checks,
        "met": all(c["met"] for c in checks),
        "check": {
            "replicates": once_more["signs"].shape[1],
            "signs_at_least_11": float((once_more["signs"] >= 11).mean()),
            "located": once_more["located"][0],
            "alarms": once_more["alarms"][0],
            "components": [once_more["kept"].min(), once_more["kept"].max()],
            "figure_3": again.figure_3[0],
            "highest_load": float((once_more["maximum"][0, 0].max(axis=(0, 1)) / limit).max()),
            "cells": _cells(once_more, paper, np.array([0])),
        },
        "figure_3": _quantiles(scores.figure_3[order][np.isfinite(scores.figure_3[order])]),
        "cells": cells,
        "missing": missing,
        "contradictions": contradictions(found, paper, order),
        "frontier": [
            {
                "moment": moment[k],
                "shape": shape[k],
                "cells": scores.cells[k],
                "hour_error": scores.hour_error[k],
                "distance": found["distance"][k],
                "kept": bool(k in order),
            }
            for k in range(len(experiments))
        ],
        "readings": readings(screened),
    }
    write_json(output, content)


def write_controls(paths: Sequence[str | Path], output: str | Path) -> None:
    """Write what the chapter of the controls says as JSON."""
    write_json(output, controls(paths))
