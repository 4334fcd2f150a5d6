"""Poses of one task for a given payload and wear shape: many that fit Tables V and VI, then a search on all tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.studies.joint_fit.detection import Grid, PcaReading, TaskOutcome, detect
from jointwear.studies.joint_fit.distance import (
    TaskTarget,
    Weights,
    agreeing_cells,
    detection_cost,
    series_cost,
    table_cost,
)
from jointwear.studies.joint_fit.levels import Noise, task_levels
from jointwear.studies.joint_fit.noise_bank import NoiseBank
from jointwear.studies.multiverse.pose_sets import with_payload
from jointwear.studies.recovery.candidates import candidate
from jointwear.studies.recovery.least_squares import minimise
from jointwear.studies.recovery.problem import TableProblem, TableSettings
from jointwear.studies.recovery.search import SOFT_FLOOR, screened_start
from jointwear.studies.recovery.tables import Tables


@dataclass(frozen=True)
class Arm:
    """What the tasks share: payload `mass` [kg] at `offset` [m] along the tool axis, and wear shape."""

    mass: float
    offset: float
    shape: float

    @property
    def moment(self) -> float:
        """First moment of the payload [kg m]."""
        return self.mass * self.offset


class TaskFit:
    """One task of one arm against the paper.

    Parameters
    ----------
    robot : the arm without payload.
    tables : of this task alone.
    target : its part of Tables II and IV.
    arm : payload and wear shape.
    bank : random numbers.
    shown : (column, axis) of the run of Table II, 0-based, None for a task that it does not show.
    """

    def __init__(
        self,
        robot: Robot,
        tables: Tables,
        target: TaskTarget,
        arm: Arm,
        bank: NoiseBank,
        grid: Grid,
        noise: Noise,
        weights: Weights,
        shown: tuple[int, int] | None = None,
    ) -> None:
        self.target, self.arm, self.bank = target, arm, bank
        self.grid, self.noise, self.weights, self.shown = grid, noise, weights, shown
        self.dynamics = Dynamics(with_payload(robot, arm.mass, (0.0, 0.0, arm.offset)))
        frozen = np.array([arm.shape, arm.mass, 0.0, 0.0, arm.offset])
        self.problem = TableProblem(robot, tables, candidate("payload"), TableSettings(), frozen=frozen)
        self._moving = ~tables.at_rest

    def poses(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return start, stop (S, n) [rad] and phase (S,) [s] of free vectors u (S, p)."""
        start, stop, phase, _, _ = self.problem.split(self.problem.physical(u))
        return start[:, 0], stop[:, 0], phase[:, 0]

    def free(self, start: np.ndarray, stop: np.ndarray, phase: float) -> np.ndarray:
        """Return the free vector (p,) of poses start, stop (n,) [rad] and phase [s]: the inverse of `poses`."""
        return self.problem.join(start[None], stop[None], np.array([phase]), self.arm.shape, np.empty(0))

    def table_errors(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return relative errors of Table V and errors of Table VI at the published hours, each (S, cells)."""
        predicted, tables = self.problem.predict(u), self.problem.tables
        torque = (predicted.maximum / np.where(tables.maximum > 0, tables.maximum, 1.0) - 1)[:, self._moving]
        variation = (predicted.variation - tables.variation)[:, self._moving]
        return torque.reshape(len(u), -1), variation.reshape(len(u), -1)

    def cost_of_tables(self, u: np.ndarray) -> np.ndarray:
        """Return the cost (S,) of Tables V and VI."""
        return table_cost(*self.table_errors(u), self.weights)

    def outcomes(self, u: np.ndarray, readings: Sequence[PcaReading]) -> list[TaskOutcome]:
        """Return the detections of free vectors u (S, p)."""
        tasks = task_levels(self.dynamics, *self.poses(u), self.noise)
        return [detect(levels, self.bank, self.arm.shape, self.grid, readings, self.shown) for levels in tasks]

    def costs(self, u: np.ndarray, readings: Sequence[PcaReading]) -> tuple[np.ndarray, np.ndarray]:
        """Return the whole cost of free vectors u (S, p) and the cells of Table IV that agree, each (S, readings)."""
        fixed = self.cost_of_tables(u)
        costs, cells = np.empty((len(u), len(readings))), np.empty((len(u), len(readings)), dtype=int)
        for k, outcome in enumerate(self.outcomes(u, readings)):
            extra = fixed[k] + series_cost(outcome, self.target, self.weights)
            of_detection = detection_cost(outcome, self.target, self.weights)
            agreed = agreeing_cells(outcome, self.target)
            costs[k] = [extra + of_detection[r] for r in readings]
            cells[k] = [agreed[r] for r in readings]
        return costs, cells

    def descend(self, u: np.ndarray, iterations: int) -> np.ndarray:
        """Return free vectors brought towards Tables V and VI."""
        return minimise(self.problem.residuals, self.problem.residuals_and_jacobian, u, iterations).point

    def table_solutions(self, random: np.random.Generator, starts: int, keep: int) -> np.ndarray:
        """Return up to `keep` free vectors that come closest to Tables V and VI, from `starts` independent starts."""
        soft = self.problem.softened(SOFT_FLOOR)
        u = screened_start(soft, random, starts, draws=30)
        u = minimise(soft.residuals, soft.residuals_and_jacobian, u, 40).point
        u = u[np.argsort(self.cost_of_tables(u))[: max(2 * keep, 1)]]
        u = self.descend(u, 40)
        return u[np.argsort(self.cost_of_tables(u))[:keep]]


@dataclass(frozen=True)
class LocalSearch:
    """`rounds` of one trial for each member; steps are drawn between `smallest` and `largest` (free units); `mend`
    iterations bring a trial back towards Tables V and VI."""

    rounds: int = 60
    smallest: float = 0.003
    largest: float = 0.3
    mend: int = 3


def improve(
    fit: TaskFit,
    u: np.ndarray,
    cost: np.ndarray,
    reading: PcaReading,
    random: np.random.Generator,
    plan: LocalSearch,
) -> tuple[np.ndarray, np.ndarray]:
    """Return members (S, p) and costs (S,) after a local search of each by itself; a trial is taken if it is better."""
    u, cost = u.copy(), cost.copy()
    success = np.full(len(u), np.log(plan.largest / 3))
    for _ in range(plan.rounds):
        size = np.exp(success + 0.7 * random.standard_normal(len(u))).clip(plan.smallest, plan.largest)
        which = random.random(u.shape) < random.choice([0.15, 0.4, 1.0], size=len(u))[:, None]
        trial = u + size[:, None] * which * random.standard_normal(u.shape)
        mended = fit.descend(trial, plan.mend)
        # Half of the trials stay where the step led, since Tables V and VI leave room within their tolerance.
        stay = random.random(len(u)) < 0.35
        mended[stay] = trial[stay]
        tables = fit.cost_of_tables(mended)
        promising = np.flatnonzero(tables < cost)
        if len(promising):
            values = fit.costs(mended[promising], [reading])[0][:, 0]
            better = values < cost[promising]
            taken = promising[better]
            u[taken], cost[taken] = mended[taken], values[better]
            success[taken] = np.log(size[taken])
    return u, cost
