"""What sharing saves: the same readings done one at a time through the workflow's own functions."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointwear.reproduction.detection import alarms, onset, score
from jointwear.reproduction.features import build_reference, hourly_features
from jointwear.reproduction.location import locate
from jointwear.reproduction.normal_model import fit_normal_model
from jointwear.reproduction.readings import pca_input, select, training_length
from jointwear.reproduction.simulation import Noise, RepeatedTask
from jointwear.reproduction.wear import Wear
from jointwear.reproduction.worn_run import coulomb_levels
from jointwear.statistics.randomness import generator
from jointwear.studies.multiverse.dimensions import Reading
from jointwear.studies.multiverse.evaluation import Analysis, evaluate
from jointwear.studies.multiverse.pose_sets import PoseSet
from jointwear.studies.multiverse.shared_torque import SharedExperiment


def evaluate_alone(reading: Reading, poses: PoseSet, experiment: SharedExperiment, analysis: Analysis) -> np.ndarray:
    """Run one reading without sharing anything: one simulation for every run, one PCA for every replicate.

    Returns
    -------
    (t, c, n, r) hour of detection, NaN where none.
    """
    e = experiment
    noise = Noise(e.disturbance_share, e.encoder, e.time_step, reading)
    choose = select(pca_input, reading["pca_input"])
    rule, count = reading["onset_rule"], reading["consecutive_hours"]
    result = np.full((len(poses.tasks), len(analysis.increases), len(analysis.axes), e.replicates), np.nan)

    for t, task in enumerate(poses.tasks):

        def simulate(hours: int, *key: str | int, axis: int | None = None, increase: float = 0.0) -> np.ndarray:
            wear = None if axis is None else Wear(increase, reading["wear_shape"], e.wear_hours)
            levels = coulomb_levels(poses.dynamics, np.arange(1, hours + 1), axis, wear)
            run = RepeatedTask(poses.dynamics, task, levels, noise, e.interval, e.samples)  # noqa: B023
            parts = [
                run.measure(generator(e.seed, "naive", *key, task.name, replicate=r))  # noqa: B023
                for r in range(e.replicates)
            ]
            return np.stack(parts)

        torque = simulate(select(training_length, reading["training_length"])(), "training")
        reference = build_reference(torque, analysis.bins, reading)
        training = hourly_features(torque, reference, analysis.bins, reading)
        model = fit_normal_model(choose(training), analysis.confidence, analysis.variance_share, reading)
        mean, spread = (f(training["kl_divergence"], axis=1) for f in (np.mean, np.std))
        spread = np.where(spread == 0, 1.0, spread)
        normal = hourly_features(simulate(e.normal_hours, "normal"), reference, analysis.bins, reading)
        alarms(score(choose(normal), model)[0] > model.q_limit[:, None], rule, count)
        for c, increase in enumerate(analysis.increases):
            for k, axis in enumerate(analysis.axes):
                torque = simulate(e.wear_hours, "wear", axis, round(increase * 1000), axis=axis, increase=increase)
                features = hourly_features(torque, reference, analysis.bins, reading)
                q, _ = score(choose(features), model)
                result[t, c, k] = onset(q > model.q_limit[:, None], rule, count)
                locate(features, result[t, c, k], mean, spread, reading)
    return result


def measure_sharing(
    readings: Sequence[Reading],
    poses: PoseSet,
    experiment: SharedExperiment,
    analysis: Analysis,
    sample: int = 3,
    replicates: int = 4,
) -> dict[str, float]:
    """Time the readings with sharing, and a sample of them one at a time.

    Parameters
    ----------
    readings : those that share; the sample is spread evenly over them.
    replicates : of both, so that the measurement stays short.

    Returns
    -------
    `shared_seconds` and `naive_seconds` for one reading and replicate (processor time of one thread), `ratio`.
    """
    experiment = replace(experiment, replicates=replicates)
    start = time.process_time()
    evaluate(readings, poses, experiment, analysis)
    shared = (time.process_time() - start) / len(readings) / replicates
    chosen = [readings[round(i * (len(readings) - 1) / max(sample - 1, 1))] for i in range(sample)]
    start = time.process_time()
    for reading in chosen:
        evaluate_alone(reading, poses, experiment, analysis)
    naive = (time.process_time() - start) / len(chosen) / replicates
    return {
        "readings": float(len(readings)),
        "sample": float(sample),
        "replicates": float(replicates),
        "shared_seconds": shared,
        "naive_seconds": naive,
        "ratio": naive / shared,
    }
