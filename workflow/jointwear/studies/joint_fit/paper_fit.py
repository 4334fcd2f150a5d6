"""Fit one experiment to a paper: payload from Tables V and VI, reading and poses from everything."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointwear.robots.robot import Robot
from jointwear.statistics.randomness import generator
from jointwear.studies.joint_fit.arm_evidence import ArmEvidence, walk
from jointwear.studies.joint_fit.detection import READINGS, Grid, PcaReading
from jointwear.studies.joint_fit.distance import Weights
from jointwear.studies.joint_fit.levels import Noise
from jointwear.studies.joint_fit.noise_bank import draw_bank
from jointwear.studies.joint_fit.paper import LAG_RUN, LAG_TASK, Paper
from jointwear.studies.joint_fit.pose_search import Arm, LocalSearch, TaskFit, improve
from jointwear.studies.recovery.problem import TableSettings


@dataclass(frozen=True)
class Plan:
    """Effort of a fit.

    `moment` [kg m], `offset` [m]: range of the payloads for which Tables V and VI are fitted first, in `strata`, with
    `first_starts` for every task of which `first_keep` stay, and `first_shape`. `walk` steps of `step` (logarithm)
    over arms follow, each judged after `descent` iterations.
    `arm_spread`, `shape_spread`: relative spread of the arms that are drawn around the best. `starts`, `keep`: of
    :meth:`TaskFit.table_solutions`. `members`, `local`: how many poses of each task are searched on, and how.
    `replicates` of the random numbers that all candidates share.
    """

    moment: tuple[float, float] = (0.1, 0.6)
    offset: tuple[float, float] = (0.06, 0.22)
    strata: int = 5
    first_starts: int = 30
    first_keep: int = 5
    first_shape: float = 1.0
    descent: int = 12
    walk: int = 60
    step: float = 0.1
    arm_spread: float = 0.12
    shape_spread: float = 0.4
    starts: int = 100
    keep: int = 20
    members: int = 5
    local: LocalSearch = field(default_factory=LocalSearch)
    replicates: int = 12


@dataclass(frozen=True)
class ScreenedArm:
    """`poses`, free vectors of each task; `costs`, `cells` of Table IV, each (keep, readings) a task."""

    arm: Arm
    poses: list[np.ndarray]
    costs: list[np.ndarray]
    cells: list[np.ndarray]

    def best(self, count: int = 1) -> np.ndarray:
        """Return (readings,) sum over tasks of the mean of the `count` smallest costs."""
        return sum(np.sort(c, axis=0)[:count].mean(axis=0) for c in self.costs)

    def agreement(self) -> np.ndarray:
        """Return (readings,) cells of Table IV that agree with the best poses of every task."""
        return sum(
            np.take_along_axis(n, c.argmin(axis=0)[None], axis=0)[0]
            for n, c in zip(self.cells, self.costs, strict=True)
        )


@dataclass(frozen=True)
class JointExperiment:
    """One experiment: arm, reading, poses `start`, `stop` (t, n) [rad], `phase` (t,) [s], `cost` (t,) of its tasks."""

    arm: Arm
    reading: PcaReading
    start: np.ndarray
    stop: np.ndarray
    phase: np.ndarray
    cost: np.ndarray


class PaperFit:
    """The fit of one paper.

    Parameters
    ----------
    robot : the arm without payload.
    name : keys the random numbers, those of the search and those of the noise.
    """

    def __init__(
        self,
        robot: Robot,
        paper: Paper,
        seed: int,
        name: str,
        plan: Plan,
        grid: Grid | None = None,
        noise: Noise | None = None,
        weights: Weights | None = None,
    ) -> None:
        self.robot, self.paper, self.plan, self._seed, self._name = robot, paper, plan, seed, name
        self.grid, self.noise, self.weights = grid or Grid(), noise or Noise(), weights or Weights()
        self._banks = [
            draw_bank(seed, f"{name} {t}", robot.joints, plan.replicates) for t in range(len(paper.tables.tasks))
        ]

    def random(self, stage: str, number: int = 0) -> np.random.Generator:
        """Return the random numbers of a stage."""
        return generator(self._seed, "joint fit", self._name, stage, replicate=number)

    def fitted_arms(self) -> tuple[list[Arm], np.ndarray]:
        """Return arms by their evidence in Tables V and VI at the printed hours, best first, and that evidence.

        Poses of each task are searched for arms spread over the whole range; they are the starts from which every
        arm of a walk over payload and wear shape is judged.
        """
        plan, random = self.plan, self.random("tables")
        # One arm from every stratum of moment and of offset.
        ranges = (plan.moment, plan.offset)
        moments, offsets = (
            low * (high / low) ** ((random.permutation(plan.strata) + 0.5) / plan.strata) for low, high in ranges
        )
        first = [Arm(float(m / z), float(z), plan.first_shape) for m, z in zip(moments, offsets, strict=True)]
        count = len(self._banks)
        solutions = [
            [self.task(t, arm).table_solutions(random, plan.first_starts, plan.first_keep) for t in range(count)]
            for arm in first
        ]
        pools = [np.concatenate([u[t] for u in solutions]) for t in range(count)]
        evidence = ArmEvidence(self.task, pools, plan.descent)
        start = max(first, key=evidence)
        arms, value = walk(evidence, start, random, plan.walk, plan.step, TableSettings().shape_range)
        order = np.argsort(-value, kind="stable")
        order = order[np.sort(np.unique(value[order], return_index=True)[1])]
        return [arms[k] for k in order], value[order]

    def drawn_arms(self, fitted: Sequence[Arm], count: int) -> list[Arm]:
        """Return `count` arms: the fitted ones, then draws around them."""
        random = self.random("arms")
        result = list(fitted[:count])
        low, high = TableSettings().shape_range
        while len(result) < count:
            base = fitted[random.integers(len(fitted))]
            moment = base.moment * np.exp(self.plan.arm_spread * random.standard_normal())
            offset = float(np.clip(base.offset * np.exp(self.plan.arm_spread * random.standard_normal()), 0.03, 0.3))
            shape = base.shape * np.exp(self.plan.shape_spread * random.standard_normal())
            result.append(Arm(float(moment / offset), offset, float(np.clip(shape, low, high))))
        return result

    def task(self, number: int, arm: Arm) -> TaskFit:
        """Return one task of one arm."""
        return TaskFit(
            self.robot,
            self.paper.tables.task_subset([number]),
            self.paper.target(number),
            arm,
            self._banks[number],
            self.grid,
            self.noise,
            self.weights,
            LAG_RUN if number == LAG_TASK else None,
        )

    def screen(self, arm: Arm, number: int, readings: Sequence[PcaReading] = READINGS) -> ScreenedArm:
        """Return poses that fit Tables V and VI and what they cost under every reading."""
        random = self.random("screen", number)
        poses, costs, cells = [], [], []
        for t in range(len(self._banks)):
            fit = self.task(t, arm)
            u = fit.table_solutions(random, self.plan.starts, self.plan.keep)
            cost, agreed = fit.costs(u, readings)
            poses.append(u)
            costs.append(cost)
            cells.append(agreed)
        return ScreenedArm(arm, poses, costs, cells)

    def search(self, screened: ScreenedArm, reading: PcaReading, place: int, number: int) -> list[JointExperiment]:
        """Return experiments of one arm, best first: the k-th has the k-th best poses of every task.

        Parameters
        ----------
        place : of the reading in the costs of the screened arm; number : keys the random numbers.
        """
        random = self.random("search", number)
        ranked = []
        for t, (poses, costs) in enumerate(zip(screened.poses, screened.costs, strict=True)):
            order = np.argsort(costs[:, place])[: self.plan.members]
            fit = self.task(t, screened.arm)
            u, cost = improve(fit, poses[order], costs[order, place], reading, random, self.plan.local)
            order = np.argsort(cost)
            start, stop, phase = fit.poses(u[order])
            ranked.append((start, stop, phase, cost[order]))
        experiments = []
        for k in range(min(len(r[3]) for r in ranked)):
            start, stop, phase, cost = (np.array([r[i][k] for r in ranked]) for i in range(4))
            experiments.append(JointExperiment(screened.arm, reading, start, stop, phase, cost))
        return experiments


def choose_reading(screened: Sequence[ScreenedArm]) -> int:
    """Return the place of the reading with the smallest mean cost over arms, three best poses of every task each."""
    return int(np.argmin(np.mean([s.best(3) for s in screened], axis=0)))
