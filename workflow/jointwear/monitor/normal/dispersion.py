"""How far windows and shifts of the normal period lie from what the other shifts predict.

Within a shift: a robust standard deviation of the windows beside what their own noise explains, and the correlation of
neighbours. Between shifts: a variance component on a grid, with a prior that the axes of one robot share, because a
week has few shifts; never below :data:`FLOOR`, which no baseline of a few days can rule out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaln

from jointwear.monitor.normal.normal_state import Noise
from jointwear.statistics.known import OVER_MEDIAN

#: Normal quantile of an 80 % interval.
Q80 = 1.2815515655446004
#: Smallest standard deviation between shifts, of a log level: what a steady robot in a steady hall still shows.
FLOOR = 0.0005
#: Standard deviations between shifts that are weighed against each other.
GRID = np.geomspace(FLOOR, 0.3, 60)
#: Degrees of freedom of the law of shifts. Standard deviation of the log of an axis's about that of its robot.
FREEDOM, LIKENESS = 5.0, 0.5
#: Prior of a robot's, smallest, median and standard deviation of the log: where each axis logs its own temperature,
#: where one sensor stands for all, where none is logged and warming is told from the log's times. What the temperature
#: does not tell differs from shift to shift; a week without a thermometer cannot rule out the weather of the next. The
#: medians are those of 108 robots of three other makers (docs/decisions/when_to_alarm.md).
USUAL_OWN, USUAL_SHARED, USUAL_NONE = (FLOOR, 0.007, 0.6), (FLOOR, 0.007, 0.8), (0.003, 0.017, 1.0)
#: What a step from shift to shift counts for: neighbouring steps share a shift.
STEP_WEIGHT = 0.7
_MOST_MEMORY = 0.9


@dataclass(frozen=True)
class Dispersion:
    """Of one axis: `extra` variance of windows beside their noise, `memory`, `between` [log level, standard
    deviation] and `spread`, the standard deviation of the log of `between`."""

    extra: float
    memory: float
    between: float
    spread: float

    def noise(self, variance: np.ndarray) -> Noise:
        """Return the noise of windows with this white variance (w,)."""
        return Noise(variance + self.extra, self.memory, self.between**2)


START = Dispersion(1e-4, 0.3, 0.01, 0.5)


@dataclass(frozen=True)
class ShiftMeans:
    """Left-out residuals of one axis by shift: `mean` (s,), `variance` (s,) of the mean without that of the shift."""

    mean: np.ndarray
    variance: np.ndarray


def inflated(count: np.ndarray | float, memory: float) -> np.ndarray:
    """Return by how much the lag-1 correlation `memory` raises the variance of a mean of `count` (...,) windows."""
    m = np.maximum(np.asarray(count, dtype=float), 1.0)
    return 1 + 2 * memory / (1 - memory) * (1 - (1 - memory**m) / (m * (1 - memory)))


def within_shifts(residual: np.ndarray, variance: np.ndarray, shift: np.ndarray) -> tuple[float, float]:
    """Return the extra variance of windows and their memory from residuals (w,), NaN where there is none."""
    rows, counts, place = _by_shift(residual, shift)
    keep = counts[place] >= 3
    rows, counts = rows[keep], counts[counts >= 3]
    if not len(rows):
        return START.extra, START.memory
    # One row for each shift, filled up with NaN.
    own = np.arange(counts.max()) < counts[:, None]
    e = np.full(own.shape, np.nan)
    e[own] = residual[rows]
    e = (e - _medians(e, counts)) * np.sqrt(counts / (counts - 1))[:, None]
    size = 3 * np.maximum(OVER_MEDIAN * _medians(np.abs(e), counts), 1e-9)
    c = np.where(own, np.minimum(np.maximum(e, -size), size), 0.0)
    lags = (c[:, 1:] * c[:, :-1]).sum(axis=1) / (counts - 1)
    powers = (c * c).sum(axis=1) / counts
    scatter = (OVER_MEDIAN * float(np.median(np.abs(e[own])))) ** 2
    # The mean of a shift takes part of a slow variation with it; two windows' worth of correlation is given back.
    memory = lags.sum() / max(powers.sum(), 1e-300) + 2.0 / max(counts.mean(), 4.0)
    told = float(np.nanmedian(variance[np.isfinite(residual)]))
    return max(scatter - told, 0.0), float(np.clip(memory, 0.0, _MOST_MEMORY))


def shift_means(
    residual: np.ndarray, predicted: np.ndarray, variance: np.ndarray, shift: np.ndarray, memory: float
) -> ShiftMeans:
    """Return the means of left-out residuals (w,) by shift; `predicted` (w,) variance of the mean prediction of its
    shift."""
    rows, counts, place = _by_shift(residual, shift)
    weight = 1.0 / variance[rows]
    total, mean, told = (np.bincount(place, weight * x) for x in (1.0, residual[rows], predicted[rows]))
    shown = counts >= 2
    total, counts = total[shown], counts[shown]
    return ShiftMeans(mean[shown] / total, (inflated(counts, memory) + told[shown]) / total)


def _by_shift(residual: np.ndarray, shift: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the windows (k,) that have a residual, shift after shift, how many each shift has (s,), and the place of
    the shift of each window (k,) among them."""
    rows = np.flatnonzero(np.isfinite(residual))
    rows = rows[np.argsort(shift[rows], kind="stable")]
    place = np.cumsum(np.diff(shift[rows], prepend=shift[rows[:1]]) != 0)
    counts = np.bincount(place) if len(rows) else np.zeros(0, dtype=int)
    return rows, counts, place


def _medians(values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Return the medians (s, 1) of the first `counts` (s,) values of rows that NaN fill up, (s, k)."""
    ordered, row = np.sort(values, axis=1), np.arange(len(values))
    return (0.5 * (ordered[row, (counts - 1) // 2] + ordered[row, counts // 2]))[:, None]


def between_shifts(
    axes: Sequence[ShiftMeans], usual: Sequence[tuple[float, float, float]]
) -> list[tuple[float, float]]:
    """Return for each axis the standard deviation between shifts and the standard deviation of its log.

    Parameters
    ----------
    usual : of each axis, prior: smallest value, median and standard deviation of the log.
    """
    likelihood = np.array([_log_likelihoods(a) for a in axes])
    log_grid = np.log(GRID)
    # The robot's own level, with the axes scattered about it, on the same grid.
    about = -0.5 * ((log_grid[:, None] - log_grid) / LIKENESS) ** 2
    joined = np.array([np.logaddexp.reduce(about + row, axis=1) for row in likelihood])
    result = []
    for j, (row, (least, median, wide)) in enumerate(zip(likelihood, usual, strict=True)):
        hyper = -0.5 * ((log_grid - np.log(median)) / wide) ** 2
        level = hyper + joined.sum(axis=0) - joined[j]
        level -= np.logaddexp.reduce(level)
        log_posterior = row + np.logaddexp.reduce(about + level[:, None], axis=0)
        log_posterior[least * (1 - 1e-9) > GRID] = -np.inf
        posterior = np.exp(log_posterior - np.logaddexp.reduce(log_posterior))
        middle = float(posterior @ log_grid)
        spread = float(np.sqrt(posterior @ (log_grid - middle) ** 2))
        result.append((float(np.exp(middle)), spread))
    return result


def _log_likelihoods(means: ShiftMeans) -> np.ndarray:
    """Log density of a Student law whose variance is that of a shift and its mean, for every value of :data:`GRID`."""
    nu = FREEDOM
    scale = (GRID[:, None] ** 2 + means.variance) * (nu - 2) / nu
    const = gammaln((nu + 1) / 2) - gammaln(nu / 2) - 0.5 * np.log(nu * np.pi * scale)
    return np.sum(const - (nu + 1) / 2 * np.log1p(means.mean**2 / (nu * scale)), axis=1)


def updated_between(first: Dispersion, mean: np.ndarray, variance: np.ndarray, segment: np.ndarray) -> np.ndarray:
    """Return the standard deviation between shifts (s,) as known before each of the shifts after the baseline.

    A week of few programs and little weather shows less than a month does. What is learnt later comes from the steps
    from one shift to the next, which slow wear hardly enters.

    Parameters
    ----------
    first : what the baseline says. mean, variance : (s,) of the residuals of each shift, NaN where it shows nothing.
    segment : (s,) label; steps from one to another do not count.
    """
    log_grid = np.log(GRID)
    total = -0.5 * ((log_grid - np.log(first.between)) / max(first.spread, 0.1)) ** 2
    result = np.empty(len(mean))
    before = -1
    for s in range(len(mean)):
        posterior = np.exp(total - np.logaddexp.reduce(total))
        result[s] = np.exp(posterior @ log_grid)
        if not np.isfinite(mean[s]):
            continue
        if before >= 0 and segment[before] == segment[s]:
            # A step holds two shifts.
            step = ShiftMeans(
                (mean[s : s + 1] - mean[before]) / np.sqrt(2), (variance[s : s + 1] + variance[before]) / 2
            )
            total = total + STEP_WEIGHT * _log_likelihoods(step)
        before = s
    return result
