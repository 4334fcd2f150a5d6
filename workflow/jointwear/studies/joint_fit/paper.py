"""What one paper prints: the real one, one of known origin, or the real one with Table IV shuffled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointwear.reproduction.published import load_published
from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.studies.joint_fit.detection import READINGS, Grid, PcaReading, detect
from jointwear.studies.joint_fit.distance import TaskTarget, lags
from jointwear.studies.joint_fit.levels import Levels, Noise, task_levels
from jointwear.studies.joint_fit.noise_bank import NoiseBank, draw_bank
from jointwear.studies.joint_fit.pose_search import Arm
from jointwear.studies.multiverse.pose_sets import with_payload
from jointwear.studies.multiverse.shared_torque import cell_offset
from jointwear.studies.recovery.tables import TORQUE_ROUNDING, Tables, read_tables

LAG_TASK, LAG_RUN = 0, (0, 0)  # Table II and Figure 2: T1, the first increase, axis 1


@dataclass(frozen=True)
class Paper:
    """Tables IV to VI, signs of Table II (n, n), lowest and highest number of components."""

    tables: Tables
    lag_sign: np.ndarray
    components: tuple[int, int]

    def target(self, task: int) -> TaskTarget:
        """Return what is printed of a 0-based task."""
        return TaskTarget(self.tables.hours[task].T, self.components, self.lag_sign if task == LAG_TASK else None)


def read_paper(published: str | Path) -> Paper:
    """Read what the paper prints."""
    printed = load_published(published)
    tables = read_tables(published)
    n = tables.maximum.shape[1]
    lag = [[printed.lag(i, j) or 0 for j in range(1, n + 1)] for i in range(1, n + 1)]
    low, high = printed.data["text_claims"]["principal_components"]
    return Paper(tables, np.sign(np.array(lag)), (int(low), int(high)))


def shuffled_paper(paper: Paper, random: np.random.Generator) -> Paper:
    """Return the paper with the cells of Table IV in random order."""
    hours = random.permutation(paper.tables.hours.ravel()).reshape(paper.tables.hours.shape)
    return replace(paper, tables=replace(paper.tables, hours=hours))


@dataclass(frozen=True)
class Prior:
    """Ranges from which an experiment of known origin is drawn: `mass` [kg], `offset` [m], `shape`; `least_span`
    [rad] by which a moving joint turns."""

    mass: tuple[float, float] = (1.5, 3.5)
    offset: tuple[float, float] = (0.06, 0.2)
    shape: tuple[float, float] = (0.4, 1.6)
    least_span: float = np.radians(20.0)


@dataclass(frozen=True)
class Truth:
    """The experiment behind a paper of known origin."""

    arm: Arm
    reading: PcaReading


def synthetic_paper(
    robot: Robot, seed: int, name: str, random: np.random.Generator, grid: Grid, noise: Noise, prior: Prior
) -> tuple[Paper, Truth]:
    """Draw an experiment and print what one run of each cell of it gives, as the paper did.

    As in the paper the first task rests at two of its six instants and does not turn the last axis.
    """
    arm = Arm(
        float(random.uniform(*prior.mass)),
        float(random.uniform(*prior.offset)),
        float(np.exp(random.uniform(*np.log(prior.shape)))),
    )
    reading = READINGS[random.integers(len(READINGS))]
    dynamics = Dynamics(with_payload(robot, arm.mass, (0.0, 0.0, arm.offset)))
    n, c = robot.joints, len(grid.increases)
    shape = (3, n, c)
    hours, maximum, variation = (np.full(shape, np.nan) for _ in range(3))
    kept: list[int] = []
    lag_sign = np.zeros((n, n), dtype=int)
    for t in range(3):
        start, stop, phase = _random_poses(robot, t == LAG_TASK, random, prior)
        levels = task_levels(dynamics, start[None], stop[None], np.array([phase]), noise)[0]
        bank = draw_bank(seed, f"synthetic {name} {t}", n, 1)
        outcome = detect(levels, bank, arm.shape, grid, [reading], LAG_RUN if t == LAG_TASK else None)
        hours[t] = outcome.onset[reading][..., 0].T
        kept.append(int(outcome.kept[reading][0]))
        maximum[t], variation[t] = _printed_torque(levels, bank, arm.shape, grid, hours[t])
        if t == LAG_TASK:
            lag_sign = np.sign(lags(outcome.series)[0])
    maximum = np.where(maximum < TORQUE_ROUNDING, 0.0, np.round(maximum, 3))
    tables = Tables(("T1", "T2", "T3"), np.array(grid.increases), hours, maximum, np.round(variation, 3))
    return Paper(tables, lag_sign, (min(kept), max(kept))), Truth(arm, reading)


def _random_poses(
    robot: Robot, rests: bool, random: np.random.Generator, prior: Prior
) -> tuple[np.ndarray, np.ndarray, float]:
    while True:
        start, stop = random.uniform(robot.lower, robot.upper), random.uniform(robot.lower, robot.upper)
        if rests:
            stop[-1] = start[-1]
        span = np.abs(stop - start)[: -1 if rests else None]
        if span.min() >= prior.least_span:
            return start, stop, 0.0 if rests else float(random.uniform(1.0, 9.0))


def _printed_torque(levels: Levels, bank: NoiseBank, shape: float, grid: Grid, hours: np.ndarray):
    """Largest |torque| and its coefficient of variation (n, c) in the hour of detection, or the last of the run."""
    n, c = hours.shape
    maximum, variation = np.empty((n, c)), np.empty((n, c))
    for i in range(n):
        for j, increase in enumerate(grid.increases):
            hour = grid.hours if np.isnan(hours[i, j]) else hours[i, j]
            growth = float(Wear(increase, shape, grid.hours).growth(hour))
            place = (cell_offset(i + 1, j, n) + int(hour) - 1) % bank.normal.shape[-1]
            level = levels.torque[i] + growth * levels.friction[i]
            spread = levels.spread[i] + growth * levels.spread_rise[i]
            size = np.abs(level[:, None] + spread * bank.normal[i, :, :, 0, place])
            maximum[i, j], variation[i, j] = size.max(), size.std(ddof=1) / size.mean()
    return maximum, variation
