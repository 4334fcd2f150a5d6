"""Everything that the report says, as plain data: the same content makes the page and summary.json."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.documents import read_yaml
from jointwear.files.storage import read_variables
from jointwear.publishing.figures.curves import divergence_curves, friction_curves, residual_curves
from jointwear.publishing.report import detection_rates, drivers, figure_scores, torque_limits
from jointwear.publishing.report.result_tables import (
    score_design,
    score_detection,
    score_lags,
    score_values,
)
from jointwear.reproduction import readings
from jointwear.reproduction.grid import by_cell, cell_of
from jointwear.reproduction.published import HOURS, Published, load_published
from jointwear.reproduction.tables import read_table
from jointwear.robots.robot_file import read_robot_file

TABLES = ("table_ii", "table_iii", "table_iv", "table_v", "table_vi")


@dataclass(frozen=True)
class Results:
    """Files that the report reads.

    `tables` by name; `simulations`, `detections`, `locations`: worn runs; the `normal_` and `training_` files,
    `models` and task files (`tasks`) by task; `figure_run`: simulation, features, detection and task file of the run in
    Figures 1 to 3.
    """

    published: str
    robot: str
    tables: Mapping[str, str]
    simulations: Sequence[str]
    detections: Sequence[str]
    locations: Sequence[str]
    models: Mapping[str, str]
    tasks: Mapping[str, str]
    training_features: Mapping[str, str]
    training_simulations: Mapping[str, str]
    normal_simulations: Mapping[str, str]
    normal_detections: Mapping[str, str]
    normal_locations: Mapping[str, str]
    figure_run: Mapping[str, str] = field(default_factory=dict)

    def computed(self) -> list[str]:
        """Return every netCDF file among them."""
        by_name = (self.tables, self.models, self.training_features, self.training_simulations)
        normal = (self.normal_simulations, self.normal_detections, self.normal_locations)
        named = [path for files in (*by_name, *normal, self.figure_run) for path in files.values()]
        return sorted({p for p in (*self.simulations, *self.detections, *self.locations, *named) if p.endswith(".nc")})


def _figures(results: Results, printed: Published, replicate: int) -> dict[str, Any]:
    run = results.figure_run
    cell = cell_of(str(run["simulation"]))
    residuals = residual_curves(results.models[cell.task], run["detection"], replicate)
    same = cell == printed.lag_cell and residuals.hour[-1] >= HOURS
    kept = {task: read_variables(path, "kept")[0] for task, path in results.models.items()}
    return {
        "task": cell.task,
        "axis": cell.axis,
        "increase_percent": cell.increase_percent,
        "is_published_run": same,
        "friction": figure_scores.score_friction(
            friction_curves(run["simulation"], results.robot, run["task"], replicate), printed, same
        ),
        "divergence": figure_scores.score_divergence(divergence_curves(run["features"], replicate), printed, same),
        "onset": figure_scores.score_onset(residuals, printed, same),
        "residuals": figure_scores.score_residual_range(residuals, printed, same),
        "components": figure_scores.score_components(kept, printed),
    }


def _location(results: Results) -> dict[str, Any]:
    runs = detection_rates.locations(list(results.locations), list(results.detections))
    return {
        "runs": runs,
        "pooled": {name: detection_rates.pooled([r[name] for r in runs]) for name in detection_rates.RULES},
        "without_wear": detection_rates.located_without_wear(
            list(results.normal_locations.values()), [results.normal_detections[t] for t in results.normal_locations]
        ),
    }


def _detection(results: Results, config: Mapping[str, Any]) -> dict[str, Any]:
    rule, consecutive = config["reading"]["onset_rule"], config["detection"]["consecutive_hours"]
    runs = detection_rates.compare_statistics(list(results.detections))
    normal = {t: detection_rates.false_alarms(p, rule, consecutive) for t, p in results.normal_detections.items()}
    all_weeks = {
        name: detection_rates.pooled([n[name]["periods_with_alarm"] for n in normal.values()]) for name in ("q", "t2")
    }
    mean = {
        name: {
            what: float(np.mean([n[name][what]["mean"] for n in normal.values()]))
            for what in ("alarms_per_week", "hours_above_limit")
        }
        for name in ("q", "t2")
    }
    return {
        "runs": runs,
        "normal": normal,
        "normal_pooled": all_weeks,
        "normal_mean": mean,
        "without_residual": detection_rates.models_without_residual(results.models),
    }


def _drivers(results: Results, printed: Published, seed: int) -> dict[str, Any]:
    by_cell_predictors = drivers.predictors(dict(results.training_features), list(results.simulations))
    onsets = {cell: read_variables(path, "onset")[0] for cell, path in by_cell(list(results.detections)).items()}
    return {
        "measured": drivers.measured_drivers(by_cell_predictors, onsets, seed),
        "published": drivers.published_drivers(printed, seed),
        "cells": [
            {"task": c.task, "axis": c.axis, "increase_percent": c.increase_percent, **values}
            for c, values in by_cell_predictors.items()
        ],
    }


def assumptions(chosen: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return every ambiguity of the paper's text: question, quote, what was chosen, what else could be.

    Parameters
    ----------
    chosen : `reading` of the config.
    """

    def meaning(function: Any) -> str:
        return " ".join((function.__doc__ or "").split())

    order = ("training", "simulation", "features", "detection", "location")
    entries = [
        {
            "name": a.name,
            "question": a.question,
            "paper": a.paper,
            "stage": a.stage,
            "default": a.default,
            "chosen": chosen[a.name],
            "meaning": meaning(a.alternatives[chosen[a.name]]),
            "others": [{"name": n, "meaning": meaning(f)} for n, f in a.alternatives.items() if n != chosen[a.name]],
        }
        for a in readings.ambiguities().values()
    ]
    return sorted(entries, key=lambda e: (order.index(e["stage"]) if e["stage"] in order else len(order), e["name"]))


def paper_facts(printed: Published) -> dict[str, Any]:
    """Return what the paper's own tables say where its text says something else."""
    hours, torque = printed.data["table_iv_detection_hours"], printed.data["table_v_max_abs_torque_nm"]
    detected = {
        task: {growth: sum(v is not None for v in row) for growth, row in columns.items()}
        for task, columns in hours.items()
    }
    every = [h for columns in hours.values() for row in columns.values() for h in row if h is not None]
    first = {task: columns[20][0] - columns[10][0] for task, columns in torque.items()}
    return {
        "detected": detected,
        "detected_total": len(every),
        "runs": sum(len(row) for columns in hours.values() for row in columns.values()),
        "within_three_days": sum(h <= 72 for h in every),
        "axis_1_torque_change": first,
    }


def _recovered(content: Mapping[str, Any]) -> bool:
    """Return whether a robot or task file was recovered from the paper's tables: it names its source in these words."""
    return "Tables V and VI" in str(content.get("provenance", {}).get("source", ""))


def assemble(results: Results, config: Mapping[str, Any]) -> dict[str, Any]:
    """Return all results of the report as dicts, lists, numbers and text.

    Parameters
    ----------
    results : the files to read.
    config : the part of the configuration that the reproduction uses.

    Raises
    ------
    InputError : naming the file, if one is missing or corrupt.
    """
    printed, replicate = load_published(results.published), config["report"]["replicate"]
    rows = {name: read_table(results.tables[name]) for name in TABLES}
    scores = {
        "table_ii": score_lags(rows["table_ii"]),
        "table_iii": score_design(rows["table_iii"], printed.data["table_iii_design"]),
        "table_iv": score_detection(rows["table_iv"]),
        "table_v": score_values(rows["table_v"], relative=True),
        "table_vi": score_values(rows["table_vi"], relative=False),
    }
    robot = read_robot_file(results.robot)
    limits = torque_limits.limit_use(
        [
            *results.simulations,
            *results.training_simulations.values(),
            *results.normal_simulations.values(),
        ]
    )
    return {
        "rows": rows,
        "scores": scores,
        "figures": _figures(results, printed, replicate),
        "location": _location(results),
        "detection": _detection(results, config),
        "drivers": _drivers(results, printed, config["seed"]),
        "limits": limits,
        "robot": {
            "name": robot["name"],
            "axes": len(robot["joints"]),
            "payload": robot.get("payload"),
            "limits": [j["torque_limit"] for j in robot["joints"]],
            "provenance": robot.get("provenance", {}),
            "fitted": {
                "payload": _recovered(robot),
                "poses": [task for task, path in results.tasks.items() if _recovered(read_yaml(path))],
                "tasks": list(results.tasks),
            },
        },
        "assumptions": assumptions(config["reading"]),
        "paper": paper_facts(printed),
        "config": dict(config),
        "config_digest": provenance.settings_digest(dict(config)),
    }
