"""What Figures 1 to 3 show, computed from result files; the report scores the same values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointwear.files.storage import open_dataset, read_variable, read_variables
from jointwear.reproduction.grid import Cell, cell_of
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import load_task


@dataclass(frozen=True)
class Band:
    """Median and 5 to 95 % range over replicates, and one named replicate; arrays of one shape."""

    median: np.ndarray
    low: np.ndarray
    high: np.ndarray
    single: np.ndarray


def band(values: np.ndarray, replicate: int) -> Band:
    """Summarise values (r, ...) over replicates; `replicate` is 1-based."""
    low, median, high = np.quantile(values, [0.05, 0.5, 0.95], axis=0)
    return Band(median, low, high, values[replicate - 1])


@dataclass(frozen=True)
class FrictionCurve:
    """Friction torque of the worn axis in one direction, as a size [N m], over the hours of wear (hours,).

    `velocity` [rad/s] is that of the sampled instant at which the axis moves fastest in this direction (0: it
    never does, and the curve is Coulomb friction alone); `measured` adds disturbance and noise of one replicate.
    """

    direction: str
    velocity: float
    hour: np.ndarray
    friction: np.ndarray
    measured: np.ndarray


def friction_curves(simulation: str | Path, robot: str | Path, task: str | Path, replicate: int) -> list[FrictionCurve]:
    """Return the friction torque of equation (8) on the worn axis, for positive and for negative velocity.

    Parameters
    ----------
    simulation : file of a worn run.
    robot, task : robot file and task file of that run.
    replicate : whose disturbance and noise are shown, 1-based.
    """
    j = cell_of(str(simulation)).axis - 1
    arm = load_robot(robot)
    with open_dataset(simulation) as dataset:
        hour = read_variable(dataset, simulation, "hour").astype(float)
        times = read_variable(dataset, simulation, "sample_time")
        level = read_variable(dataset, simulation, "coulomb", (slice(None), j))
        noise = read_variable(dataset, simulation, "torque", (replicate - 1, slice(None), slice(None), j)).astype(float)
        noise -= read_variable(dataset, simulation, "commanded_torque", (slice(None), slice(None), j))
    the_task = load_task(task)
    velocity = the_task.motion(the_task.phase + times).velocity[:, j]
    # The file holds the level for positive velocity; both directions grow by the same factor.
    growth = level / arm.coulomb_positive[j] if arm.coulomb_positive[j] > 0 else np.ones_like(level)
    curves = []
    for direction, sign, coulomb in (
        ("positive", 1.0, arm.coulomb_positive[j]),
        ("negative", -1.0, -arm.coulomb_negative[j]),
    ):
        instant = int(np.argmax(sign * velocity))
        speed = max(float(sign * velocity[instant]), 0.0)
        friction = coulomb * growth + arm.viscous[j] * speed
        curves.append(FrictionCurve(direction, sign * speed, hour, friction, friction + sign * noise[:, instant]))
    return curves


@dataclass(frozen=True)
class DivergenceCurves:
    """KL divergence [nat] of all axes over a worn run, bands of shape (hours, n).

    `peak` (r,): largest value of a replicate over all axes and hours; `worn_leads` (r,): whether the worn axis
    has the largest mean over the last fifth of the run.
    """

    cell: Cell
    hour: np.ndarray
    divergence: Band
    peak: np.ndarray
    worn_leads: np.ndarray


def divergence_curves(features: str | Path, replicate: int) -> DivergenceCurves:
    """Read the KL divergence of a worn run (Figure 2)."""
    cell = cell_of(str(features))
    hour, kl = read_variables(features, "hour", "kl_divergence")
    late = kl[:, -max(len(hour) // 5, 1) :].mean(axis=1)
    return DivergenceCurves(cell, hour, band(kl, replicate), kl.max(axis=(1, 2)), late.argmax(axis=1) == cell.axis - 1)


@dataclass(frozen=True)
class ResidualCurves:
    """Q-statistic in training and in a worn run, hours counted from the start of wear.

    `limit`: control limit, scalar bands; `onset` (r,): hour of detection, NaN where none; `kept` (r,): number of
    principal components.
    """

    cell: Cell
    training_hour: np.ndarray
    training: Band
    hour: np.ndarray
    run: Band
    limit: Band
    onset: np.ndarray
    kept: np.ndarray


def residual_curves(model: str | Path, detection: str | Path, replicate: int) -> ResidualCurves:
    """Read the Q-statistic of a task's training and of one worn run (Figure 3)."""
    training, limit, kept = read_variables(model, "q", "q_limit", "kept")
    hour, q, onset = read_variables(detection, "hour", "q", "onset")
    return ResidualCurves(
        cell_of(str(detection)),
        np.arange(-training.shape[1] + 1, 1),
        band(training, replicate),
        hour,
        band(q, replicate),
        band(limit, replicate),
        onset,
        kept,
    )
