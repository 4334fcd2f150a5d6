"""Score a run against a normal model: Q-statistic (SPE), Hotelling's T2, onset of wear.

Fitting the model is the work of :mod:`jointwear.reproduction.normal_model`; scoring needs only numpy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, open_dataset, read_variable, write_dataset
from jointwear.reproduction.grid import run_attributes
from jointwear.reproduction.readings import onset_rule, pca_input, select

#: Share of a scaled hour up to which what the kept components leave of it is rounding, some 1e-15 of it. Where they
#: leave nothing, as where a task holds still all axes but three, the order of a sum would raise alarms otherwise.
ROUNDING = 1e-12


@dataclass(frozen=True)
class NormalModel:
    """Principal components of normal operation, per replicate r, of p series.

    `mean`, `spread` (r, p): what the series are centred and scaled by; `loadings` (r, k, p): components in order,
    zero where not kept; `eigenvalues` (r, p): variance along every component; `kept` (r,): their number;
    `q_limit`, `t2_limit` (r,): control limits.
    """

    mean: np.ndarray
    spread: np.ndarray
    loadings: np.ndarray
    eigenvalues: np.ndarray
    kept: np.ndarray
    q_limit: np.ndarray
    t2_limit: np.ndarray


def score(series: np.ndarray, model: NormalModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the Q-statistic, equation (4), zero where it is rounding, and Hotelling's T2 of every hour, (r, hours).

    Parameters
    ----------
    series : (r, hours, p) what enters the analysis.
    model : the normal model of the same replicates.
    """
    z = (series - model.mean[:, None]) / model.spread[:, None]
    scores = z @ model.loadings.swapaxes(1, 2)
    q = ((z - scores @ model.loadings) ** 2).sum(axis=2)
    q[q <= ROUNDING**2 * (z**2).sum(axis=2)] = 0.0
    variance = model.eigenvalues[:, None, : scores.shape[2]]
    kept = np.arange(scores.shape[2]) < model.kept[:, None, None]
    t2 = np.divide(scores**2, variance, out=np.zeros_like(scores), where=kept & (variance > 0)).sum(axis=2)
    return q, t2


def onset(above: np.ndarray, rule: str, consecutive: int) -> np.ndarray:
    """Return the first hour (1-based) at which the onset rule holds, NaN where it never does.

    Parameters
    ----------
    above : (r, hours) whether the statistic exceeds its limit.
    rule : alternative of the reading `onset_rule`.
    consecutive : detection.consecutive_hours.
    """
    holds = select(onset_rule, rule)(above, consecutive)
    return np.where(holds.any(axis=1), holds.argmax(axis=1) + 1.0, np.nan)


def alarms(above: np.ndarray, rule: str, consecutive: int) -> np.ndarray:
    """Return how often the onset rule starts to hold, shape (r,): the number of alarms of a run."""
    holds = select(onset_rule, rule)(above, consecutive)
    before = np.concatenate([np.zeros((len(holds), 1), dtype=bool), holds[:, :-1]], axis=1)
    return (holds & ~before).sum(axis=1)


def read_series(features: str | Path, reading: Mapping[str, str]) -> np.ndarray:
    """Return what enters the analysis, shape (r, hours, p), from a file of features."""
    choose = select(pca_input, reading["pca_input"])
    with open_dataset(features) as dataset:

        class Lazy(dict):
            def __missing__(self, name: str) -> np.ndarray:
                return read_variable(dataset, features, name).astype(float)

        return choose(Lazy())


def read_model(path: str | Path) -> NormalModel:
    """Read a normal model."""
    with open_dataset(path) as dataset:
        return NormalModel(*(read_variable(dataset, path, name) for name in NormalModel.__dataclass_fields__))


def write_detection(features: str | Path, model: str | Path, output: str | Path, settings: Mapping[str, Any]) -> None:
    """Score a run and find the onset of wear in every replicate.

    Parameters
    ----------
    features, model : files of the run's features and of the task's normal model.
    output : netCDF file with `q`, `t2` (replicate, hour), `onset`, `onset_t2` (replicate) [h] and `alarms`.
    settings : `consecutive_hours` and `reading`.
    """
    known = read_model(model)
    q, t2 = score(read_series(features, settings["reading"]), known)
    rule, count = settings["reading"]["onset_rule"], settings["consecutive_hours"]
    above, above_t2 = q > known.q_limit[:, None], t2 > known.t2_limit[:, None]
    by_hour, each = ("replicate", "hour"), ("replicate",)
    write_dataset(
        output,
        {
            "hour": Variable(("hour",), np.arange(1, q.shape[1] + 1), "time since the start of the run", "h"),
            "q": Variable(by_hour, q, "Q-statistic (squared prediction error)", "1"),
            "t2": Variable(by_hour, t2, "Hotelling's T2", "1"),
            "q_limit": Variable(each, known.q_limit, "limit of the Q-statistic", "1"),
            "t2_limit": Variable(each, known.t2_limit, "limit of T2", "1"),
            "onset": Variable(each, onset(above, rule, count), "hour of detection by Q, NaN if none", "h"),
            "onset_t2": Variable(each, onset(above_t2, rule, count), "hour of detection by T2, NaN if none", "h"),
            "alarms": Variable(each, alarms(above, rule, count), "alarms of the run by Q", "1"),
        },
        {
            **provenance.attributes("Q-statistic, T2 and onset of wear", settings, [features, model]),
            **run_attributes(features),
        },
    )
