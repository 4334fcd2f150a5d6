"""The monitor's judgement, as a user calls it, on runs of the paper's grid: the 120 normal hours, then 120 worn ones.

One replicate of a run is one robot: its training hours are the baseline, the hours of a worn (or normal) run follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.json_documents import write_json
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.judge_settings import settings_of
from jointwear.monitor.reading.accumulate import Samples, WindowSettings, window_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.reproduction.grid import worn_runs
from jointwear.robots.robot import Robot, load_robot
from jointwear.robots.trajectory import Motion, load_task
from jointwear.studies.monitor_study.runs import DEAD_BAND, read_torque

#: Stated rate [false alarms per 1,000 h], that of the study's tables; runs judged of every cell.
RATE, REPLICATES = 0.3, 10
HOUR = 3600.0


def hours_as_windows(robot: Robot, motion: Motion, torque: np.ndarray) -> WindowStatistics:
    """Return the window statistics of hours of the same motion; torque (h, s, n) [N m]."""
    h, s, n = torque.shape
    one = TorqueModel(robot)(motion.position, motion.velocity, motion.acceleration)
    settings = WindowSettings(
        HOUR, np.full(n, DEAD_BAND), np.maximum(np.abs(torque).max(axis=(0, 1)), 1e-9), guard=0, block=4 * _step(motion)
    )

    def repeated(values: np.ndarray) -> np.ndarray:
        return np.tile(values, (h, 1))

    hour = np.repeat(np.arange(h), s)
    samples = Samples(
        HOUR * hour + np.tile(motion.time, h),
        repeated(motion.position),
        repeated(motion.velocity),
        torque.reshape(h * s, n),
        type(one)(repeated(one.total), repeated(one.gravity), repeated(one.inertial)),
        stretch=hour,
    )
    return window_statistics(samples, settings)


def _step(motion: Motion) -> float:
    return float(motion.time[1] - motion.time[0])


def judge_grid(
    robot: str | Path, task: str | Path, runs: Sequence[str], output: str | Path, settings: Mapping[str, Any]
) -> None:
    """Judge the first replicates of every worn run and of the normal run of a task; write what came out as JSON.

    Parameters
    ----------
    runs : files of the simulation: training, normal and worn runs. settings : `interval`, `samples` of an hour.
    """
    arm, motion = load_robot(robot), load_task(task).samples(settings["interval"], settings["samples"])
    limits = settings_of(arm, {"false_alarms_per_1000_h": RATE})
    part = slice(0, REPLICATES)
    named = {Path(p).stem: p for p in runs}
    training = read_torque(named["training"], part)

    def alarms(path: str | Path) -> list[list[dict[str, Any]]]:
        found = []
        for first, then in zip(training, read_torque(path, part), strict=True):
            statistics = hours_as_windows(arm, motion, np.concatenate([first, then]))
            told = judge(statistics, len(first), limits).alarms
            found.append([a for a in told if a["detector"] == "model"])
        return found

    def hour_of(alarm: Mapping[str, Any]) -> float:
        return alarm["time"] / HOUR - training.shape[1]

    cells = []
    for cell, path in sorted(worn_runs(runs).items()):
        told = [sorted(a, key=lambda x: x["time"]) for a in alarms(path)]
        right = [next((hour_of(x) for x in a if x["axis"] == cell.axis), None) for a in told]
        found = [h for h in right if h is not None]
        cells.append(
            {
                "axis": cell.axis,
                "increase": cell.increase_percent,
                "moves": bool((np.abs(motion.velocity[:, cell.axis - 1]) > DEAD_BAND).any()),
                "runs": len(told),
                "detected": len(found),
                "named": sum(bool(a) and a[0]["axis"] == cell.axis for a in told),
                "hour": float(np.median(found)) if found else None,
            }
        )
    normal = alarms(named["normal"])
    hours = len(normal) * read_torque(named["normal"], slice(0, 1)).shape[1]
    result = {"cells": cells, "false": sum(len(a) for a in normal), "hours": hours, "rate": RATE}
    write_json(output, result)
