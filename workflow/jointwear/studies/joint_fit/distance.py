"""How far one task is from what the paper prints: Tables II, IV, V and VI, Figure 2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.reproduction.location import lag_matrix
from jointwear.studies.joint_fit.detection import PcaReading, TaskOutcome


@dataclass(frozen=True)
class Weights:
    """What an error costs; a cell of Table IV with the wrong outcome in all replicates costs one.

    `margin`: share of replicates beyond which a cell counts as right without a rest, so that a majority found on
    few replicates holds on others. `hour`: cost of an error of `hour_scale` [h] in a detected cell, growing as its
    root of squares to `hour_cap`. `table`: cost of an error of `torque_scale` (relative, Table V) or
    `variation_scale` (Table VI) in one cell; `torque_worst`, `variation_worst`: errors from which on the cost rises
    steeply. `lag`: cost of one wrong sign of Table II. `divergence`: cost of a largest KL divergence that misses
    that of Figure 2, `divergence_range` [nat], by a factor of e.
    """

    margin: float = 0.7
    hour: float = 0.2
    hour_scale: float = 8.0
    hour_cap: float = 40.0
    table: float = 0.08
    torque_scale: float = 0.01
    variation_scale: float = 0.01
    torque_worst: float = 0.052
    variation_worst: float = 0.036
    lag: float = 0.1
    divergence: float = 0.5
    divergence_range: tuple[float, float] = (8.0, 12.0)
    components: float = 0.5


@dataclass(frozen=True)
class TaskTarget:
    """What the paper prints of one task: `hours` (c, n) NaN where not detected; `components` lowest and highest number;
    `lag_sign` (n, n) or None."""

    hours: np.ndarray
    components: tuple[int, int] = (3, 4)
    lag_sign: np.ndarray | None = None


def table_cost(torque: np.ndarray, variation: np.ndarray, weights: Weights) -> np.ndarray:
    """Return the cost (S,) of relative errors of Table V and errors of Table VI, each (S, cells)."""
    result = np.zeros(len(torque))
    steep = 20.0  # half a scale beyond the worst that is wanted costs as much as five errors of one scale
    for error, scale, worst in (
        (torque, weights.torque_scale, weights.torque_worst),
        (variation, weights.variation_scale, weights.variation_worst),
    ):
        size = np.abs(error)
        beyond = np.maximum(size - worst, 0.0) / scale
        result += weights.table * (np.sqrt(1 + (size / scale) ** 2) - 1 + steep * beyond**2).sum(axis=1)
    return result


def detection_cost(outcome: TaskOutcome, target: TaskTarget, weights: Weights) -> dict[PcaReading, float]:
    """Return the cost of Table IV and of the number of components under every reading."""
    wanted = np.isfinite(target.hours)
    result = {}
    for reading, onset in outcome.onset.items():
        detects = np.isfinite(onset)
        share = detects.mean(axis=-1)
        right = np.where(wanted, share, 1 - share)
        miss = np.maximum(weights.margin - right, 0.0) / weights.margin
        with np.errstate(all="ignore"):
            middle = np.ma.median(np.ma.masked_invalid(onset), axis=-1).filled(np.nan)
        late = np.minimum(np.abs(middle - target.hours), weights.hour_cap)
        late = np.where(share > 0, late, weights.hour_cap)[wanted] / weights.hour_scale
        kept, (low, high) = outcome.kept[reading], target.components
        outside = 1 - float(((kept >= low) & (kept <= high)).mean())
        result[reading] = weights.components * outside + float(
            miss.sum() + weights.hour * (np.sqrt(1 + late**2) - 1).sum()
        )
    return result


def agreeing_cells(outcome: TaskOutcome, target: TaskTarget) -> dict[PcaReading, int]:
    """Return in how many cells of Table IV the majority of the replicates agrees under every reading."""
    wanted = np.isfinite(target.hours)
    return {r: int(((np.isfinite(o).mean(axis=-1) >= 0.5) == wanted).sum()) for r, o in outcome.onset.items()}


def lags(series: np.ndarray) -> np.ndarray:
    """Return lags (r, n, n) [h] at the largest raw cross-correlation of series (r, h, n), those of Table II."""
    return lag_matrix(series, np.ones(series.shape[:2], dtype=bool), "raw")


def right_pairs(lag: np.ndarray, lag_sign: np.ndarray) -> np.ndarray:
    """Return (r, pairs) which pairs of axes i < j have the sign (n, n) of Table II, of lags (r, n, n)."""
    upper = np.triu_indices(len(lag_sign), 1)
    return np.sign(lag[:, upper[0], upper[1]]) == lag_sign[upper]


def same_signs(lag: np.ndarray, lag_sign: np.ndarray) -> np.ndarray:
    """Return how many pairs of axes have the sign (n, n) of Table II in each replicate, (r,), of lags (r, n, n)."""
    return right_pairs(lag, lag_sign).sum(axis=1)


def series_cost(outcome: TaskOutcome, target: TaskTarget, weights: Weights) -> float:
    """Return the cost of Table II and Figure 2, 0 for a task that they do not show."""
    if outcome.series is None or target.lag_sign is None:
        return 0.0
    pairs = target.lag_sign.shape[0] * (target.lag_sign.shape[0] - 1) // 2
    wrong = pairs - float(same_signs(lags(outcome.series), target.lag_sign).mean())
    largest = max(float(np.median(outcome.series.max(axis=(1, 2)))), 1e-3)
    low, high = weights.divergence_range
    off = max(np.log(low / largest), np.log(largest / high), 0.0)
    return weights.lag * wrong + weights.divergence * off
