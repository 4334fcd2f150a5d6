"""The results of the joint fit for the report's chapter, as plain data."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import write_json
from jointwear.files.storage import open_dataset, read_variable
from jointwear.robots.robot import load_robot
from jointwear.studies.joint_fit.detection import READINGS
from jointwear.studies.joint_fit.paper import LAG_RUN, Paper, read_paper
from jointwear.studies.joint_fit.posterior import nearest, read_confirmed
from jointwear.studies.joint_fit.scores import AIMS, Scores, aims_met, score


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


def pairs(right: np.ndarray, paper: Paper) -> dict[str, dict[str, Any]]:
    """Return how often the pairs of Table II come out as printed, (pairs,) shares of runs, by kind of pair.

    `worn`: with the worn axis; `tied`, `apart`: without it, printed as zero and as another lag. Series without wear
    are as likely to lead as to trail, so that each pair of the last kind is right in at most half of the runs.
    """
    n = len(paper.lag_sign)
    i, j = np.triu_indices(n, 1)
    zero = paper.lag_sign[i, j] == 0
    worn = (i == LAG_RUN[1]) | (j == LAG_RUN[1])
    kinds = {"worn": worn, "tied": ~worn & zero, "apart": ~worn & ~zero}
    return {
        name: {"count": int(of.sum()), "right": right[of].sum(), "lowest": right[of].min(), "highest": right[of].max()}
        for name, of in kinds.items()
    }


def searched_on(path: str | Path, paper: Paper) -> list[dict[str, Any]]:
    """Return the experiments under other weights: factors on the weights and what they reach on new random numbers."""
    _, fields = read_confirmed([path])
    with open_dataset(path) as data:
        tables, signs, torque = (
            read_variable(data, path, f"emphasis_{name}") for name in ("tables", "signs", "torque")
        )
    scores, met = score(fields, paper), aims_met(score(fields, paper))
    return [
        {
            "tables": tables[k],
            "torque": torque[k],
            "signs_weight": signs[k],
            "cells": scores.cells[k],
            "hour_error": scores.hour_error[k],
            "torque_median": scores.torque_median[k],
            "variation_median": scores.variation_median[k],
            "signs": fields["signs"][k].mean(),
            "signs_at_least_11": (fields["signs"][k] >= 11).mean(),
            "met": met[k],
        }
        for k in range(len(met))
    ]


def write_chapter(
    robot: str | Path,
    published: str | Path,
    screened: str | Path,
    confirmed: str | Path,
    traded: str | Path,
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
    experiments, fields = read_confirmed([confirmed])
    order = nearest(fields["distance"], kept)
    scores = score(fields, paper)
    (best,), once_more = read_confirmed([checked])
    again, again_own = score(once_more, paper), score(once_more, paper, at=1)
    limit = load_robot(robot).torque_limit
    moment = np.array([e.arm.moment for e in experiments])
    shape = np.array([e.arm.shape for e in experiments])
    cells = _cells(fields, paper, order)
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
        "searched_on": searched_on(traded, paper),
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
            "pairs": pairs(once_more["right_pairs"][0], paper),
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
        "contradictions": contradictions(fields, paper, order),
        "frontier": [
            {
                "moment": moment[k],
                "shape": shape[k],
                "cells": scores.cells[k],
                "hour_error": scores.hour_error[k],
                "torque_median": scores.torque_median[k],
                "signs": fields["signs"][k].mean(),
                "distance": fields["distance"][k],
                "kept": bool(k in order),
            }
            for k in range(len(experiments))
        ],
        "readings": readings(screened),
    }
    write_json(output, content)
