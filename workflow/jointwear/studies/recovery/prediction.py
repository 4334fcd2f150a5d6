"""Predict Table IV from pose sets that were fitted to Tables V and VI alone, the hours unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.reproduction.detection import onset, score
from jointwear.reproduction.features import build_reference, hourly_features
from jointwear.reproduction.normal_model import fit_normal_model
from jointwear.reproduction.readings import pca_input, select
from jointwear.reproduction.simulation import Noise, RepeatedTask
from jointwear.reproduction.wear import Wear
from jointwear.reproduction.worn_run import coulomb_levels
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, Robot, load_robot
from jointwear.robots.trajectory import Task
from jointwear.statistics.randomness import generator
from jointwear.studies.recovery.sampled_motion import CYCLE
from jointwear.studies.recovery.tables import Tables, read_tables

# (dynamics, task, wear shape, random numbers) -> hours of onset (n, c, r), NaN where nothing was detected.
Detect = Callable[[Dynamics, Task, float, np.random.Generator], np.ndarray]


@dataclass(frozen=True)
class Agreement:
    """How well detection probabilities agree with a table of detected and undetected cells.

    `plain`: share of cells on the right side of 1/2; `balanced`: mean of that over detected and undetected cells;
    `brier`: mean squared difference of probability and outcome; `base_brier`: of a forecast that
    says the share of detected cells everywhere; `hour_error`: median over detected cells [h].
    """

    plain: float
    balanced: float
    brier: float
    base_brier: float
    hour_error: float


def agreement(probability: np.ndarray, hour: np.ndarray, published: np.ndarray) -> Agreement:
    """Compare detection probabilities and median hours (t, n, c) with Table IV (NaN: not detected)."""
    truth = ~np.isnan(published)
    right = (probability > 0.5) == truth
    error = np.abs(hour - published)[truth & np.isfinite(hour)]
    base = truth.mean()
    return Agreement(
        float(right.mean()),
        float((right[truth].mean() + right[~truth].mean()) / 2),
        float(((probability - truth) ** 2).mean()),
        float(((base - truth) ** 2).mean()),
        float(np.median(error)) if len(error) else np.nan,
    )


def detector(tables: Tables, settings: Mapping[str, Any]) -> Detect:
    """Return a function that simulates one task with wear of every axis and detects it as the workflow does.

    Parameters
    ----------
    settings : `replicates`, `training_hours`, `noise` (without reading), `reading`, `bins`, `confidence`,
        `variance_share`, `consecutive_hours`.
    """
    reading = settings["reading"]
    noise = Noise(**settings["noise"], reading=reading)
    choose = select(pca_input, reading["pca_input"])
    hours = np.arange(1, int(tables.run_hours) + 1)

    def measured(dynamics, task, random, run_hours, axis=None, wear=None) -> np.ndarray:
        run = RepeatedTask(dynamics, task, coulomb_levels(dynamics, run_hours, axis, wear), noise)
        return np.stack([run.measure(random) for _ in range(settings["replicates"])])

    def detect(dynamics: Dynamics, task: Task, shape: float, random: np.random.Generator) -> np.ndarray:
        normal = measured(dynamics, task, random, np.arange(1, settings["training_hours"] + 1))
        reference = build_reference(normal, settings["bins"], reading)
        series = choose(hourly_features(normal, reference, settings["bins"], reading))
        model = fit_normal_model(series, settings["confidence"], settings["variance_share"], reading)
        result = np.empty((dynamics.robot.joints, len(tables.increase_percent), settings["replicates"]))
        for axis in range(1, dynamics.robot.joints + 1):
            for c, increase in enumerate(tables.increase_percent):
                worn = Wear(float(increase), shape, tables.run_hours)
                torque = measured(dynamics, task, random, hours, axis, worn)
                features = hourly_features(torque, reference, settings["bins"], reading)
                q, _ = score(choose(features), model)
                above = q > model.q_limit[:, None]
                result[axis - 1, c] = onset(above, reading["onset_rule"], settings["consecutive_hours"])
        return result

    return detect


def loaded(robot: Robot, names: list[str], values: np.ndarray) -> Robot:
    """Return the robot with the payload of one solution."""
    value = dict(zip(names, values, strict=True))
    com = np.array([value["com_x"], value["com_y"], value["com_z"]])
    return replace(robot, payload=Link(float(value["mass"]), com, np.zeros((3, 3))))


def predict_detection(
    robot: str | Path, published: str | Path, ensemble: str | Path, output: str | Path, settings: dict[str, Any]
) -> None:
    """Predict Table IV as probabilities over all solutions and replicates and compare it with the paper.

    Parameters
    ----------
    robot : the unloaded arm; published : file of the published values.
    ensemble : solutions that were found with the hours unknown.
    output : netCDF file.
    settings : `seed`, `shape_range` from which the wear shape is drawn anew for every solution, and what
        :func:`detector` takes.
    """
    arm, tables = load_robot(robot), read_tables(published)
    detect = detector(tables, settings)
    with open_dataset(ensemble) as data:
        start, stop, phase, effect, outward = (
            read_variable(data, ensemble, n) for n in ("start", "stop", "phase", "effect", "outward")
        )
        names = [str(n) for n in data["parameter"][:]]
    count = len(start)
    low, high = settings["shape_range"]
    onset = np.empty((count, *tables.maximum.shape, settings["replicates"]))
    for s in range(count):
        random = generator(settings["seed"], "predict", replicate=s)
        dynamics, shape = Dynamics(loaded(arm, names, effect[s])), float(random.uniform(low, high))
        for t, name in enumerate(tables.tasks):
            ways = np.array([outward[t], CYCLE - outward[t]])
            task = Task(name, np.stack([start[s, t], stop[s, t]]), ways, float(phase[s, t]))
            onset[s, t] = detect(dynamics, task, shape, random)
    detected = np.isfinite(onset)
    probability = detected.mean(axis=(0, -1))
    middle = np.full(probability.shape, np.nan)
    for place in np.ndindex(probability.shape):
        own = onset[:, *place, :]
        if np.isfinite(own).any():
            middle[place] = np.nanmedian(own)
    by_set = detected.mean(axis=-1)
    cell = ("task", "axis", "increase")
    score_ = agreement(probability, middle, tables.hours)
    variables = {
        "task": Variable(("task",), np.array(tables.tasks), "task"),
        "axis": Variable(("axis",), np.arange(1, arm.joints + 1), "axis of the robot", "1"),
        "increase": Variable(("increase",), tables.increase_percent, "growth of the friction", "percent"),
        "probability": Variable(cell, probability, "probability that wear is detected", "1"),
        "probability_low": Variable(cell, np.quantile(by_set, 0.05, axis=0), "5 % quantile over pose sets", "1"),
        "probability_high": Variable(cell, np.quantile(by_set, 0.95, axis=0), "95 % quantile over pose sets", "1"),
        "hour": Variable(cell, middle, "median hour of detection, NaN if never", "h"),
        "published": Variable(cell, tables.hours, "hour in Table IV, NaN if not detected", "h"),
    }
    attributes = provenance.attributes("Table IV predicted from Tables V and VI", settings)
    attributes |= {k: float(getattr(score_, k)) for k in Agreement.__dataclass_fields__}
    write_dataset(output, variables, attributes)
