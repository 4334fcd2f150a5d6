"""Why the published way of locating wear works: an experiment with the project's own runs.

The raw cross-correlation of a rising series x with a series y that merely has a positive mean m is, but for noise,
m times the sum of x over the hours that overlap at the lag. Shifted one way, the overlap loses the end of x, where
x is large; shifted the other way, its beginning, where x is small. The maximum therefore lies where x seems to
lead, whatever y does: the sign of the lag says which of the two series rises, not which moved first. With the
means removed m is zero and nothing of this is left.

Four versions of the same runs show it: as they are; with the mean of the other axes removed (m = 0); with time
reversed, so that the worn series falls; and a week of normal operation, in which nothing is worn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.reproduction.detection import onset
from jointwear.reproduction.location import lag_matrix
from jointwear.reproduction.published import load_published
from jointwear.reproduction.readings import lag_sign, select, source_rule
from jointwear.studies.multiverse.batched_model import BatchedModel
from jointwear.studies.multiverse.dimensions import Reading, default_reading
from jointwear.studies.multiverse.evaluation import Analysis
from jointwear.studies.multiverse.pose_sets import PoseSet, configured_pose_set
from jointwear.studies.multiverse.settings import analysis_of, experiment_of
from jointwear.studies.multiverse.shared_features import count_task, divergences
from jointwear.studies.multiverse.shared_torque import SharedExperiment, SharedTask

CORRELATIONS = ("raw", "means_removed")
VERSIONS = {
    "as_they_are": "detected runs as they are",
    "others_centred": "the same, means of the unworn axes removed",
    "reversed_in_time": "the same, time reversed: the worn series falls",
    "normal_week": "no wear, nothing detected",
}


@dataclass(frozen=True)
class LagRule:
    """What the rule names; v versions of the runs, 2 correlations.

    `right`, `wrong`, `nothing` (v, 2): number of runs in which the worn axis, another, or none is named (`right` is
    not counted for a normal week); `runs` (v,). `named` (2, n): how often each axis is named in a normal week.
    `rise_edges` (b + 1,) and `rise_right`, `rise_runs` (2, b), (b,): runs as they are, by how far the worn series
    rises above its training [standard deviations]. `lags` (k,) [h], `observed` (2, k) the mean cross-correlation of the
    worn with the other axes, each over its maximum, and `expected` (k,) what rising alone predicts for the raw one.
    `sign_right` (2,): share of the worn axis' lags that have the sign of a leading axis.
    """

    right: np.ndarray
    wrong: np.ndarray
    nothing: np.ndarray
    runs: np.ndarray
    named: np.ndarray
    rise_edges: np.ndarray
    rise_right: np.ndarray
    rise_runs: np.ndarray
    lags: np.ndarray
    observed: np.ndarray
    expected: np.ndarray
    sign_right: np.ndarray


def cross_correlation(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return sum_t x(t) y(t + lag) for lags 1 - h ... h - 1 of series (..., h), shape (..., 2 h - 1)."""
    h = x.shape[-1]
    product = np.fft.rfft(x, 2 * h).conj() * np.fft.rfft(y, 2 * h)
    full = np.fft.irfft(product, 2 * h)
    return np.concatenate([full[..., h + 1 :], full[..., :h]], axis=-1)


def rising_alone(x: np.ndarray, mean: np.ndarray) -> np.ndarray:
    """Return the cross-correlation that series x (..., h) has with a constant `mean` (...), shape (..., 2 h - 1)."""
    return cross_correlation(x, np.broadcast_to(np.asarray(mean)[..., None], x.shape))


def named_axis(series: np.ndarray, correlation: str, reading: Mapping[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Return lags (r, n, n) and the axis (r,) that the rule names in whole runs (r, hours, n)."""
    lag = lag_matrix(series, np.ones(series.shape[:2], dtype=bool), correlation, reading["lag_peak"])
    lag = select(lag_sign, reading["lag_sign"])(lag)
    return lag, select(source_rule, reading["source_rule"])(lag)


def _runs(poses: PoseSet, experiment: SharedExperiment, analysis: Analysis, reading: Reading):
    """Yield (worn axis or 0, KL series, onset, training mean, training spread) of all runs of the pose set."""
    for task in poses.tasks:
        shared = SharedTask(poses.dynamics, task, experiment, reading, ("lag rule", poses.name, task.name))
        counts = count_task(
            shared, list(analysis.axes), list(analysis.increases), reading["wear_shape"], analysis.bins, reading
        )
        series = divergences(counts, reading, shared.leaks)
        model = BatchedModel(series.training, analysis.confidence, analysis.variance_share, reading)
        mean, spread = series.training.mean(axis=1), series.training.std(axis=1, ddof=1)
        spread[spread == 0] = 1.0
        rule, count = reading["onset_rule"], reading["consecutive_hours"]
        for (axis, _), run in series.worn.items():
            yield axis, run, onset(model.above(run), rule, count), mean, spread
        hours = experiment.wear_hours
        yield 0, series.normal[:, :hours], np.full(len(mean), np.nan), mean, spread


def explain(poses: PoseSet, experiment: SharedExperiment, analysis: Analysis, reading: Reading) -> LagRule:
    """Run the experiment. Detection follows the reading with the KL divergence as input of the PCA."""
    reading = {**reading, "pca_input": "kl_divergence"}
    n = len(analysis.axes)
    versions = list(VERSIONS)
    right, wrong, nothing = (np.zeros((len(versions), 2), dtype=int) for _ in range(3))
    runs, named = np.zeros(len(versions), dtype=int), np.zeros((2, n), dtype=int)
    rises: list[np.ndarray] = []
    hits: list[np.ndarray] = []
    curves: list[np.ndarray] = []
    predicted: list[np.ndarray] = []
    signs = np.zeros((2, 2), dtype=int)

    for axis, whole, hour, mean, spread in _runs(poses, experiment, analysis, reading):
        if axis == 0:
            v = versions.index("normal_week")
            runs[v] += len(whole)
            for k, correlation in enumerate(CORRELATIONS):
                _, source = named_axis(whole, correlation, reading)
                named[k] += np.bincount(source, minlength=n + 1)[1:]
                wrong[v, k] += (source > 0).sum()
                nothing[v, k] += (source == 0).sum()
            continue
        detected = np.isfinite(hour)
        series, j = whole[detected], axis - 1
        if not len(series):
            continue
        others = [i for i in range(n) if i != j]
        centred = series.copy()
        centred[:, :, others] -= centred[:, :, others].mean(axis=1, keepdims=True)
        hit = np.zeros((2, len(series)), dtype=bool)
        for name, version in (
            ("as_they_are", series),
            ("others_centred", centred),
            ("reversed_in_time", series[:, ::-1]),
        ):
            v = versions.index(name)
            runs[v] += len(version)
            for k, correlation in enumerate(CORRELATIONS):
                lag, source = named_axis(version, correlation, reading)
                right[v, k] += (source == axis).sum()
                wrong[v, k] += ((source > 0) & (source != axis)).sum()
                nothing[v, k] += (source == 0).sum()
                if name == "as_they_are":
                    hit[k] = source == axis
                    toward = -np.sign(lag[:, j, others]) * (1 if reading["lag_sign"] == "equation_5" else -1)
                    signs[k] += [(toward >= 0).sum(), toward.size]
        last = series[:, -24:, j].mean(axis=1)
        rises.append((last - mean[detected, j]) / spread[detected, j])
        hits.append(hit)
        both = (series, series - series.mean(axis=1, keepdims=True))
        both = [np.moveaxis(s, 1, 2) for s in both]
        curve = np.stack([cross_correlation(s[:, j, None], s[:, others]) for s in both])
        # Pairs with an axis whose divergence is always zero have no correlation to show.
        scale = np.abs(curve).max(axis=-1, keepdims=True)
        alive = (scale > 0).all(axis=0)[..., 0]
        curves.append((curve / np.where(scale > 0, scale, 1))[:, alive])
        alone = rising_alone(np.repeat(both[0][:, j, None], n - 1, axis=1), both[0][:, others].mean(axis=-1))
        predicted.append((alone / np.where(scale[0] > 0, scale[0], 1))[alive])

    hours = experiment.wear_hours
    if rises:
        rise, hit = np.concatenate(rises), np.concatenate(hits, axis=1)
        edges = np.array([-np.inf, 0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, np.inf])
        place = np.digitize(rise, edges[1:-1])
        rise_runs = np.bincount(place, minlength=len(edges) - 1)
        rise_right = np.stack([np.bincount(place[h], minlength=len(edges) - 1) for h in hit])
        observed = np.concatenate(curves, axis=1).mean(axis=1)
        expected = np.concatenate(predicted).mean(axis=0)
    else:
        edges = np.array([-np.inf, np.inf])
        rise_runs, rise_right = np.zeros(1, dtype=int), np.zeros((2, 1), dtype=int)
        observed, expected = np.zeros((2, 2 * hours - 1)), np.zeros(2 * hours - 1)
    share = np.divide(signs[:, 0], signs[:, 1], out=np.full(2, np.nan), where=signs[:, 1] > 0)
    lags = np.arange(1 - hours, hours)
    return LagRule(
        right=right,
        wrong=wrong,
        nothing=nothing,
        runs=runs,
        named=named,
        rise_edges=edges,
        rise_right=rise_right,
        rise_runs=rise_runs,
        lags=lags,
        observed=observed,
        expected=expected,
        sign_right=share,
    )


def write_lag_rule(
    robot: str | Path,
    tasks: Sequence[str | Path],
    published: str | Path,
    output: str | Path,
    settings: Mapping[str, Any],
) -> None:
    """Run the experiment on the configured pose set with the configured reading.

    Parameters
    ----------
    settings : of :func:`jointwear.studies.multiverse.settings.experiment_of` and `analysis_of`; `replicates`,
        `reading`, `wear_shape`, `consecutive_hours`.
    """
    analysis = analysis_of(settings, load_published(published))
    reading = default_reading(settings["reading"], settings["wear_shape"], settings["consecutive_hours"])
    explained = explain(
        configured_pose_set(robot, tasks), experiment_of(settings, settings["replicates"]), analysis, reading
    )
    by, of = ("version", "correlation"), ("correlation",)
    write_dataset(
        output,
        {
            "version": Variable(("version",), np.array(list(VERSIONS)), "version of the runs"),
            "correlation": Variable(of, np.array(CORRELATIONS), "cross-correlation"),
            "axis": Variable(("axis",), np.array(analysis.axes), "axis of the robot", "1"),
            "right": Variable(by, explained.right, "runs in which the worn axis is named", "1"),
            "wrong": Variable(by, explained.wrong, "runs in which another axis is named", "1"),
            "nothing": Variable(by, explained.nothing, "runs in which no axis is named", "1"),
            "runs": Variable(("version",), explained.runs, "runs", "1"),
            "named": Variable(("correlation", "axis"), explained.named, "normal weeks in which the axis is named", "1"),
            "rise_low": Variable(("rise",), explained.rise_edges[:-1], "least rise, in deviations of training", "1"),
            "rise_high": Variable(("rise",), explained.rise_edges[1:], "largest rise, in deviations of training", "1"),
            "rise_runs": Variable(("rise",), explained.rise_runs, "detected runs with this rise", "1"),
            "rise_right": Variable(("correlation", "rise"), explained.rise_right, "of these, worn axis named", "1"),
            "lag": Variable(("lag",), explained.lags, "lag of the other axis", "h"),
            "observed": Variable(("correlation", "lag"), explained.observed, "mean correlation, over its maximum", "1"),
            "expected": Variable(("lag",), explained.expected, "raw correlation that rising alone predicts", "1"),
            "sign_right": Variable(of, explained.sign_right, "lags of the worn axis with the sign of leading", "1"),
        },
        provenance.attributes("why the lag rule works, and when", settings),
    )
