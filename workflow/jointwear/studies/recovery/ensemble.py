"""Many different pose sets that reproduce the tables equally well."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, write_dataset
from jointwear.reproduction.wear import Wear
from jointwear.robots.robot import Robot, load_robot
from jointwear.statistics.randomness import generator
from jointwear.studies.recovery.candidates import candidate
from jointwear.studies.recovery.fit import OTHER_OUTWARD, ExplanationFit, read_fit, settings_of
from jointwear.studies.recovery.least_squares import minimise
from jointwear.studies.recovery.problem import TableProblem, TableSettings
from jointwear.studies.recovery.search import Effort, screened_start, search_task
from jointwear.studies.recovery.tables import TORQUE_ROUNDING, Tables, read_tables

#: Fewest pose sets from which a spread is told.
FEWEST_POSE_SETS = 10
#: Difference [rad] in some moving joint of every task that makes two solutions distinct.
LEAST = np.radians(10.0)
#: Random starts of a task, iterations of its fit, and rounds at most.
STARTS, ITERATIONS, ROUNDS = 120, 120, 60


@dataclass(frozen=True)
class Tolerance:
    """Largest error of any cell and of the median: of the maximum as a share, of the coefficient of variation."""

    torque: float = 0.05
    variation: float = 0.05
    median_torque: float = 0.01
    median_variation: float = 0.01


@dataclass(frozen=True)
class Ensemble:
    """S solutions: `start`, `stop` (S, t, n), `phase` (S, t), `outward` (t,), `shape` (S,), `effect` (S, p), `cost`
    (S,), `maximum` and `variation` (S, t, n, c).
    """

    start: np.ndarray
    stop: np.ndarray
    phase: np.ndarray
    outward: np.ndarray
    shape: np.ndarray
    effect: np.ndarray
    cost: np.ndarray
    maximum: np.ndarray
    variation: np.ndarray


def errors(
    tables: Tables, maximum: np.ndarray, variation: np.ndarray, widened: tuple | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return errors of the cells that move, (S, cells) twice, and whether the resting axes stay at 0.000, (S,).

    Parameters
    ----------
    maximum, variation : predicted, (S, t, n, c).
    widened : factors (t, n, c) >= 1 of both tables by which an error is divided, where the hours are unknown.
    """
    moving, count = ~tables.at_rest, len(maximum)
    torque = np.abs(maximum / np.where(tables.maximum > 0, tables.maximum, 1.0) - 1)
    spread = np.abs(variation - tables.variation)
    if widened is not None:
        torque, spread = torque / widened[0], spread / widened[1]
    still = np.all(maximum[:, ~moving].reshape(count, -1) < TORQUE_ROUNDING, axis=1)
    return torque[:, moving].reshape(count, -1), spread[:, moving].reshape(count, -1), still


def within(
    tables: Tables, maximum: np.ndarray, variation: np.ndarray, tolerance: Tolerance, widened: tuple | None = None
) -> np.ndarray:
    """Return (S,) whether a solution reproduces the tables; arguments as :func:`errors`."""
    torque, spread, still = errors(tables, maximum, variation, widened)
    return (
        still
        & np.all(torque <= tolerance.torque, axis=1)
        & np.all(spread <= tolerance.variation, axis=1)
        & (np.median(torque, axis=1) <= tolerance.median_torque)
        & (np.median(spread, axis=1) <= tolerance.median_variation)
    )


def distance(start: np.ndarray, stop: np.ndarray, other_start: np.ndarray, other_stop: np.ndarray) -> np.ndarray:
    """Return by how much the tasks differ, (..., t) [rad]: the largest difference over joints.

    The position of axis 1 is arbitrary, since gravity does not see it, and so is that of an axis that does not
    move: only its span counts for the first, nothing for the second.
    """
    first, second = stop - start, other_stop - other_start
    moving = (np.abs(first) > np.radians(1)) & (np.abs(second) > np.radians(1))
    # Either end may be called the start.
    best = None
    for a, b in ((other_start, other_stop), (other_stop, other_start)):
        gap = np.maximum(np.abs(start - a), np.abs(stop - b))
        gap[..., 0] = np.abs(first - (b - a))[..., 0]
        gap = np.where(moving, gap, 0.0).max(axis=-1)
        best = gap if best is None else np.minimum(best, gap)
    return best


def distinct(start: np.ndarray, stop: np.ndarray, least: float) -> list[int]:
    """Return which of the solutions (S, t, n) differ from all earlier chosen ones by `least` [rad] in every task."""
    chosen: list[int] = []
    for k in range(len(start)):
        if all(np.all(distance(start[k], stop[k], start[j], stop[j]) > least) for j in chosen):
            chosen.append(k)
    return chosen


def unknown_growth(tables: Tables, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and standard deviation (t, n, c) of the friction's growth if nothing is known about the hours.

    A cell was read at hour 120 with probability 1/2 (not detected), else at any hour alike; every wear shape of
    `shapes` is as likely as the others.
    """
    hours = np.arange(1, int(tables.run_hours) + 1)
    grown = np.array([Wear(1.0, s, tables.run_hours).growth(hours) for s in shapes])
    final = np.array([Wear(1.0, s, tables.run_hours).growth(tables.run_hours) for s in shapes])
    mean = 0.5 * grown.mean() + 0.5 * final.mean()
    square = 0.5 * (grown**2).mean() + 0.5 * (final**2).mean()
    size = np.broadcast_to(tables.increase_percent, tables.maximum.shape)
    return size * mean, size * np.sqrt(square - mean**2)


def draw_effect(fit: ExplanationFit, settings: TableSettings, random: np.random.Generator, count: int) -> np.ndarray:
    """Return (count, 1 + p) wear shapes and parameters spread around the fit; a payload stays on the tool axis."""
    parameters = candidate(fit.candidate).parameters
    low, high = settings.shape_range
    shape = np.clip(fit.shape * np.exp(0.2 * random.standard_normal(count)), low, high)
    effect = np.empty((count, len(parameters)))
    for k, p in enumerate(parameters):
        value = fit.effect[k]
        if p.name in ("com_x", "com_y"):
            effect[:, k] = 0.0
        else:
            effect[:, k] = np.clip(value * np.exp(0.25 * random.standard_normal(count)), p.lower, p.upper)
    return np.column_stack([shape, effect])


def build_ensemble(
    robot: Robot,
    tables: Tables,
    fit: ExplanationFit,
    settings: TableSettings,
    random: np.random.Generator,
    wanted: int,
    tolerance: Tolerance,
    growth: np.ndarray | None = None,
    growth_spread: np.ndarray | None = None,
) -> Ensemble:
    """Return up to `wanted` solutions from independent starts that are within tolerance and distinct.

    Every round draws another payload and wear shape near the fit and holds them; each task then is
    fitted from :data:`STARTS` new random starts, of which the best quarter goes on. Solutions of equal rank make one
    pose set, which is fitted again as a whole with everything free.

    Parameters
    ----------
    growth, growth_spread : as of :class:`TableProblem`, where the hours are not to be used.
    """
    chosen = candidate(fit.candidate)
    known = {"growth": growth, "growth_spread": growth_spread}
    first = TableProblem(robot, tables, chosen, settings, outward=fit.outward, **known)
    outward = tolerable_segment_times(first, fit, tolerance, random)
    whole = first.with_outward(outward)
    widened = whole.widened
    kept: list[np.ndarray] = []
    for _ in range(ROUNDS):
        common = draw_effect(fit, settings, random, 1)[0]
        ranked = []
        for task in range(len(tables.tasks)):
            part = slice(task, task + 1)
            alone = TableProblem(
                robot,
                tables.task_subset([task]),
                chosen,
                settings,
                frozen=common,
                growth=None if growth is None else growth[part],
                growth_spread=None if growth_spread is None else growth_spread[part],
                outward=outward[part],
            )
            start = screened_start(alone, random, STARTS, draws=20)
            found = minimise(alone.residuals, alone.residuals_and_jacobian, start, ITERATIONS // 3)
            better = found.point[np.argsort(found.cost)[: STARTS // 4]]
            found = minimise(alone.residuals, alone.residuals_and_jacobian, better, ITERATIONS)
            order = np.argsort(found.cost)
            point = found.point[order]
            begin, end = alone.split(alone.physical(point))[:2]
            ranked.append(point[distinct(begin, end, LEAST)])
        sets = min(6, *(len(r) for r in ranked))
        point = np.zeros((sets, whole.size))
        for task, columns in enumerate(whole.columns_by_task):
            point[:, columns] = ranked[task][:sets]
        rest = common[1:] if growth is not None else common
        point[:, whole.trajectory_count :] = _free_rest(whole, rest)
        found = minimise(whole.residuals, whole.residuals_and_jacobian, point, ITERATIONS // 2)
        predicted = whole.predict(found.point)
        good = within(tables, predicted.maximum, predicted.variation, tolerance, widened)
        kept += list(found.point[good])
        if kept:
            begin, end = whole.split(whole.physical(np.array(kept)))[:2]
            kept = [kept[k] for k in distinct(begin, end, LEAST)]
        if len(kept) >= wanted:
            break
    point = np.array(kept[:wanted]).reshape(-1, whole.size)
    start, stop, phase, shape, effect = whole.split(whole.physical(point))
    predicted = whole.predict(point)
    cost = 0.5 * (whole.residuals(point) ** 2).sum(axis=1)
    return Ensemble(
        start=start,
        stop=stop,
        phase=phase,
        outward=outward,
        shape=shape,
        effect=effect,
        cost=cost,
        maximum=predicted.maximum,
        variation=predicted.variation,
    )


def tolerable_segment_times(
    problem: TableProblem, fit: ExplanationFit, tolerance: Tolerance, random: np.random.Generator
) -> np.ndarray:
    """Return (t,) durations of the way out [s]: those of the fit, unless a cell then stays beyond tolerance.

    In that case the duration is taken whose worst cell is best. The criterion that counts parameters
    does not ask for it, the tolerance of every single cell may.
    """
    outward = problem.outward.copy()
    common = np.concatenate([[fit.shape], fit.effect])
    for task in range(len(outward)):
        worst: dict[float, float] = {}
        for option in dict.fromkeys((outward[task], *OTHER_OUTWARD)):
            changed = outward.copy()
            changed[task] = option
            point = np.zeros(problem.size)
            rest = common[1:] if problem.growth is not None else common
            point[problem.trajectory_count :] = _free_rest(problem, rest)
            alone = problem.with_outward(changed).task_alone(task, point)
            found, _ = search_task(alone, random, Effort())
            predicted = alone.predict(found[None])
            torque, spread, _ = errors(alone.tables, predicted.maximum, predicted.variation, alone.widened)
            worst[option] = max(torque.max() / tolerance.torque, spread.max() / tolerance.variation)
            if worst[option] < 0.98:
                break
        outward[task] = min(worst, key=worst.get)
    return outward


def _free_rest(problem: TableProblem, values: np.ndarray) -> np.ndarray:
    theta = np.zeros(problem.size)
    theta[: problem.trajectory_count] = ((problem.upper + problem.lower) / 2)[: problem.trajectory_count]
    theta[problem.trajectory_count :] = values
    return problem.free(theta)[problem.trajectory_count :]


def write_ensemble(
    path: str | Path, ensemble: Ensemble, tables: Tables, fit: ExplanationFit, settings: dict[str, Any]
) -> None:
    """Write an ensemble as netCDF."""
    pose, cell = ("solution", "task", "axis"), ("solution", "task", "axis", "increase")
    names = [p.name if p.axis is None else f"{p.name}_{p.axis}" for p in candidate(fit.candidate).parameters]
    n = ensemble.start.shape[2]
    variables = {
        "solution": Variable(("solution",), np.arange(1, len(ensemble.cost) + 1), "number of the solution", "1"),
        "task": Variable(("task",), np.array(tables.tasks), "task"),
        "axis": Variable(("axis",), np.arange(1, n + 1), "axis of the robot", "1"),
        "increase": Variable(("increase",), tables.increase_percent, "growth of the friction", "percent"),
        "parameter": Variable(("parameter",), np.array(names), "number of the candidate"),
        "start": Variable(pose, ensemble.start, "position at the start", "rad"),
        "stop": Variable(pose, ensemble.stop, "position at the stop", "rad"),
        "phase": Variable(("solution", "task"), ensemble.phase, "time of the first sample in the cycle", "s"),
        "outward": Variable(("task",), ensemble.outward, "duration from start to stop", "s"),
        "shape": Variable(("solution",), ensemble.shape, "wear shape, 0 where the hours were not used", "1"),
        "effect": Variable(("solution", "parameter"), ensemble.effect, "value of the parameter", "1"),
        "cost": Variable(("solution",), ensemble.cost, "half the weighted sum of squares", "1"),
        "maximum": Variable(cell, ensemble.maximum, "expected largest |torque|", "N m"),
        "variation": Variable(cell, ensemble.variation, "coefficient of variation of |torque|", "1"),
    }
    attributes = provenance.attributes("pose sets that reproduce Tables V and VI", settings)
    write_dataset(path, variables, {**attributes, "candidate": fit.candidate})


def collect_solutions(
    robot: str | Path, published: str | Path, fit: str | Path, output: str | Path, settings: dict[str, Any]
) -> None:
    """Build the ensemble around a fit and write it.

    Parameters
    ----------
    settings : `seed`, `solutions` (how many are wanted; fewer are taken where no more are found), `comparison` (fields
        of Settings), `tolerance` (fields of Tolerance), `hours` ("published" or "unknown").

    Raises
    ------
    InputError : if fewer than FEWEST_POSE_SETS solutions were found.
    """
    tables, best_fit = read_tables(published), read_fit(fit)
    comparison = settings_of(settings["comparison"])
    growth: tuple = (None, None)
    if settings["hours"] == "unknown":
        growth = unknown_growth(tables, np.linspace(1.0, 4.0, 13))
    ensemble = build_ensemble(
        load_robot(robot),
        tables,
        best_fit,
        comparison,
        generator(settings["seed"], "ensemble", settings["hours"], replicate=0),
        settings["solutions"],
        Tolerance(**settings["tolerance"]),
        growth=growth[0],
        growth_spread=growth[1],
    )
    if len(ensemble.cost) < min(FEWEST_POSE_SETS, settings["solutions"]):
        raise InputError(
            f"recover: only {len(ensemble.cost)} of {settings['solutions']} solutions were found, fewer than "
            f"{FEWEST_POSE_SETS} tell no spread; search from more starts (recover.search.starts) or allow more "
            "(recover.tolerance)"
        )
    write_ensemble(output, ensemble, tables, best_fit, settings)
