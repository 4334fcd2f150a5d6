"""Fit the normal model of a task: principal components of its normal operation and their control limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.reproduction.control_limits import q_limit, t2_limit
from jointwear.reproduction.detection import NormalModel, read_series, score
from jointwear.reproduction.readings import components, scaling, select
from jointwear.reproduction.readings import q_limit as limit_reading


def by_scikit_learn(values: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the first `size` principal components (size, p) of values (hours, p), and the variances (size,)."""
    from sklearn.decomposition import PCA

    solver = "covariance_eigh" if values.shape[1] < len(values) else "full"
    fitted = PCA(n_components=size, svd_solver=solver).fit(values)
    return fitted.components_, fitted.explained_variance_


def by_numpy(values: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the same but for round-off, and signs, on which no score depends, without half a second of imports."""
    centred = values - values.mean(axis=0)
    _, singular, components = np.linalg.svd(centred, full_matrices=False)
    return components[:size], singular[:size] ** 2 / (len(values) - 1)


def fit_normal_model(
    series: np.ndarray,
    confidence: float,
    variance_share: float,
    reading: Mapping[str, str],
    decompose: Callable[[np.ndarray, int], tuple[np.ndarray, np.ndarray]] = by_scikit_learn,
) -> NormalModel:
    """Fit one model for every replicate.

    Parameters
    ----------
    series : (r, hours, p) normal operation.
    confidence : of both limits.
    variance_share : share of the variance that the kept components must exceed.
    decompose : principal components of one replicate and their variances.
    """
    r, hours, p = series.shape
    size = min(hours - 1, p)
    mean, spread = np.empty((r, p)), np.empty((r, p))
    loadings, eigenvalues = np.zeros((r, size, p)), np.zeros((r, size))
    kept, limits, t2_limits = np.empty(r, dtype=int), np.empty(r), np.empty(r)
    for i, values in enumerate(series):
        mean[i] = values.mean(axis=0)
        spread[i] = select(scaling, reading["scaling"])(values)
        directions, variances = decompose((values - mean[i]) / spread[i], size)
        eigenvalues[i] = np.maximum(variances, 0.0)
        total = eigenvalues[i].sum()
        share = np.cumsum(eigenvalues[i]) / total if total > 0 else np.ones(size)
        kept[i] = min(select(components, reading["components"])(share, variance_share), size)
        loadings[i, : kept[i]] = directions[: kept[i]]
        t2_limits[i] = t2_limit(kept[i], hours, confidence)
    model = NormalModel(mean, spread, loadings, eigenvalues, kept, limits, t2_limits)
    training_q, _ = score(series, model)
    for i in range(r):
        theory = q_limit(eigenvalues[i, kept[i] :], confidence)
        limits[i] = select(limit_reading, reading["q_limit"])(theory, training_q[i], confidence)
    return model


def write_normal_model(features: str | Path, output: str | Path, settings: Mapping[str, Any]) -> None:
    """Fit the normal model of a task, one for every replicate of its normal operation.

    Parameters
    ----------
    features : features of the training run.
    output : netCDF file with the fields of :class:`jointwear.reproduction.detection.NormalModel` and the scores of
        training.
    settings : `confidence`, `variance_share`, `reading`.
    """
    series = read_series(features, settings["reading"])
    model = fit_normal_model(series, settings["confidence"], settings["variance_share"], settings["reading"])
    training_q, training_t2 = score(series, model)
    each, by_series = ("replicate",), ("replicate", "series")
    write_dataset(
        output,
        {
            "mean": Variable(by_series, model.mean, "mean in training", "1"),
            "spread": Variable(by_series, model.spread, "scale in training", "1"),
            "loadings": Variable(
                ("replicate", "component", "series"), model.loadings, "kept principal components, zero if not kept", "1"
            ),
            "eigenvalues": Variable(("replicate", "component"), model.eigenvalues, "variance of the component", "1"),
            "kept": Variable(each, model.kept, "number of components kept", "1"),
            "q_limit": Variable(each, model.q_limit, "limit of the Q-statistic", "1"),
            "t2_limit": Variable(each, model.t2_limit, "limit of T2", "1"),
            "q": Variable(("replicate", "hour"), training_q, "Q-statistic in training", "1"),
            "t2": Variable(("replicate", "hour"), training_t2, "T2 in training", "1"),
        },
        provenance.attributes("principal component model of normal operation", settings, [features]),
    )
