"""Write what was recovered as ordinary robot and task files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from jointwear.files.storage import open_dataset, read_variable
from jointwear.robots.robot_file import read_robot_file
from jointwear.studies.recovery.sampled_motion import CYCLE

#: Cost above the least (half a sum of squares) up to which a solution fits as well.
SLACK = 5.0
_SOURCE = "recovered from Tables V and VI of the paper, whose text gives no poses"


class _Dumper(yaml.SafeDumper):
    """Lists of numbers on one line."""


def _sequence(dumper: yaml.SafeDumper, data: list) -> yaml.Node:
    flow = all(isinstance(x, (int, float)) for x in data)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", data, flow_style=flow)


_Dumper.add_representer(list, _sequence)


def write_yaml(path: str | Path, data: dict[str, Any]) -> None:
    """Write a mapping with its keys in their order."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120), encoding="utf-8")


def robot_data(unloaded: str | Path, names: Sequence[str], values: Sequence[float], name: str) -> dict[str, Any]:
    """Return the content of the robot file of the recovered arm.

    Parameters
    ----------
    unloaded : robot file of the unloaded arm.
    names, values : `mass` [kg], `com_x`, `com_y`, `com_z` [m] of the payload.
    name : name of the recovered arm.
    """
    data = read_robot_file(unloaded)
    value = dict(zip(names, values, strict=True))
    com = [round(float(value[f"com_{x}"]), 5) + 0.0 for x in "xyz"]  # + 0.0 turns -0.0 into 0.0
    return {
        **data,
        "name": name,
        "payload": {"mass": round(float(value["mass"]), 4), "com": com},
        "effects": [],
        "provenance": {
            "source": f"{data.get('provenance', {}).get('source', unloaded)}; payload {_SOURCE}",
            "note": "The paper never mentions a payload, but its torques are out of reach without one. "
            "Mass and offset are not determined one by one; other payloads fit nearly as well.",
        },
    }


def task_data(name: str, start: np.ndarray, stop: np.ndarray, outward: float, phase: float) -> dict[str, Any]:
    """Return the content of a task file: there and back, positions (n,) [rad], times [s]."""
    return {
        "name": name,
        "unit": "deg",
        "waypoints": [[round(float(x), 3) for x in np.degrees(pose)] for pose in (start, stop)],
        "durations": [float(outward), float(CYCLE - outward)],
        "phase": round(float(phase), 4),
        "provenance": {
            "source": _SOURCE,
            "note": "One solution of many; the positions of axis 1 are arbitrary but for their difference.",
        },
    }


def typical_solution(cost: np.ndarray, parameters: np.ndarray) -> int:
    """Return the position of the solution that stands for all.

    Among solutions that fit as well as the best, which one is best is chance. The one is taken whose parameters lie
    nearest to the medians over all solutions, in units of their spread.

    Parameters
    ----------
    cost : (S,); solutions within :data:`SLACK` of the least count as equally good (half a sum of squares).
    parameters : (S, p) what is common to the tasks, such as the wear shape and the payload.
    """
    spread = parameters.std(axis=0)
    scaled = (parameters - np.median(parameters, axis=0)) / np.where(spread > 0, spread, 1.0)
    away = (scaled**2).sum(axis=1)
    return int(np.argmin(np.where(cost <= cost.min() + SLACK, away, np.inf)))


def export_experiment(
    unloaded: str | Path, ensemble: str | Path, robot: str | Path, task_files: Sequence[str | Path], wear: str | Path
) -> None:
    """Write the typical solution of an ensemble as robot file and task files, rounded to what their values mean.

    Parameters
    ----------
    unloaded : robot file of the unloaded arm.
    ensemble : solutions with a payload.
    robot, task_files : files to write, one for every task of the ensemble in its order.
    wear : file to write with the wear shape, laid out as a part of config.yaml.
    """
    with open_dataset(ensemble) as data:
        names = [str(n) for n in data["parameter"][:]]
        cost, shape, effects = (read_variable(data, ensemble, n) for n in ("cost", "shape", "effect"))
        mass, z = effects[:, names.index("mass")], effects[:, names.index("com_z")]
        best = typical_solution(cost, np.column_stack([shape, mass, mass * z]))
        start, stop, phase, effect = (
            read_variable(data, ensemble, n, best) for n in ("start", "stop", "phase", "effect")
        )
        outward = read_variable(data, ensemble, "outward")
        tasks = [str(n) for n in data["task"][:]]
    write_yaml(wear, {"wear": {"shape": round(float(shape[best]), 3)}})
    write_yaml(robot, robot_data(unloaded, names, effect, "puma560_paper"))
    for k, (name, path) in enumerate(zip(tasks, task_files, strict=True)):
        write_yaml(path, task_data(name, start[k], stop[k], outward[k], phase[k]))
