"""Fit one candidate to the published tables and keep the result as a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.robots.robot import Robot, load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.recovery.candidates import Explanation, candidate
from jointwear.studies.recovery.least_squares import minimise
from jointwear.studies.recovery.problem import TableProblem, TableSettings
from jointwear.studies.recovery.sampled_motion import SEGMENT
from jointwear.studies.recovery.search import Effort, search, search_task
from jointwear.studies.recovery.tables import Tables, read_tables

# Duration of the way out beside half a cycle. Longer than half is the same seen from the other end. A task that
# rests at two sampled instants must turn at one of them.
OTHER_OUTWARD = (40.0, 50.0)
# The largest of sixty noisy samples scatters by 0.45 standard deviations of the noise, that is 0.45 % or 0.45
# units of its weight, the coefficient of variation by 0.15 units: 0.11 in the mean square.
NOISE_VARIANCE = 0.1


@dataclass(frozen=True)
class ExplanationFit:
    """Best explanation of the tables by one candidate.

    `start`, `stop` (t, n) [rad]; `phase`, `outward` (t,) [s]; `shape` of the wear; `effect` (p,) parameters of
    the candidate and their `std` (p,), NaN where the data do not decide; `maximum` [N m] and `variation` (t, n, c)
    predicted; `cost` half the weighted sum of squares; `data` and `parameters` counted; `start_cost` (starts,).
    """

    candidate: str
    start: np.ndarray
    stop: np.ndarray
    phase: np.ndarray
    outward: np.ndarray
    shape: float
    effect: np.ndarray
    std: np.ndarray
    maximum: np.ndarray
    variation: np.ndarray
    cost: float
    data: int
    parameters: int
    start_cost: np.ndarray

    @property
    def variance(self) -> float:
        """Mean squared weighted residual, no less than what one draw of noise leaves in the tables."""
        return max(2 * self.cost / self.data, NOISE_VARIANCE)

    @property
    def bic(self) -> float:
        """Bayesian information criterion of a fit whose error variance is unknown."""
        return self.data * np.log(self.variance) + self.parameters * np.log(self.data)

    @property
    def aicc(self) -> float:
        """Akaike's criterion corrected for few data; infinite if there are no degrees of freedom left."""
        left = self.data - self.parameters - 1
        penalty = 2 * self.parameters * self.data / left if left > 0 else np.inf
        return self.data * np.log(self.variance) + penalty


def fit_tables(
    robot: Robot, tables: Tables, chosen: Explanation, settings: TableSettings, effort: Effort, random, **known
) -> ExplanationFit:
    """Search trajectories, wear shape and the parameters of a candidate.

    Parameters
    ----------
    robot : the arm; its payload is left out.
    effort : how long to search.
    random : numpy.random.Generator.
    known : `growth`, `growth_spread` of :class:`TableProblem`, where the hours are not to be used; `outward`, where
        segment times are not to be searched.
    """
    problem = TableProblem(robot, tables, chosen, settings, **known)
    solutions = search(problem, random, effort)
    if "outward" in known:
        return describe(problem, solutions.point[0], solutions.first_cost)
    problem, point = with_segment_times(problem, solutions.point[0], random, effort)
    return describe(problem, point, solutions.first_cost)


def with_segment_times(
    problem: TableProblem, point: np.ndarray, random, effort: Effort
) -> tuple[TableProblem, np.ndarray]:
    """Return problem and free vector after other segment times have been tried for every task."""
    outward = problem.outward.copy()
    changed = point.copy()
    cost = problem.cost_by_task(point[None])[0]
    for task, columns in enumerate(problem.columns_by_task):
        for other in OTHER_OUTWARD:
            trial = replace_outward(problem, task, other).task_alone(task, point)
            best, value = search_task(trial, random, effort)
            # One more parameter must earn more than its share of the criterion.
            if value < cost[task] - np.log(problem.data_count):
                outward[task], changed[columns], cost[task] = other, best, value
    problem = problem.with_outward(outward)
    solution = minimise(problem.residuals, problem.residuals_and_jacobian, changed[None], effort.final)
    return problem, solution.point[0]


def replace_outward(problem: TableProblem, task: int, outward: float) -> TableProblem:
    """Return the problem with another duration of the way out of one task."""
    changed = problem.outward.copy()
    changed[task] = outward
    return problem.with_outward(changed)


def describe(problem: TableProblem, point: np.ndarray, start_cost: np.ndarray) -> ExplanationFit:
    """Turn a free vector (p,) into a :class:`ExplanationFit`."""
    start, stop, phase, shape, effect = (a[0] for a in problem.split(problem.physical(point[None])))
    predicted = problem.predict(point[None])
    residual, jacobian = problem.residuals_and_jacobian(point[None])
    cost = float(0.5 * (residual**2).sum())
    extra = int((problem.outward != SEGMENT).sum())
    parameters = problem.size + extra
    std = np.full(len(effect), np.nan)
    if problem.free_effect and problem.data_count > parameters:
        slope = (problem.upper - problem.lower) / 2 * np.cos(point)
        scaled = jacobian[0] / np.where(np.abs(slope) < 1e-9, np.inf, slope)
        norm = np.sqrt((scaled**2).sum(axis=0))
        norm[norm == 0] = 1.0
        inverse = np.linalg.pinv((scaled / norm).T @ (scaled / norm), rcond=1e-10, hermitian=True)
        covariance = inverse * 2 * cost / (problem.data_count - parameters) / np.outer(norm, norm)
        std = np.sqrt(np.maximum(np.diag(covariance)[-len(effect) :], 0.0))
    return ExplanationFit(
        candidate=problem.candidate.name,
        start=start,
        stop=stop,
        phase=phase,
        outward=problem.outward,
        shape=float(shape),
        effect=effect,
        std=std,
        maximum=predicted.maximum[0],
        variation=predicted.variation[0],
        cost=cost,
        data=problem.data_count,
        parameters=parameters,
        start_cost=np.asarray(start_cost),
    )


def settings_of(options: dict[str, Any]) -> TableSettings:
    """Build :class:`TableSettings` from the config."""
    return (
        TableSettings(**{**options, "shape_range": tuple(options["shape_range"])})
        if "shape_range" in options
        else TableSettings(**options)
    )


def write_fit(path: str | Path, fit: ExplanationFit, tables: Tables, settings: dict[str, Any]) -> None:
    """Write a fit as netCDF."""
    parameters = candidate(fit.candidate).parameters
    axis = ("task", "axis")
    cell = (*axis, "increase")
    variables = {
        "task": Variable(("task",), np.array(tables.tasks), "task"),
        "axis": Variable(("axis",), np.arange(1, fit.start.shape[1] + 1), "axis of the robot", "1"),
        "increase": Variable(("increase",), tables.increase_percent, "growth of the friction", "percent"),
        "start": Variable(axis, fit.start, "position at the start", "rad"),
        "stop": Variable(axis, fit.stop, "position at the stop", "rad"),
        "phase": Variable(("task",), fit.phase, "time of the first sample in the cycle", "s"),
        "outward": Variable(("task",), fit.outward, "duration from start to stop", "s"),
        "maximum": Variable(cell, fit.maximum, "expected largest |torque|", "N m"),
        "variation": Variable(cell, fit.variation, "coefficient of variation of |torque|", "1"),
        "published_maximum": Variable(cell, tables.maximum, "largest |torque| in Table V", "N m"),
        "published_variation": Variable(cell, tables.variation, "coefficient of variation in Table VI", "1"),
        "start_cost": Variable(("search",), fit.start_cost, "cost of every start before exchange", "1"),
    }
    if parameters:
        names = [p.name if p.axis is None else f"{p.name}_{p.axis}" for p in parameters]
        variables["parameter"] = Variable(("parameter",), np.array(names), "number of the candidate")
        variables["effect"] = Variable(("parameter",), fit.effect, "value of the parameter", "1")
        variables["effect_std"] = Variable(("parameter",), fit.std, "standard deviation of the parameter", "1")
    attributes = provenance.attributes(f"fit of the candidate {fit.candidate}", settings)
    attributes |= {
        "candidate": fit.candidate,
        "shape": fit.shape,
        "cost": fit.cost,
        "data": fit.data,
        "parameters": fit.parameters,
        "bic": float(fit.bic),
        "aicc": float(fit.aicc),
    }
    write_dataset(path, variables, attributes)


def read_fit(path: str | Path) -> ExplanationFit:
    """Read a fit.

    Raises
    ------
    InputError : if the file is missing or damaged.
    """
    with open_dataset(path) as data:
        names = ("start", "stop", "phase", "outward", "maximum", "variation", "start_cost")
        arrays = {name: read_variable(data, path, name) for name in names}
        some = "effect" in data.variables
        effect, std = (read_variable(data, path, n) if some else np.zeros(0) for n in ("effect", "effect_std"))
        return ExplanationFit(
            candidate=data.getncattr("candidate"),
            shape=float(data.getncattr("shape")),
            cost=float(data.getncattr("cost")),
            data=int(data.getncattr("data")),
            parameters=int(data.getncattr("parameters")),
            effect=effect,
            std=std,
            **arrays,
        )


def extended(
    robot: Robot, tables: Tables, chosen: Explanation, settings: TableSettings, iterations: int, simpler: ExplanationFit
) -> ExplanationFit:
    """Return the descent of a candidate from the fit of a simpler one, what is new in it at its nominal value."""
    problem = TableProblem(robot, tables, chosen, settings, outward=simpler.outward)
    known = {(p.name, p.axis): v for p, v in zip(candidate(simpler.candidate).parameters, simpler.effect, strict=True)}
    effect = np.array([known.get((p.name, p.axis), p.nominal) for p in chosen.parameters])
    start = problem.join(simpler.start, simpler.stop, simpler.phase, simpler.shape, effect)
    solution = minimise(problem.residuals, problem.residuals_and_jacobian, start[None], iterations)
    return describe(problem, solution.point[0], simpler.start_cost)


def fit_candidate(
    robot: str | Path,
    published: str | Path,
    simpler: Sequence[str | Path],
    output: str | Path,
    name: str,
    settings: dict[str, Any],
) -> None:
    """Fit one candidate to the published tables.

    Parameters
    ----------
    robot, published : robot file of the unloaded arm; file of the published values.
    simpler : fits of the components of a pair, from which it is fitted too, so that it is never worse than they are.
    output : netCDF file.
    name : candidate, such as "payload" or "payload+gravity_scale".
    settings : `seed`, `search` (fields of :class:`Effort`), `comparison` (fields of :class:`TableSettings`).
    """
    tables, arm, chosen = read_tables(published), load_robot(robot), candidate(name)
    comparison, effort = settings_of(settings["comparison"]), Effort(**settings["search"])
    random = generator(settings["seed"], "recover", name, replicate=0)
    best = fit_tables(arm, tables, chosen, comparison, effort, random)
    for path in simpler:
        other = extended(arm, tables, chosen, comparison, effort.final, read_fit(path))
        if other.cost < best.cost:
            best = replace(other, start_cost=best.start_cost)
    write_fit(output, best, tables, settings)
