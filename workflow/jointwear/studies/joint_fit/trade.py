"""What one aim costs in the others: the nearest experiments searched on under other weights.

The search weighs all tables once and for all. Where its nearest experiment misses an aim by little, or a table by much,
that alone does not tell whether the aim is out of reach or was bought by another one. Here the poses of the nearest
experiments are searched on with Tables V and VI, or the signs of Table II, weighing more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointwear.robots.robot import Robot
from jointwear.studies.joint_fit.detection import Grid
from jointwear.studies.joint_fit.distance import Weights
from jointwear.studies.joint_fit.levels import Noise
from jointwear.studies.joint_fit.paper import LAG_TASK, Paper
from jointwear.studies.joint_fit.paper_fit import JointExperiment, PaperFit, Plan
from jointwear.studies.joint_fit.pose_search import improve


@dataclass(frozen=True)
class Emphasis:
    """Factors: `tables` on what an error in Tables V and VI costs, `signs` on that of a sign of Table II, `torque` on
    the size of an error in Table V, so that small ones count there too."""

    tables: float = 1.0
    signs: float = 1.0
    torque: float = 1.0

    @property
    def weights(self) -> Weights:
        """The weights of the search with these factors."""
        usual = Weights()
        return replace(
            usual,
            table=usual.table * self.tables,
            lag=usual.lag * self.signs,
            torque_scale=usual.torque_scale / self.torque,
        )


def bases(experiments: Sequence[JointExperiment], distance: np.ndarray, count: int) -> list[list[int]]:
    """Return the places of the experiments of the `count` nearest arms, nearest first: (e,) distances, one list an arm.

    An arm is as near as its nearest experiment.
    """
    found: dict[object, list[int]] = {}
    for k in np.argsort(distance, kind="stable"):
        found.setdefault(experiments[k].arm, []).append(int(k))
    return list(found.values())[:count]


def search_on(
    robot: Robot,
    paper: Paper,
    seed: int,
    plan: Plan,
    grid: Grid,
    noise: Noise,
    members: Sequence[JointExperiment],
    emphases: Sequence[Emphasis],
    number: int,
) -> list[JointExperiment]:
    """Return one experiment for every emphasis: the best poses of each task, searched on from `members` of one arm.

    Parameters
    ----------
    robot : the arm without payload.
    plan : its `local` search and its `members`, the starts of every task.
    number : keys the random numbers.
    """
    arm, reading = members[0].arm, members[0].reading
    known: dict[tuple[int, Emphasis], tuple[np.ndarray, np.ndarray, float, float]] = {}
    result = []
    for emphasis in emphases:
        fit = PaperFit(robot, paper, seed, "paper", plan, grid, noise, emphasis.weights)
        poses = []
        for t in range(len(paper.tables.tasks)):
            # Table II shows one task alone.
            key = (t, emphasis if t == LAG_TASK else replace(emphasis, signs=1.0))
            if key not in known:
                task = fit.task(t, arm)
                u = np.stack([task.free(e.start[t], e.stop[t], float(e.phase[t])) for e in members[: plan.members]])
                cost = task.costs(u, [reading])[0][:, 0]
                u, cost = improve(task, u, cost, reading, fit.random(f"trade {t}", number), plan.local)
                best = int(cost.argmin())
                start, stop, phase = task.poses(u[best : best + 1])
                known[key] = start[0], stop[0], float(phase[0]), float(cost[best])
            poses.append(known[key])
        start, stop, phase, cost = (np.array(values) for values in zip(*poses, strict=True))
        result.append(JointExperiment(arm, reading, start, stop, phase, cost))
    return result
