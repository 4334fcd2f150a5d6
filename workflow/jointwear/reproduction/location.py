"""Locate the worn axis: lags at maximum cross-correlation between all pairs of axes, and a decision rule."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, read_variables, write_dataset
from jointwear.reproduction.grid import run_attributes
from jointwear.reproduction.readings import (
    correlated_hours,
    correlated_series,
    cross_correlation,
    lag_peak,
    lag_sign,
    select,
    source_rule,
)

_CHUNK = 100  # replicates transformed at once: 100 x 240 lags x 15 pairs are 3 MB


def lag_matrix(series: np.ndarray, inside: np.ndarray, correlation: str, peak: str = "maximum") -> np.ndarray:
    """Return the lag at maximum cross-correlation of all pairs of axes, equations (5) and (6).

    Parameters
    ----------
    series : (r, hours, n).
    inside : (r, hours) hours that take part.
    correlation : "raw" or "means_removed" (reading `cross_correlation`).
    peak : "maximum" or "absolute_maximum" (reading `lag_peak`).

    Returns
    -------
    (r, n, n) lags [h]: entry (i, j) is positive where axis j trails axis i. Exactly antisymmetric. Among equal
    maxima the shortest lag counts; a series without variation has lag 0 to every other.
    """
    x = select(cross_correlation, correlation)(series, inside[:, :, None])
    r, hours, n = x.shape
    length = 2 * hours
    transform = np.fft.rfft(x, length, axis=1)
    lags = np.arange(length)
    lags[lags >= hours] -= length
    order = np.argsort(np.abs(lags) * 2 + (lags < 0), kind="stable")
    order = order[np.abs(lags[order]) < hours]
    energy = np.sqrt((x**2).sum(axis=1))
    result = np.zeros((r, n, n), dtype=int)
    for i in range(n):
        for j in range(i + 1, n):
            c = np.fft.irfft(transform[:, :, i].conj() * transform[:, :, j], length, axis=1)[:, order]
            scale = energy[:, i] * energy[:, j]
            # Rounding to 1e-12 of the largest possible value keeps ties ties, whatever the transform adds.
            value = np.round(np.divide(c, scale[:, None], out=np.zeros_like(c), where=scale[:, None] > 0), 12)
            best = select(lag_peak, peak)(value).argmax(axis=1)
            result[:, i, j] = np.where(scale > 0, lags[order][best], 0)
    return result - result.swapaxes(1, 2)


def locate(
    features: Mapping[str, np.ndarray],
    onset: np.ndarray,
    training_mean: np.ndarray,
    training_spread: np.ndarray,
    reading: Mapping[str, str],
) -> tuple[np.ndarray, np.ndarray]:
    """Return lags (r, n, n) [h] in the sign of the reading and the source axis (r,), 1-based, 0 = none.

    Parameters
    ----------
    features : `kl_divergence` and `mean_absolute_torque`, each (r, hours, n).
    onset : (r,) hour of detection, NaN where none.
    training_mean, training_spread : (r, n) of the KL divergence in training.
    """
    series = select(correlated_series, reading["correlated_series"])(features, training_mean, training_spread)
    hours = np.arange(1, series.shape[1] + 1)
    inside = select(correlated_hours, reading["correlated_hours"])(hours, onset)
    lag = np.concatenate(
        [
            lag_matrix(
                series[k : k + _CHUNK], inside[k : k + _CHUNK], reading["cross_correlation"], reading["lag_peak"]
            )
            for k in range(0, len(series), _CHUNK)
        ]
    )
    lag = select(lag_sign, reading["lag_sign"])(lag)
    return lag, select(source_rule, reading["source_rule"])(lag)


def largest_shift(kl: np.ndarray, training_mean: np.ndarray, training_spread: np.ndarray) -> np.ndarray:
    """Return, for every hour, the axis (1-based) whose KL divergence from then on lies farthest above training.

    A plain alternative to the paper's rule, shown beside it: at the onset it compares the axes after the onset.

    Parameters
    ----------
    kl : (r, hours, n).
    training_mean, training_spread : (r, n).

    Returns
    -------
    (r, hours) axis of the largest mean of the standardised divergence from the hour to the end.
    """
    z = (kl - training_mean[:, None]) / np.where(training_spread == 0, 1.0, training_spread)[:, None]
    return np.flip(np.cumsum(np.flip(z, axis=1), axis=1), axis=1).argmax(axis=2) + 1


def shift_at(shift: np.ndarray, onset: np.ndarray) -> np.ndarray:
    """Return the axis of the largest shift at the onset, (r,); 0 where nothing was detected (onset NaN)."""
    hour = np.where(np.isnan(onset), 1, onset).astype(int)
    return np.where(np.isnan(onset), 0, np.take_along_axis(shift, hour[:, None] - 1, axis=1)[:, 0])


def write_location(
    features: str | Path,
    training: str | Path,
    detection: str | Path | None,
    output: str | Path,
    settings: Mapping[str, Any],
) -> None:
    """Locate the wear in every replicate of a run.

    Parameters
    ----------
    features, training : features of the run and of the task's normal operation.
    detection : its onset hours; None where the reading correlates the whole run.
    output : netCDF file with `lag`, `source`, the same for both cross-correlations, and `largest_shift`.
    settings : `reading`.
    """
    with open_dataset(features) as dataset:
        values = {n: read_variable(dataset, features, n) for n in ("kl_divergence", "mean_absolute_torque")}
    (kl,) = read_variables(training, "kl_divergence")
    mean, spread = kl.mean(axis=1), kl.std(axis=1, ddof=1)
    spread[spread == 0] = 1.0
    reading = settings["reading"]
    onset = np.full(len(kl), np.nan) if detection is None else read_variables(detection, "onset")[0]
    variables = {"axis": Variable(("axis",), np.arange(1, kl.shape[2] + 1), "axis of the robot", "1")}
    matrix, each = ("replicate", "axis", "second_axis"), ("replicate",)
    for correlation in (None, "raw", "means_removed"):
        chosen = reading if correlation is None else {**reading, "cross_correlation": correlation}
        lag, source = locate(values, onset, mean, spread, chosen)
        suffix = "" if correlation is None else f"_{correlation}"
        what = "the chosen cross-correlation" if correlation is None else f"cross-correlation: {correlation}"
        variables[f"lag{suffix}"] = Variable(matrix, lag, f"lag at maximum correlation, {what}", "h", kind="i2")
        variables[f"source{suffix}"] = Variable(
            each, source, f"axis named by the rule, 0 = none, {what}", "1", kind="i1"
        )
    variables["largest_shift"] = Variable(
        ("replicate", "hour"),
        largest_shift(values["kl_divergence"], mean, spread),
        "axis whose divergence from this hour on lies farthest above training",
        "1",
        kind="i1",
    )
    made_from = [path for path in (features, training, detection) if path is not None]
    described = provenance.attributes("lags between axes and source of the wear", settings, made_from)
    write_dataset(output, variables, {**described, **run_attributes(features)})
