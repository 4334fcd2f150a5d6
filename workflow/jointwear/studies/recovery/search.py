"""Search for the best trajectories and parameters of one candidate from many independent starts.

The cost is a sum over tasks that share nothing but the candidate's parameters and the wear shape. So a good
trajectory of one task, found from one start, may replace a poor one of another start.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.studies.recovery.least_squares import minimise
from jointwear.studies.recovery.problem import TableProblem

# The zero of an axis at rest makes a valley too narrow to search in; it counts in full from the last round on.
SOFT_FLOOR = 0.02  # N m


@dataclass(frozen=True)
class Effort:
    """How long to search.

    `starts`: independent starts; `draws`: random poses of which each start takes the best; `rounds` of exchange
    between starts, each followed by `iterations` of least squares; `final`: iterations of the last descent of
    the `finalists` best; `refinements`: how often the tasks are searched again, each by itself, from as many new
    starts, with the common parameters held where the best start left them.
    """

    starts: int = 30
    draws: int = 100
    rounds: int = 3
    iterations: int = 20
    final: int = 100
    finalists: int = 3
    refinements: int = 2


@dataclass(frozen=True)
class Found:
    """End points of a search, best first: `point` (S, p), `cost` (S,); `first_cost` (S,) before any exchange."""

    point: np.ndarray
    cost: np.ndarray
    first_cost: np.ndarray


def search(problem: TableProblem, random: np.random.Generator, effort: Effort) -> Found:
    """Return the best end points over all starts, the best `finalists` brought to convergence."""
    point, first = _rounds(problem, random, effort)
    point = point[: effort.finalists]
    point, cost = _sorted(*_descend(problem, point, effort.final))
    if problem.size > problem.trajectory_count:
        for _ in range(effort.refinements):
            again = np.array([_refined(problem, random, effort, p) for p in point])
            again, lower = _descend(problem, again, effort.final)
            point, cost = _sorted(np.concatenate([point, again]), np.concatenate([cost, lower]))
            point, cost = point[: effort.finalists], cost[: effort.finalists]
    return Found(point, cost, first)


def _rounds(problem: TableProblem, random: np.random.Generator, effort: Effort) -> tuple[np.ndarray, np.ndarray]:
    """Return the points after all exchanges, best first, and the costs before any."""
    exact, problem = problem, problem.softened(SOFT_FLOOR)
    place = problem.trajectory_count
    point = screened_start(problem, random, effort.starts, effort.draws)
    point, cost = _descend(problem, point, 2 * effort.iterations)
    first = np.sort(cost)
    for round_ in range(effort.rounds):
        if round_ == effort.rounds - 1:
            problem = exact
        # First new poses for the parameters that the starts have come to, then small changes of good poses.
        if round_ == 0:
            others = screened_start(problem, random, len(point), effort.draws, common=point[:, place:])
        else:
            others = mutated(problem, random, point)
        others, _ = _descend(problem, others, effort.iterations)
        point = exchange(problem, point, others)
        point, cost = _descend(problem, point, effort.iterations)
    return _sorted(point, cost)[0], first


def _refined(problem: TableProblem, random: np.random.Generator, effort: Effort, point: np.ndarray) -> np.ndarray:
    """Return `point` with every task's trajectory searched anew for the common parameters of `point`."""
    result = point.copy()
    for task, columns in enumerate(problem.columns_by_task):
        found, cost = search_task(problem.task_alone(task, point), random, effort)
        if cost < problem.cost_by_task(point[None])[0, task]:
            result[columns] = found
    return result


def search_task(alone: TableProblem, random: np.random.Generator, effort: Effort) -> tuple[np.ndarray, float]:
    """Return the best trajectory of a problem that has one task and no common parameters, and its cost."""
    found, _ = _rounds(alone, random, effort)
    found, cost = _descend(alone, found[:1], effort.iterations)
    return found[0], float(cost[0])


def mutated(problem: TableProblem, random: np.random.Generator, point: np.ndarray) -> np.ndarray:
    """Return `point` with one or two joints of every task sent the other way or to other positions."""
    drawn = problem.random_start(random, len(point))
    result = point.copy()
    rows = np.arange(len(point))
    for pairs in problem.pairs_by_task:
        for _ in range(2):
            chosen = pairs[random.integers(len(pairs), size=len(point))]
            kind = random.integers(4, size=len(point))
            start, stop = chosen[:, 0], chosen[:, 1]
            first, second = result[rows, start].copy(), result[rows, stop].copy()
            swap, both, single = kind == 0, kind == 1, kind == 2
            result[rows[swap], start[swap]], result[rows[swap], stop[swap]] = second[swap], first[swap]
            result[rows[both], start[both]] = drawn[rows[both], start[both]]
            result[rows[both | single], stop[both | single]] = drawn[rows[both | single], stop[both | single]]
    return result


def screened_start(
    problem: TableProblem, random: np.random.Generator, count: int, draws: int, common: np.ndarray | None = None
) -> np.ndarray:
    """Return `count` free vectors; each has, task by task, the best of `draws` random trajectories.

    Parameters
    ----------
    common : (count, p') free parameters that the tasks share; default random.
    """
    place = problem.trajectory_count
    common = problem.random_start(random, count)[:, place:] if common is None else common
    point = problem.random_start(random, count)
    point[:, place:] = common
    if draws < 2:
        return point
    drawn = problem.random_start(random, count * draws)
    drawn[:, place:] = np.repeat(common, draws, axis=0)
    cost = problem.cost_by_task(drawn).reshape(count, draws, -1)
    drawn = drawn.reshape(count, draws, -1)
    for task, columns in enumerate(problem.columns_by_task):
        best = cost[:, :, task].argmin(axis=1)
        point[:, columns] = drawn[np.arange(count), best][:, columns]
    return point


def exchange(problem: TableProblem, point: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return `point` with every task's trajectory replaced by the one of either set that suits its parameters best."""
    place, count = problem.trajectory_count, len(point)
    pool = np.concatenate([point, others])
    trial = np.tile(pool, (count, 1))
    trial[:, place:] = np.repeat(point[:, place:], len(pool), axis=0)
    cost = problem.cost_by_task(trial).reshape(count, len(pool), -1)
    result = point.copy()
    for task, columns in enumerate(problem.columns_by_task):
        result[:, columns] = pool[cost[:, :, task].argmin(axis=1)][:, columns]
    return result


def _descend(problem: TableProblem, point: np.ndarray, iterations: int) -> tuple[np.ndarray, np.ndarray]:
    solution = minimise(problem.residuals, problem.residuals_and_jacobian, point, iterations)
    return solution.point, solution.cost


def _sorted(point: np.ndarray, cost: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(cost)
    return point[order], cost[order]
