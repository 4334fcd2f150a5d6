"""Run many readings on one pose set: simulations, histograms, divergences and models are shared where they can."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from jointwear.reproduction.detection import alarms, onset
from jointwear.reproduction.location import locate
from jointwear.reproduction.readings import pca_input, select
from jointwear.studies.multiverse.batched_model import BatchedModel
from jointwear.studies.multiverse.dimensions import SIMULATION, Reading, part, stage_names
from jointwear.studies.multiverse.pose_sets import PoseSet
from jointwear.studies.multiverse.shared_features import as_histogram, count_task, divergences
from jointwear.studies.multiverse.shared_torque import SharedExperiment, SharedTask

# Readings that agree in these share histograms; in these too, divergences; in these too, the normal model.
COUNTED = ("wear_shape", "torque_normalisation", "torque_sign", "out_of_range")
_DIVERGED = tuple(name for name in stage_names("features") if name not in COUNTED)
_MODELLED = tuple(name for name in stage_names("detection") if name != "onset_rule")


@dataclass(frozen=True)
class Analysis:
    """What the analysis does not leave open: `bins`, `confidence`, `variance_share`; axes and increases of wear."""

    bins: int = 12
    confidence: float = 0.95
    variance_share: float = 0.75
    axes: tuple[int, ...] = (1, 2, 3, 4, 5, 6)
    increases: tuple[float, ...] = (10.0, 20.0)
    lag_task: str = "T1"
    lag_axis: int = 1
    lag_increase: float = 10.0
    rest_task: str = "T1"
    rest_axis: int = 6


@dataclass
class Outcomes:
    """What readings m gave on one pose set with r replicates; t tasks, c increases, n axes.

    `onset` (m, t, c, n, r) hour, NaN where not detected; `source` (m, t, c, n, r) axis named, 0 none;
    `kept` (m, t, r) components; `alarms` (m, t, r) of the normal run; `above` (m, t, r) share of its hours
    above the limit; `normal_source` (m, t, r) axis named in the normal run; `kl_maximum` (m, r) largest KL
    divergence [nat] of the run of Table II; `lag` (m, r, n, n) its lags [h]; `rest_torque` (m, r) largest |torque|
    [N m] in an hour of the axis that Table V shows at rest, NaN if the task was not run.
    """

    onset: np.ndarray
    source: np.ndarray
    kept: np.ndarray
    alarms: np.ndarray
    above: np.ndarray
    normal_source: np.ndarray
    kl_maximum: np.ndarray
    lag: np.ndarray
    rest_torque: np.ndarray

    @classmethod
    def empty(cls, readings: int, tasks: int, increases: int, axes: int, replicates: int) -> Outcomes:
        """Return outcomes that wait to be filled in."""
        cells, each = (readings, tasks, increases, axes, replicates), (readings, tasks, replicates)
        return cls(
            np.full(cells, np.nan, dtype=np.float32),
            np.zeros(cells, dtype=np.int8),
            np.zeros(each, dtype=np.int8),
            np.zeros(each, dtype=np.int16),
            np.zeros(each, dtype=np.float32),
            np.zeros(each, dtype=np.int8),
            np.full((readings, replicates), np.nan, dtype=np.float32),
            np.zeros((readings, replicates, axes, axes), dtype=np.int16),
            np.full((readings, replicates), np.nan, dtype=np.float32),
        )


def _grouped(indices: Sequence[int], readings: Sequence[Reading], names: tuple[str, ...]):
    """Yield groups of indices whose readings agree in the dimensions `names`."""

    def key(i: int) -> tuple:
        return tuple(str(v) for v in part(readings[i], names))

    for _, group in groupby(sorted(indices, key=key), key=key):
        yield list(group)


def evaluate(readings: Sequence[Reading], poses: PoseSet, experiment: SharedExperiment, analysis: Analysis) -> Outcomes:
    """Run every reading on one pose set.

    The work is nested: one simulation for all readings that agree in the dimensions of :data:`SIMULATION`, one
    set of histograms for those that also agree in :data:`COUNTED`, one set of divergences, one normal model.
    """
    result = Outcomes.empty(
        len(readings), len(poses.tasks), len(analysis.increases), len(analysis.axes), experiment.replicates
    )
    for simulated in _grouped(range(len(readings)), readings, SIMULATION):
        for t, task in enumerate(poses.tasks):
            shared = SharedTask(poses.dynamics, task, experiment, readings[simulated[0]], (poses.name, task.name))
            for counted in _grouped(simulated, readings, COUNTED):
                _evaluate_counted(result, counted, t, task.name, readings, shared, analysis)
    return result


def _evaluate_counted(
    result: Outcomes,
    group: list[int],
    t: int,
    task: str,
    readings: Sequence[Reading],
    shared: SharedTask,
    analysis: Analysis,
) -> None:
    """Fill in the readings of one set of histograms."""
    reading = readings[group[0]]
    axes, increases = list(analysis.axes), list(analysis.increases)
    counts = count_task(shared, axes, increases, reading["wear_shape"], analysis.bins, reading)
    cells = [(axis, increase) for increase in increases for axis in axes]
    lag_cell = (analysis.lag_axis, analysis.lag_increase)
    lag_run = cells.index(lag_cell) if task == analysis.lag_task and lag_cell in cells else None
    if task == analysis.rest_task:
        result.rest_torque[group] = counts.normal_plain["maximum_torque"][:, -1, analysis.rest_axis - 1]
    for same in _grouped(group, readings, _DIVERGED):
        series = divergences(counts, readings[same[0]], shared.leaks)
        if lag_run is not None:
            result.kl_maximum[same] = series.worn[lag_cell].max(axis=(1, 2))
        mean, spread = series.training.mean(axis=1), series.training.std(axis=1, ddof=1)
        spread[spread == 0] = 1.0
        runs = [_Features(counts.worn[cell], series.worn[cell], counts.worn_plain[cell]) for cell in cells] + [
            _Features(counts.normal, series.normal, counts.normal_plain)
        ]
        training = _Features(counts.training, series.training, counts.training_plain)
        for modelled in _grouped(same, readings, _MODELLED):
            reading = readings[modelled[0]]
            choose = select(pca_input, reading["pca_input"])
            model = BatchedModel(choose(training), analysis.confidence, analysis.variance_share, reading)
            above = [model.above(choose(run)) for run in runs]
            for m in modelled:
                result.kept[m, t] = model.kept
                result.above[m, t] = above[-1].mean(axis=1)
                _decide(result, m, t, readings[m], runs, above, mean, spread, lag_run)


def _decide(result, m, t, reading, runs, above, mean, spread, lag_run) -> None:
    """Fill in onset, alarms and location of one reading in one task."""
    rule, count = reading["onset_rule"], reading["consecutive_hours"]
    onsets = [onset(a, rule, count) for a in above]
    replicates = len(onsets[0])
    shape = result.onset.shape[2:]
    result.onset[m, t] = np.stack(onsets[:-1]).reshape(shape)
    result.alarms[m, t] = alarms(above[-1], rule, count)
    names = ("kl_divergence", "mean_absolute_torque")
    hours = runs[0]["kl_divergence"].shape[1]
    stacked = {name: np.concatenate([run[name][:, :hours] for run in runs]) for name in names}
    # In a normal week nothing is detected, so that the whole run is correlated.
    onsets[-1] = np.full(replicates, np.nan)
    lag, source = locate(
        stacked,
        np.concatenate(onsets),
        np.tile(mean, (len(runs), 1)),
        np.tile(spread, (len(runs), 1)),
        reading,
    )
    source = source.reshape(len(runs), replicates)
    result.source[m, t] = source[:-1].reshape(shape)
    result.normal_source[m, t] = source[-1]
    if lag_run is not None:
        result.lag[m] = lag[lag_run * replicates : (lag_run + 1) * replicates]


class _Features(dict):
    """Series of one run by name; its histograms are made when a reading asks for them."""

    def __init__(self, counts: np.ndarray, divergence: np.ndarray, plain: Mapping[str, np.ndarray]) -> None:
        super().__init__(plain, kl_divergence=divergence)
        self._counts = counts

    def __missing__(self, name: str) -> np.ndarray:
        self[name] = as_histogram(self._counts)
        return self[name]
