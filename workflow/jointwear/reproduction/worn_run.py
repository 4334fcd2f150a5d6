"""Simulation of a run in which the Coulomb friction of one axis grows, equation (7) of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.wording import count
from jointwear.reproduction.grid import Cell
from jointwear.reproduction.simulation import simulate_run, unworn_levels
from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics


def coulomb_levels(
    dynamics: Dynamics, hours: np.ndarray, axis: int | None = None, wear: Wear | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return positive and negative Coulomb levels [N m], each (hours, n), with one worn axis or none.

    Parameters
    ----------
    hours : (hours,) time since the start of wear [h].
    axis : 1-based axis that wears.
    wear : its growth.
    """
    positive, negative = unworn_levels(dynamics, hours)
    if axis is None or wear is None:
        return positive, negative
    robot, j = dynamics.robot, axis - 1
    positive[:, j], negative[:, j] = wear.coulomb(robot.coulomb_positive[j], robot.coulomb_negative[j], hours)
    return positive, negative


def simulate_worn_run(
    robot: str | Path,
    task: str | Path,
    output: str | Path,
    *,
    cell: Cell,
    settings: Mapping[str, Any],
    threads: int = 1,
) -> None:
    """Simulate the worn run of one cell of the grid; see :func:`jointwear.reproduction.simulation.simulate_run`.

    Parameters
    ----------
    settings : those of :func:`~jointwear.reproduction.simulation.simulate_run`, and `shape` and `wear_hours` of
        equation (7): the growth reaches the cell's percentage at hour `wear_hours`.

    Raises
    ------
    InputError : if a file is wrong, or the robot has no such axis.
    """
    wear = Wear(cell.increase_percent, settings["shape"], settings["wear_hours"])

    def levels(dynamics: Dynamics, hours: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        n = dynamics.robot.joints
        if not 1 <= cell.axis <= n:
            raise InputError(f"{robot}: the robot has {count(n, 'axis', 'axes')}; axis {cell.axis} cannot wear")
        return coulomb_levels(dynamics, hours, cell.axis, wear)

    simulate_run(
        robot,
        task,
        output,
        key=("wear", cell.task, cell.axis, round(cell.increase_percent * 1000)),
        hours=settings["wear_hours"],
        settings=settings,
        levels=levels,
        what=f"wear of axis {cell.axis}",
        named=cell.attributes,
        threads=threads,
    )
