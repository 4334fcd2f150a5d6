"""Read and check a task file; without numpy, because the Snakefile does it at every call."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError
from jointwear.files.schemas import check, normalise_numbers, read_schema
from jointwear.files.wording import count

HOUR = 3600.0


def read_task_file(path: str | Path, robot: dict[str, Any] | None = None) -> dict[str, Any]:
    """Read a task file and return it with waypoints in rad and every key present.

    Parameters
    ----------
    path : the task file.
    robot : content of a robot file; waypoints are checked against its joints and limits.

    Raises
    ------
    InputError : one line naming the file, the key, what is allowed and the nearest valid value.
    """
    path = Path(path)
    data = read_yaml(path)
    schema = read_schema("task")
    check(data, schema, path)
    data = {"unit": "rad", "phase": 0.0, "provenance": {}, **normalise_numbers(data, schema)}
    if data["name"] != path.stem:
        raise InputError(f"{path}: 'name' is '{data['name']}', must be '{path.stem}' like the file")
    if len(data["durations"]) != len(data["waypoints"]):
        raise InputError(
            f"{path}: 'durations' has {count(len(data['durations']), 'entry', 'entries')}, must have "
            f"{len(data['waypoints'])}: one for each waypoint, the last for the way back to the first"
        )
    cycle = sum(data["durations"])
    if cycle > HOUR * (1 + 1e-9) or abs(HOUR / cycle - round(HOUR / cycle)) > 1e-9:
        raise InputError(
            f"{path}: 'durations' add up to {cycle:g} s; a whole number of cycles must fit an hour; "
            f"the nearest valid value is {_nearest_cycle(cycle):.10g} s"
        )
    if data["phase"] >= cycle:
        raise InputError(f"{path}: 'phase' is {data['phase']}, must be below the cycle of {cycle} s")
    degrees = data["unit"] == "deg"
    if degrees:
        data["waypoints"] = [[math.radians(x) for x in pose] for pose in data["waypoints"]]
        data["unit"] = "rad"
    if robot is not None:
        _check_limits(path, data["waypoints"], robot, degrees)
    for i, pose in enumerate(data["waypoints"]):
        if len(pose) != len(data["waypoints"][0]):
            raise InputError(
                f"{path}: 'waypoints[{i}]' has {count(len(pose), 'position')}, 'waypoints[0]' has "
                f"{len(data['waypoints'][0])}"
            )
    return data


def _nearest_cycle(cycle: float) -> float:
    """Return the cycle [s] nearest to `cycle` that fits an hour and can be written down: in whole tenths of a ms."""
    hour, root = round(HOUR * 10_000), round(math.sqrt(HOUR * 10_000))
    small = [k for k in range(1, root + 1) if hour % k == 0]
    return min((k / 10_000 for k in [*small, *(hour // k for k in small)]), key=lambda x: abs(x - cycle))


def _check_limits(path: Path, waypoints: list[list[float]], robot: dict[str, Any], degrees: bool) -> None:
    joints = robot["joints"]
    unit, scale = ("deg", 180 / math.pi) if degrees else ("rad", 1.0)
    for i, pose in enumerate(waypoints):
        if len(pose) != len(joints):
            raise InputError(
                f"{path}: 'waypoints[{i}]' has {count(len(pose), 'position')}, robot '{robot['name']}' has "
                f"{count(len(joints), 'joint')}"
            )
        for j, (x, joint) in enumerate(zip(pose, joints, strict=True)):
            lower, upper = joint["limits"]
            if not lower - 1e-9 <= x <= upper + 1e-9:
                near = (lower if x < lower else upper) * scale
                raise InputError(
                    f"{path}: 'waypoints[{i}][{j}]' is {x * scale:g} {unit}, beyond the limits of {joint['name']} "
                    f"(allowed: {lower * scale:.6g} to {upper * scale:.6g} {unit}); "
                    f"the nearest valid value is {near:.6g}"
                )
