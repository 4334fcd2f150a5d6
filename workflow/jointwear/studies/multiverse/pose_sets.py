"""Robot and tasks of one pose set: the experiment of the config, or a solution of the recovery's ensemble."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.storage import open_dataset, read_variable
from jointwear.files.wording import count
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, Robot, load_robot
from jointwear.robots.trajectory import Task, load_task
from jointwear.studies.recovery.sampled_motion import CYCLE


@dataclass(frozen=True)
class PoseSet:
    """One robot with its tasks; `name` and the task names key the random numbers."""

    name: str
    dynamics: Dynamics
    tasks: tuple[Task, ...]


def configured_pose_set(robot: str | Path, tasks: Sequence[str | Path]) -> PoseSet:
    """Return the pose set of ordinary robot and task files.

    Raises
    ------
    InputError : if the robot has effects, which the shared simulation does not know.
    """
    loaded = load_robot(robot)
    if loaded.effects:
        raise InputError(f"{robot}: has effects; the multiverse is about the paper's robot, which has none")
    return PoseSet("configured", Dynamics(loaded), tuple(load_task(path) for path in tasks))


def with_payload(robot: Robot, mass: float, com: Sequence[float]) -> Robot:
    """Return the robot with a point payload of `mass` [kg] at `com` (3,) [m] in the last link frame."""
    return replace(
        robot, payload=Link(float(mass), np.asarray(com, dtype=float), np.zeros((3, 3))) if mass > 0 else None
    )


def ensemble_size(path: str | Path) -> int:
    """Return the number of solutions in an ensemble."""
    with open_dataset(path) as dataset:
        return int(dataset.dimensions["solution"].size)


def ensemble_pose_sets(path: str | Path, unloaded: str | Path, chosen: Sequence[int]) -> list[PoseSet]:
    """Return pose sets of the ensemble that the recovery stage wrote.

    Parameters
    ----------
    path : netCDF file of :func:`jointwear.studies.recovery.ensemble.write_ensemble`; every task goes from start to stop
        and back within one cycle.
    unloaded : robot file of the arm without payload.
    chosen : 0-based solutions.

    Raises
    ------
    InputError : if the recovered cause is not a payload, or there are not so many solutions.
    """
    with open_dataset(path) as dataset:
        names = [str(v) for v in read_variable(dataset, path, "parameter")]
        tasks = [str(v) for v in read_variable(dataset, path, "task")]
        values = {k: read_variable(dataset, path, k) for k in ("start", "stop", "phase", "outward", "effect")}
    wanted = ["mass", "com_x", "com_y", "com_z"]
    if any(name not in names for name in wanted):
        raise InputError(f"{path}: its solutions have {', '.join(names)}; pose sets need {', '.join(wanted)}")
    if max(chosen, default=-1) >= len(values["start"]):
        raise InputError(f"{path}: has {count(len(values['start']), 'solution')}, {max(chosen) + 1} are asked for")
    robot = load_robot(unloaded)
    result = []
    for k in chosen:
        mass, *com = (float(values["effect"][k, names.index(name)]) for name in wanted)
        motions = []
        for t, task in enumerate(tasks):
            out = float(values["outward"][t])
            waypoints = np.stack([values["start"][k, t], values["stop"][k, t]])
            motions.append(Task(task, waypoints, np.array([out, CYCLE - out]), float(values["phase"][k, t])))
        result.append(PoseSet(f"solution_{k + 1}", Dynamics(with_payload(robot, mass, com)), tuple(motions)))
    return result


def configured_solution(poses: Sequence[PoseSet], configured: Sequence[str | Path]) -> int | None:
    """Return which pose set the configured tasks are, None if none of them; files round to 0.001 degrees."""
    wanted = [load_task(path).waypoints for path in configured]
    for k, one in enumerate(poses):
        if all(
            a.waypoints.shape == b.shape and np.allclose(a.waypoints, b, atol=1e-4)
            for a, b in zip(one.tasks, wanted, strict=True)
        ):
            return k
    return None
