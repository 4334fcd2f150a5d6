"""Run joint experiments again with random numbers that took no part: fast for many, with all noise for one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.robots.trajectory import Task
from jointwear.studies.joint_fit.detection import Grid, TaskOutcome, detect
from jointwear.studies.joint_fit.distance import Weights, detection_cost, lags, right_pairs, table_cost
from jointwear.studies.joint_fit.divergence import HISTOGRAM_READING
from jointwear.studies.joint_fit.levels import Noise, task_levels
from jointwear.studies.joint_fit.noise_bank import draw_bank
from jointwear.studies.joint_fit.paper import LAG_RUN, LAG_TASK, Paper
from jointwear.studies.joint_fit.paper_fit import JointExperiment
from jointwear.studies.multiverse.choice import median_hour
from jointwear.studies.multiverse.dimensions import Reading
from jointwear.studies.multiverse.evaluation import Analysis, Outcomes, evaluate
from jointwear.studies.multiverse.pose_sets import PoseSet, with_payload
from jointwear.studies.multiverse.shared_torque import SharedExperiment
from jointwear.studies.recovery.candidates import candidate
from jointwear.studies.recovery.problem import TableProblem, TableSettings
from jointwear.studies.recovery.sampled_motion import CYCLE, SEGMENT


@dataclass(frozen=True)
class Confirmed:
    """One experiment on new random numbers; t tasks, c increases, n axes, r replicates.

    `probability`, `hour` (t, c, n): share of replicates that detect, median hour, NaN below half; `maximum`,
    `variation` (2, t, c, n): Tables V and VI at the printed hours and at our own; `signs` (r,): pairs of axes with
    the sign of Table II; `right_pairs` (pairs,): share of replicates in which each pair i < j has it; `kl_maximum`
    (r,) [nat]; `kept` (t, r); `located` share of the detected runs and `alarms` of the normal runs, NaN from the
    fast engine; `distance` from the paper.
    """

    probability: np.ndarray
    hour: np.ndarray
    maximum: np.ndarray
    variation: np.ndarray
    signs: np.ndarray
    right_pairs: np.ndarray
    kl_maximum: np.ndarray
    kept: np.ndarray
    located: float
    alarms: float
    distance: float


def pose_set(robot: Robot, experiment: JointExperiment, tasks: tuple[str, ...], name: str) -> PoseSet:
    """Return arm and tasks of a joint experiment."""
    arm = experiment.arm
    motions = tuple(
        Task(
            task,
            np.stack([experiment.start[t], experiment.stop[t]]),
            np.array([SEGMENT, CYCLE - SEGMENT]),
            float(experiment.phase[t]),
        )
        for t, task in enumerate(tasks)
    )
    return PoseSet(name, Dynamics(with_payload(robot, arm.mass, (0.0, 0.0, arm.offset))), motions)


def full_reading(experiment: JointExperiment, base: Mapping[str, str]) -> Reading:
    """Return every choice of the reading; `base` gives those that the fit leaves alone."""
    reading = experiment.reading
    return {
        **base,
        **HISTOGRAM_READING,
        "scaling": reading.scaling,
        "components": reading.components,
        "wear_shape": experiment.arm.shape,
        "consecutive_hours": reading.consecutive_hours,
    }


def torque_tables(
    robot: Robot, experiment: JointExperiment, paper: Paper, hour: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return Tables V and VI, each (2, t, c, n): at the printed hours, and at `hour` (t, c, n), NaN the last."""
    arm, tables = experiment.arm, paper.tables
    own = np.where(np.isnan(hour), tables.run_hours, hour).swapaxes(1, 2)
    growths = [
        Wear(1.0, arm.shape, tables.run_hours).growth(h) * tables.increase_percent for h in (tables.reading_hours, own)
    ]
    maximum, variation = [], []
    for growth in growths:
        problem = TableProblem(
            robot,
            tables,
            candidate("payload"),
            TableSettings(),
            growth=growth,
            growth_spread=np.zeros_like(growth),
        )
        u = problem.join(
            experiment.start,
            experiment.stop,
            experiment.phase,
            arm.shape,
            np.array([arm.mass, 0.0, 0.0, arm.offset]),
        )
        predicted = problem.predict(u[None])
        maximum.append(predicted.maximum[0].swapaxes(1, 2))
        variation.append(predicted.variation[0].swapaxes(1, 2))
    return np.array(maximum), np.array(variation)


def judged(
    robot: Robot,
    experiment: JointExperiment,
    paper: Paper,
    onset: np.ndarray,
    kept: np.ndarray,
    lag: np.ndarray,
    kl_maximum: np.ndarray,
    weights: Weights,
    located: float = np.nan,
    alarms: float = np.nan,
) -> Confirmed:
    """Hold what an experiment gave against the paper.

    Parameters
    ----------
    onset : (t, c, n, r) hour, NaN where not detected; kept : (t, r); lag : (r, n, n); kl_maximum : (r,).
    """
    tables, reading = paper.tables, experiment.reading
    hour = median_hour(onset)
    maximum, variation = torque_tables(robot, experiment, paper, hour)
    distance = 0.0
    moving = ~tables.at_rest
    for t in range(len(tables.tasks)):
        torque = maximum[0, t].T / np.where(tables.maximum[t] > 0, tables.maximum[t], 1.0) - 1
        spread = variation[0, t].T - tables.variation[t]
        distance += float(table_cost(torque[moving[t]].reshape(1, -1), spread[moving[t]].reshape(1, -1), weights)[0])
        outcome = TaskOutcome({reading: onset[t]}, {reading: kept[t]})
        distance += detection_cost(outcome, paper.target(t), weights)[reading]
    right = right_pairs(lag, paper.lag_sign)
    signs, pairs = right.sum(axis=1), right.shape[1]
    distance += weights.lag * (pairs - float(signs.mean()))
    probability = np.isfinite(onset).mean(axis=-1)
    return Confirmed(
        probability=probability,
        hour=hour,
        maximum=maximum,
        variation=variation,
        signs=signs,
        right_pairs=right.mean(axis=0),
        kl_maximum=kl_maximum,
        kept=kept,
        located=located,
        alarms=alarms,
        distance=distance,
    )


def confirm_fast(
    robot: Robot,
    experiment: JointExperiment,
    paper: Paper,
    seed: int,
    name: str,
    replicates: int,
    grid: Grid,
    noise: Noise,
) -> Confirmed:
    """Run one experiment with the engine of the search; nothing is located and no normal run is judged.

    Parameters
    ----------
    robot : the arm without payload.
    seed, name : key the random numbers.
    """
    dynamics = pose_set(robot, experiment, paper.tables.tasks, name).dynamics
    levels = task_levels(dynamics, experiment.start, experiment.stop, experiment.phase, noise)
    reading = experiment.reading
    outcomes = [
        detect(
            task,
            draw_bank(seed, f"{name} {t}", robot.joints, replicates),
            experiment.arm.shape,
            grid,
            [reading],
            LAG_RUN if t == LAG_TASK else None,
        )
        for t, task in enumerate(levels)
    ]
    series = outcomes[LAG_TASK].series
    return judged(
        robot,
        experiment,
        paper,
        np.stack([f.onset[reading] for f in outcomes]),
        np.stack([f.kept[reading] for f in outcomes]),
        lags(series),
        series.max(axis=(1, 2)),
        Weights(),
    )


def confirm(
    robot: Robot,
    experiment: JointExperiment,
    paper: Paper,
    base: Mapping[str, str],
    settings: SharedExperiment,
    analysis: Analysis,
    name: str,
) -> Confirmed:
    """Run one experiment with the engine of `multiverse`, which has all noise, and locate its wear.

    Parameters
    ----------
    robot : the arm without payload.
    base : reading of the config.
    settings : seed, replicates and noise; `name` keys the random numbers.
    """
    outcomes: Outcomes = evaluate(
        [full_reading(experiment, base)], pose_set(robot, experiment, paper.tables.tasks, name), settings, analysis
    )
    onset = outcomes.onset[0]
    detects = np.isfinite(onset)
    axes = np.array(analysis.axes)[:, None]
    return judged(
        robot,
        experiment,
        paper,
        onset,
        outcomes.kept[0],
        outcomes.lag[0],
        outcomes.kl_maximum[0],
        Weights(),
        float((detects & (outcomes.source[0] == axes)).sum() / max(detects.sum(), 1)),
        float(outcomes.alarms[0].mean()),
    )
