"""Other detectors on the same runs: multivariate statistics, isolation forest, change points, KL of kernel densities.

All see only torque, hour by hour, as the paper's method does: the first three and the change points its mean, maximum
and variation on every axis, the last its distribution. Each gives one statistic an hour; a threshold chosen on the
normal week of half of the replicates gives all the same rate of false alarms, checked on the other half.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, read_variables, write_dataset
from jointwear.reproduction.grid import Cell, worn_runs
from jointwear.studies.monitor_study.runs import read_torque
from jointwear.studies.monitor_study.scores import factor_for, first_hour, reset_alarms

#: A package that is not installed (requirements/bench.in has ruptures) is left out.
PEERS = ("pca_q", "pca_t2", "isolation_forest", *(("ruptures",) if find_spec("ruptures") else ()), "kernel_kl")
FEATURES = ("mean_absolute_torque", "maximum_torque", "variation")
RATE = 1.0
#: Change points are looked for every so many hours: one look takes as long as the other detectors' whole run.
STEP = 6
_VARIANCE_SHARE = 0.9
_BINS, _WIDTHS = 96, 1.06

#: From standardised features of training (h, p) and of a run (h', p) to one statistic an hour (h',).
Statistic = Callable[[np.ndarray], np.ndarray]


def standardised(training: np.ndarray, run: np.ndarray) -> np.ndarray:
    """Return the features of a run in standard deviations of the training, constant ones as 0."""
    spread = training.std(axis=0, ddof=1)
    safe = np.where(spread > 1e-12, spread, np.inf)
    return (run - training.mean(axis=0)) / safe


def fit_peers(training: np.ndarray, seed: int) -> dict[str, Statistic]:
    """Fit the detectors that see features; `training` (h, p) standardised."""
    from sklearn.decomposition import PCA
    from sklearn.ensemble import IsolationForest

    moving = training.std(axis=0) > 0
    pca = PCA(n_components=_VARIANCE_SHARE).fit(training[:, moving])
    forest = IsolationForest(random_state=seed).fit(training[:, moving])

    def t2(run: np.ndarray) -> np.ndarray:
        return (pca.transform(run[:, moving]) ** 2 / pca.explained_variance_).sum(axis=1)

    def q(run: np.ndarray) -> np.ndarray:
        x = run[:, moving]
        return ((x - pca.inverse_transform(pca.transform(x))) ** 2).sum(axis=1)

    def change_point(run: np.ndarray) -> np.ndarray:
        import ruptures

        gain = np.zeros(len(run))
        for t in range(STEP - 1, len(run), STEP):
            signal = np.concatenate([training, run[: t + 1]])[:, moving]
            search = ruptures.Binseg(model="l2", min_size=3, jump=3).fit(signal)
            breaks = search.predict(n_bkps=1)
            gain[t] = search.cost.sum_of_costs([len(signal)]) - search.cost.sum_of_costs(breaks)
        return gain

    found = {"pca_q": q, "pca_t2": t2, "isolation_forest": lambda run: -forest.score_samples(run[:, moving])}
    return found | ({"ruptures": change_point} if find_spec("ruptures") else {})


class KernelDensities:
    """KL divergence of the torque's kernel density in an hour from that of the training, axis by axis.

    Bittencourt, Saarinen and Sander-Tavallaee (2012): Gaussian kernels, symmetric divergence, here on a grid.

    Parameters
    ----------
    training : (h, s, n) torque [N m] of one replicate.
    """

    def __init__(self, training: np.ndarray) -> None:
        low, high = training.min(axis=(0, 1)), training.max(axis=(0, 1))
        margin = 0.3 * (high - low) + 1e-9
        self._low, self._size = low - margin, (high - low + 2 * margin) / _BINS
        spread = training.std(axis=1).mean(axis=0)
        width = _WIDTHS * spread * training.shape[1] ** -0.2
        steps = np.subtract.outer(np.arange(_BINS), np.arange(_BINS))
        kernels = np.exp(-0.5 * (steps * (self._size / np.maximum(width, self._size))[:, None, None]) ** 2)
        self._kernels = kernels / kernels.sum(axis=2, keepdims=True)
        hourly = self._densities(training)
        self._reference = hourly.mean(axis=0)
        divergence = self._divergence(hourly)
        self._mean, self._spread = divergence.mean(axis=0), divergence.std(axis=0)

    def _densities(self, torque: np.ndarray) -> np.ndarray:
        h, _, n = torque.shape
        index = np.clip((torque - self._low) / self._size, 0, _BINS - 1).astype(int)
        cell = (np.arange(h)[:, None, None] * n + np.arange(n)) * _BINS
        counts = np.bincount((index + cell).ravel(), minlength=h * n * _BINS).reshape(h, n, _BINS)
        density = np.einsum("hnb,nbc->hnc", counts / torque.shape[1], self._kernels) + 1e-6
        return density / density.sum(axis=2, keepdims=True)

    def _divergence(self, density: np.ndarray) -> np.ndarray:
        return ((density - self._reference) * np.log(density / self._reference)).sum(axis=2)

    def score(self, torque: np.ndarray) -> np.ndarray:
        """Return the divergences (h, n) in standard deviations of the training."""
        found = self._divergence(self._densities(torque))
        return (found - self._mean) / np.where(self._spread > 1e-12, self._spread, np.inf)


def _features(path: str | Path, replicates: int) -> np.ndarray:
    """Read the features (r, h, p) of a run."""
    return np.concatenate([a[:replicates].astype(float) for a in read_variables(path, *FEATURES)], axis=2)


def study_peers(features: Sequence[str], runs: Sequence[str], output: str | Path, settings: Mapping[str, Any]) -> None:
    """Run all peers on one task.

    Parameters
    ----------
    features, runs : files of hourly features and of torque: training, normal and worn runs.
    settings : `seed`, `peer_replicates`, `consecutive_hours`.
    """
    count, seed = settings["peer_replicates"], settings["seed"]

    def by_run(paths: Sequence[str]) -> dict[Any, str]:
        worn = worn_runs(paths)
        return {**{Path(p).stem: p for p in paths if str(p) not in worn.values()}, **worn}

    of_features, of_torque = by_run(features), by_run(runs)
    cells = sorted(c for c in of_features if isinstance(c, Cell))
    wanted = ["normal", *cells]
    statistics: dict[str, list[np.ndarray]] = {name: [] for name in PEERS}
    axes: dict[Any, np.ndarray] = {}
    training = _features(of_features["training"], count)
    peers = [fit_peers(standardised(x, x), seed) for x in training]
    densities = [KernelDensities(x) for x in read_torque(of_torque["training"], slice(0, count))]
    for run in wanted:
        values = _features(of_features[run], count)
        for name in PEERS[:-1]:
            statistics[name].append(
                np.stack([p[name](standardised(x, v)) for p, x, v in zip(peers, training, values, strict=True)])
            )
        scored = np.stack(
            [d.score(t) for d, t in zip(densities, read_torque(of_torque[run], slice(0, count)), strict=True)]
        )
        statistics["kernel_kl"].append(scored.max(axis=2))
        axes[run] = scored.argmax(axis=2) + 1
    hours = np.full((len(PEERS), len(cells), count), np.nan)
    named, false = np.zeros((len(cells), count), dtype=int), []
    for k, name in enumerate(PEERS):
        normal, *worn = statistics[name]
        threshold = factor_for(normal[0::2], RATE, 1)
        false.append(reset_alarms(normal[1::2], threshold, 1).sum())
        for i, values in enumerate(worn):
            hours[k, i] = first_hour(reset_alarms(values, threshold, 1))
            if name == "kernel_kl":
                seen = np.isfinite(hours[k, i])
                at = np.where(seen, hours[k, i] - 1, 0).astype(int)
                named[i] = np.where(seen, axes[cells[i]][np.arange(count), at], 0)
    variables = {
        "peer": Variable(("peer",), np.array(PEERS), "detector"),
        "cell_axis": Variable(("cell",), np.array([c.axis for c in cells]), "worn axis", "1"),
        "cell_increase": Variable(("cell",), np.array([c.increase_percent for c in cells]), "growth", "percent"),
        "hour": Variable(("peer", "cell", "replicate"), hours, "hour of the first alarm, NaN without", "h"),
        "kernel_kl_named": Variable(("cell", "replicate"), named, "axis with the largest divergence then", "1"),
        "false": Variable(("peer",), np.array(false), "false alarms in the checked normal hours", "1"),
    }
    checked = int(statistics["pca_q"][0][1::2].size)
    attributes = provenance.attributes("peers of the monitor", dict(settings)) | {"checked_hours": checked}
    write_dataset(output, variables, attributes | {"rate_per_1000_h": RATE})
