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
#: Edges of the rises of the worn series that runs are told apart by [standard deviations of training].
RISES = np.array([-np.inf, 0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, np.inf])


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


class _Tally:
    """Which axes the rule names, counted run by run: the arrays of that name of :class:`LagRule`, and
    `signs` (2, 2), of each correlation: lags of the worn axis with the sign of a leading one, and all of them."""

    def __init__(self, axes: int, reading: Mapping[str, str]) -> None:
        self.right, self.wrong, self.nothing = (np.zeros((len(VERSIONS), 2), dtype=int) for _ in range(3))
        self.runs, self.named = np.zeros(len(VERSIONS), dtype=int), np.zeros((2, axes), dtype=int)
        self.signs = np.zeros((2, 2), dtype=int)
        self._reading = reading

    def add_normal_week(self, series: np.ndarray) -> None:
        """Count runs (r, hours, n) without wear."""
        v = list(VERSIONS).index("normal_week")
        self.runs[v] += len(series)
        for k, correlation in enumerate(CORRELATIONS):
            _, source = named_axis(series, correlation, self._reading)
            self.named[k] += np.bincount(source, minlength=self.named.shape[1] + 1)[1:]
            self.wrong[v, k] += (source > 0).sum()
            self.nothing[v, k] += (source == 0).sum()

    def add_worn(self, version: str, series: np.ndarray, axis: int) -> np.ndarray:
        """Count a version of runs (r, hours, n) in which `axis` (1-based) is worn; return where it is named, (2, r)."""
        v, j, hit = list(VERSIONS).index(version), axis - 1, np.zeros((2, len(series)), dtype=bool)
        self.runs[v] += len(series)
        for k, correlation in enumerate(CORRELATIONS):
            lag, source = named_axis(series, correlation, self._reading)
            hit[k] = source == axis
            self.right[v, k] += hit[k].sum()
            self.wrong[v, k] += ((source > 0) & ~hit[k]).sum()
            self.nothing[v, k] += (source == 0).sum()
            if version == "as_they_are":
                sign = 1 if self._reading["lag_sign"] == "equation_5" else -1
                toward = -np.sign(np.delete(lag[:, j], j, axis=1)) * sign
                self.signs[k] += [(toward >= 0).sum(), toward.size]
        return hit


def _versions(series: np.ndarray, j: int) -> dict[str, np.ndarray]:
    """Return the versions (r, hours, n) of runs in which the 0-based axis j is worn."""
    centred = series - series.mean(axis=1, keepdims=True)
    centred[:, :, j] = series[:, :, j]
    return {"as_they_are": series, "others_centred": centred, "reversed_in_time": series[:, ::-1]}


def _curves(series: np.ndarray, j: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the cross-correlations (2, p, 2 h - 1) of the 0-based axis j with all others in runs (r, h, n), and what
    rising alone predicts for the raw ones (p, 2 h - 1), each over its maximum.

    Pairs with an axis whose divergence is always zero have no correlation to show.
    """
    raw, centred = (np.moveaxis(s, 1, 2) for s in (series, series - series.mean(axis=1, keepdims=True)))
    curve = np.stack([cross_correlation(s[:, j, None], np.delete(s, j, axis=1)) for s in (raw, centred)])
    others = np.delete(raw, j, axis=1)
    alone = rising_alone(np.repeat(raw[:, j, None], others.shape[1], axis=1), others.mean(axis=-1))
    scale = np.abs(curve).max(axis=-1, keepdims=True)
    alive, scale = (scale > 0).all(axis=0)[..., 0], np.where(scale > 0, scale, 1)
    return (curve / scale)[:, alive], (alone / scale[0])[alive]


def _by_rise(rise: np.ndarray, hit: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return `rise_edges`, `rise_right` and `rise_runs` of :class:`LagRule` for runs that rise by `rise` (r,) and in
    which the worn axis is named where `hit` (2, r)."""
    place = np.digitize(rise, RISES[1:-1])
    count = len(RISES) - 1
    right = np.stack([np.bincount(place[h], minlength=count) for h in hit])
    return RISES, right, np.bincount(place, minlength=count)


def explain(poses: PoseSet, experiment: SharedExperiment, analysis: Analysis, reading: Reading) -> LagRule:
    """Run the experiment. Detection follows the reading with the KL divergence as input of the PCA."""
    reading = {**reading, "pca_input": "kl_divergence"}
    tally, hours = _Tally(len(analysis.axes), reading), experiment.wear_hours
    rises: list[np.ndarray] = []
    hits: list[np.ndarray] = []
    curves: list[tuple[np.ndarray, np.ndarray]] = []
    for axis, whole, hour, mean, spread in _runs(poses, experiment, analysis, reading):
        if axis == 0:
            tally.add_normal_week(whole)
            continue
        detected, j = np.isfinite(hour), axis - 1
        series = whole[detected]
        if not len(series):
            continue
        named = {name: tally.add_worn(name, version, axis) for name, version in _versions(series, j).items()}
        hits.append(named["as_they_are"])
        rises.append((series[:, -24:, j].mean(axis=1) - mean[detected, j]) / spread[detected, j])
        curves.append(_curves(series, j))

    if rises:
        edges, rise_right, rise_runs = _by_rise(np.concatenate(rises), np.concatenate(hits, axis=1))
        observed = np.concatenate([curve for curve, _ in curves], axis=1).mean(axis=1)
        expected = np.concatenate([alone for _, alone in curves]).mean(axis=0)
    else:
        edges = np.array([-np.inf, np.inf])
        rise_runs, rise_right = np.zeros(1, dtype=int), np.zeros((2, 1), dtype=int)
        observed, expected = np.zeros((2, 2 * hours - 1)), np.zeros(2 * hours - 1)
    lead, all_of = tally.signs.T
    return LagRule(
        right=tally.right,
        wrong=tally.wrong,
        nothing=tally.nothing,
        runs=tally.runs,
        named=tally.named,
        rise_edges=edges,
        rise_right=rise_right,
        rise_runs=rise_runs,
        lags=np.arange(1 - hours, hours),
        observed=observed,
        expected=expected,
        sign_right=np.divide(lead, all_of, out=np.full(2, np.nan), where=all_of > 0),
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
