"""The threshold of the decision, from runs of an axis on which nothing happens.

A run draws the true standard deviation between shifts from what the baseline leaves open, shifts and the error of the
normal state with heavier tails than the normal law, a part of them carried on from shift to shift, and windows within
the shift; then it decides as :mod:`.decision` does, at several moments of every shift, with what the shifts before have
taught of the scatter between them. A resampling of the few shifts of a baseline cannot give such tails: the largest of
six is not the largest of a year.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.special import stdtrit

from jointwear.monitor.normal.dispersion import FLOOR, STEP_WEIGHT
from jointwear.monitor.normal.recent_shifts import BACK
from jointwear.monitor.watching.decision import FEWEST_BEFORE, SHIFTS, STEP, STEP_WINDOWS, TOLERATED

#: Runs, shifts that are judged in each, moments of a shift at which the decision is taken.
RUNS, JUDGED, MOMENTS = 4000, 20, 4
#: Degrees of freedom of shifts and of the error of the normal state: standardised means of shifts after the baseline
#: have a root mean square 1.6 times their robust standard deviation, a Student law of three to four degrees.
FREEDOM = 3.5
#: Largest correlation of one shift with the next; each run draws its own from 0 up to it.
CARRIED = 0.5
#: A step between shifts teaches the scatter between them as if it were at most so many standard deviations.
LARGEST_STEP = 3.0
#: Fewest runs that a threshold may rest on; beyond, the tail goes on as that of a Student law.
FEWEST_RUNS = 25
#: The grid on which axes share runs: the ratio of two of its sizes next to each other, the least spread and deviations,
#: and the least and the most windows of a shift.
RATIO, LEAST_SPREAD, LEAST_NORMAL, LEAST_WITHIN, FEWEST_WINDOWS, MOST_WINDOWS = 1.2, 0.1, 0.001, 0.0005, 4, 32


@dataclass(frozen=True)
class Axis:
    """What the null of one axis depends on, standard deviations of log levels.

    `between` shifts, `spread` of its log, `normal`: error of the normal state, `within`: of the mean of a whole shift
    by its windows, `windows` of a shift.
    """

    between: float
    spread: float
    normal: float
    within: float
    windows: float

    def rounded(self) -> Axis:
        """Return it on a coarse grid, so that axes and robots share runs, with the windows that it has.

        Deviations are rounded up, to the safe side, the spread to the nearest.
        """

        def up(value: float, least: float) -> float:
            return float(least * RATIO ** np.ceil(np.log(max(value, least) / least) / np.log(RATIO) - 1e-9))

        return Axis(
            up(self.between, FLOOR),
            round(max(self.spread, LEAST_SPREAD), 1),
            up(self.normal, LEAST_NORMAL),
            up(self.within, LEAST_WITHIN),
            self.windows,
        )


@dataclass(frozen=True)
class _Draws:
    """What the null runs of all axes with as many windows a shift share, standardised.

    `spread`, `carried`, `offset` (RUNS, 1); `fresh` (RUNS, JUDGED); `parts` (RUNS, JUDGED, MOMENTS).
    """

    spread: np.ndarray
    carried: np.ndarray
    fresh: np.ndarray
    offset: np.ndarray
    parts: np.ndarray


@lru_cache(maxsize=8)
def _draws(windows: int) -> _Draws:
    random = np.random.default_rng([20150824, windows])
    law = np.sqrt((FREEDOM - 2) / FREEDOM)
    return _Draws(
        spread=random.standard_normal((RUNS, 1)),
        carried=random.uniform(0.0, CARRIED, (RUNS, 1)),
        fresh=law * random.standard_t(FREEDOM, (RUNS, JUDGED)),
        offset=law * random.standard_t(FREEDOM, (RUNS, 1)),
        parts=random.standard_normal((RUNS, JUDGED, MOMENTS)),
    )


@lru_cache(maxsize=512)
def _maxima(axis: Axis) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest statistic of each run (RUNS,): of the level, and of the last shifts less those before."""
    drawn = _draws(axis.windows)
    true = axis.between * np.exp(axis.spread * drawn.spread)
    carried, fresh = drawn.carried, drawn.fresh
    shifts = np.empty((RUNS, JUDGED))
    shifts[:, 0] = fresh[:, 0]
    for s in range(1, JUDGED):
        shifts[:, s] = carried[:, 0] * shifts[:, s - 1] + np.sqrt(1 - carried[:, 0] ** 2) * fresh[:, s]
    offset = axis.normal * drawn.offset
    # Means of the first 1/M, 2/M ... of a shift.
    parts = axis.within * np.sqrt(MOMENTS) * drawn.parts
    share = np.arange(1, MOMENTS + 1)
    running = np.cumsum(parts, axis=2) / share + (true * shifts + offset)[..., None]
    # From here on runs come last, so that all runs of a moment lie together: (JUDGED, MOMENTS, RUNS).
    running = np.ascontiguousarray(running.transpose(1, 2, 0))
    ends = running[:, -1]
    known = _known_scatter(axis, ends)
    # Sums of whole shifts, from the first up to before each one.
    before = np.concatenate([np.zeros((1, RUNS)), np.cumsum(ends, axis=0)])
    level, step = np.full(RUNS, -np.inf), np.full(RUNS, -np.inf)
    for s in range(JUDGED):
        whole = axis.within**2 + known[s]
        for m in range(MOMENTS):
            now, noise = running[s, m], axis.within**2 * MOMENTS / share[m] + known[s]
            if share[m] * axis.windows / MOMENTS >= STEP_WINDOWS:
                large = np.flatnonzero(now > STEP)
                z = (now[large] - TOLERATED) / np.sqrt(noise[large] + axis.normal**2)
                level[large] = np.maximum(level[large], z)
            if not s:
                continue
            # Few runs are admitted at a time, and only they can alarm.
            rows = np.flatnonzero((now > TOLERATED) & (ends[s - 1] > TOLERATED))
            if not len(rows):
                continue
            own, total, weight = whole[rows], (now / noise)[rows], (1.0 / noise)[rows]
            past, high, high_step = ends[max(s - SHIFTS, 0) : s, rows], level[rows], step[rows]
            for k in range(1, min(SHIFTS, s + 1)):
                total = total + past[-k] / own
                weight = weight + 1.0 / own
                mean = total / weight - TOLERATED
                high = np.maximum(high, mean / np.sqrt(1.0 / weight + axis.normal**2))
                old = min(s - k, BACK - 1 - k)
                if old >= FEWEST_BEFORE:
                    reference = (before[s - k, rows] - before[s - k - old, rows]) / old
                    high_step = np.maximum(high_step, (mean - reference) / np.sqrt(1.0 / weight + own / old))
            level[rows], step[rows] = high, high_step
    return level, step


def _known_scatter(axis: Axis, means: np.ndarray) -> np.ndarray:
    """Return the variance between shifts (JUDGED, RUNS) as known before each shift, from `means` (JUDGED, RUNS).

    The baseline's estimate counts as many degrees of freedom as its spread tells; each step from shift to shift adds
    to them, as in :func:`jointwear.monitor.normal.dispersion.updated_between`.
    """
    freedom = 1.0 / (2 * axis.spread**2)
    result = np.full(means.shape, axis.between**2)
    for s in range(1, len(means) - 1):
        size = (means[s] - means[s - 1]) ** 2 / 2
        size = np.minimum(size, LARGEST_STEP**2 * (result[s] + axis.within**2)) - axis.within**2
        share = STEP_WEIGHT / (freedom + STEP_WEIGHT * s)
        result[s + 1] = np.maximum(result[s] + share * (size - result[s]), FLOOR**2)
    return result


def null_thresholds(axis: Axis, chance_per_window: float) -> tuple[float, float]:
    """Return the thresholds of z, of the level and of steps, at which one axis alarms falsely with this chance in a
    window by either.

    Parameters
    ----------
    chance_per_window : false alarms of this axis a window.
    """
    # Runs have the nearest power of two of windows. A rate counts those that the axis has, up to a factor of 1.4 apart.
    of_runs = np.clip(2 ** round(np.log2(max(axis.windows, 1))), FEWEST_WINDOWS, MOST_WINDOWS)
    maxima = _maxima(replace(axis.rounded(), windows=int(of_runs)))
    wanted = -np.expm1(-chance_per_window * JUDGED * axis.windows)
    smallest = FEWEST_RUNS / RUNS
    at = 1 - min(max(wanted, smallest), 0.5)
    alone = [_quantile(m, at) for m in maxima]
    both = _quantile(np.maximum(maxima[0] / alone[0], maxima[1] / alone[1]), at)
    farther = float((smallest / wanted) ** (1 / FREEDOM)) if wanted < smallest else 1.0
    # What no run shows, a state of the robot that the normal one is wrong for, comes to an axis once in so many shifts.
    least = float(np.sqrt((FREEDOM - 2) / FREEDOM) * stdtrit(FREEDOM, 1 - min(wanted, 0.5)))
    return max(alone[0] * both * farther, least), max(alone[1] * both * farther, least)


def _quantile(maxima: np.ndarray, at: float) -> float:
    """Return a quantile of largest statistics, at least 1: what exceeds no error is no alarm."""
    found = np.quantile(maxima, at, method="higher")
    return float(max(found, 1.0)) if np.isfinite(found) else 1.0
