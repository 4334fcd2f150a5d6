"""Onsets of one task under every reading of the PCA at once: scaling, number of components, hours in a row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from statistics import NormalDist

import numpy as np
from scipy.special import chdtri

from jointwear.reproduction.readings.q_limit import _ROUNDING
from jointwear.reproduction.readings.scaling import standardised
from jointwear.reproduction.wear import Wear
from jointwear.studies.joint_fit.divergence import Divergence
from jointwear.studies.joint_fit.levels import Levels
from jointwear.studies.joint_fit.noise_bank import NoiseBank
from jointwear.studies.multiverse.shared_torque import cell_offset

SCALINGS = ("standardised", "centred")
COMPONENTS = ("variance_share", "three", "four")
CONSECUTIVE = (3, 5, 8)


@dataclass(frozen=True)
class PcaReading:
    """One reading of what follows the divergence; names as in the config."""

    scaling: str
    components: str
    consecutive_hours: int


READINGS = tuple(PcaReading(*values) for values in product(SCALINGS, COMPONENTS, CONSECUTIVE))


@dataclass(frozen=True)
class Grid:
    """Wear of the paper's experiment: increases [%], hours of a run, and the constants of the analysis."""

    increases: tuple[float, ...] = (10.0, 20.0)
    hours: int = 120
    bins: int = 12
    confidence: float = 0.95
    variance_share: float = 0.75


@dataclass
class TaskOutcome:
    """What one task gave: `onset` by reading (c, n, r) [h], NaN where not detected; `kept` by reading (r,).

    `series` (r, h, n) KL divergence [nat] of the run that Table II and Figure 2 show, None if not asked for.
    """

    onset: dict[PcaReading, np.ndarray] = field(default_factory=dict)
    kept: dict[PcaReading, np.ndarray] = field(default_factory=dict)
    series: np.ndarray | None = None


def limits(eigenvalues: np.ndarray, confidence: float) -> np.ndarray:
    """Return the Q-limit of residual eigenvalues (r, k); as :func:`jointwear.reproduction.control_limits.q_limit`."""
    largest = eigenvalues.max(axis=1, initial=0.0)
    safe = np.where(largest > 0, largest, 1.0)
    ratio = eigenvalues / safe[:, None]
    first, second, third = (np.maximum((ratio**p).sum(axis=1), 1e-300) for p in (1, 2, 3))
    h = 1 - 2 * first * third / (3 * second**2)
    quantile = NormalDist().inv_cdf(confidence)
    bracket = quantile * np.sqrt(2 * second * h**2) / first + 1 + second * h * (h - 1) / first**2
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        power = safe * first * np.maximum(bracket, 0.0) ** (1 / h)
    box = safe * second / first * chdtri(first**2 / second, 1 - confidence)
    return np.where(largest > 0, np.where(h <= 0, box, power), 0.0)


def onsets(above: np.ndarray, consecutive: int) -> np.ndarray:
    """Return the first hour (..., ) of `consecutive` hours above the limit (..., h), NaN where there is none."""
    length = above.shape[-1] - consecutive + 1
    holds = above[..., :length].copy()
    for k in range(1, consecutive):
        holds &= above[..., k : k + length]
    return np.where(holds.any(axis=-1), holds.argmax(axis=-1) + 1.0, np.nan)


def detect(
    levels: Levels,
    bank: NoiseBank,
    shape: float,
    grid: Grid,
    readings: Sequence[PcaReading] = READINGS,
    shown: tuple[int, int] | None = None,
) -> TaskOutcome:
    """Run all worn cells of a task.

    Parameters
    ----------
    shown : (0-based column, 0-based axis) of the run whose series is wanted.
    """
    n = len(levels.torque)
    axes = [Divergence(levels, i, bank, grid.bins) for i in range(n)]
    training = np.stack([a.training for a in axes], axis=-1)
    normal = np.stack([a.normal for a in axes], axis=-1)
    hour = np.arange(1, grid.hours + 1)
    runs = np.empty((len(grid.increases), n, bank.replicates, grid.hours, n))
    for c, increase in enumerate(grid.increases):
        growth = Wear(increase, shape, grid.hours).growth(hour)
        for i in range(n):
            hours = (cell_offset(i + 1, c, n) + np.arange(grid.hours)) % normal.shape[1]
            runs[c, i] = normal[:, hours]
            runs[c, i, ..., i] = axes[i].worn(growth, hours)
    outcome = TaskOutcome(series=None if shown is None else runs[shown])
    mean = training.mean(axis=1)
    for scaling in dict.fromkeys(r.scaling for r in readings):
        spread = np.ones_like(mean)
        if scaling == "standardised":
            spread = np.stack([standardised(values) for values in training])
        z = (training - mean[:, None]) / spread[:, None]
        values, vectors = np.linalg.eigh(z.swapaxes(1, 2) @ z / (training.shape[1] - 1))
        values = np.maximum(values, 0.0)  # ascending
        projected = ((runs - mean[:, None]) / spread[:, None]) @ vectors
        # Q with the smallest 1, 2, ... directions as residual.
        q = np.cumsum(np.square(projected, out=projected), axis=-1)
        share = np.cumsum(values[:, ::-1], axis=1) / np.maximum(values.sum(axis=1, keepdims=True), 1e-300)
        for components in dict.fromkeys(r.components for r in readings if r.scaling == scaling):
            kept = {
                "three": np.full(len(mean), 3),
                "four": np.full(len(mean), 4),
                "variance_share": np.minimum((share <= grid.variance_share).sum(axis=1) + 1, n),
            }[components]
            limit = np.empty(len(mean))
            statistic = np.zeros(runs.shape[:-1])
            for k in np.unique(kept):
                same = kept == k
                if k < n:
                    limit[same] = limits(values[same, : n - k], grid.confidence)
                    statistic[:, :, same] = q[..., n - k - 1][:, :, same]
                else:
                    limit[same] = 0.0
            above = statistic > np.maximum(limit, _ROUNDING)[:, None]
            for reading in readings:
                if (reading.scaling, reading.components) == (scaling, components):
                    outcome.onset[reading] = onsets(above, reading.consecutive_hours)
                    outcome.kept[reading] = kept
    return outcome
