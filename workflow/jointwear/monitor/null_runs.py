"""The threshold of the decision, from runs of an axis on which nothing happens.

A run draws the true standard deviation between shifts from what the baseline leaves open, shifts and the error of the
normal state with heavier tails than the normal law, a part of them carried on from shift to shift, and windows within
the shift; then it decides as :mod:`.decision` does, at several moments of every shift. A resampling of the few shifts
of a baseline cannot give such tails: the largest of six is not the largest of a year.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointwear.monitor.decision import SHIFTS, STEP, STEP_WINDOWS, TOLERATED

#: Runs, shifts that are judged in each, moments of a shift at which the decision is taken.
RUNS, JUDGED, MOMENTS = 4000, 20, 4
#: Degrees of freedom of shifts and of the error of the normal state.
FREEDOM = 5.0
#: Largest correlation of one shift with the next; each run draws its own from 0 up to it.
CARRIED = 0.5
#: Share of the allowed false alarms that the threshold of all axes uses up. The rest is for what no run holds, and for
#: alarms that are told again.
BUDGET = 0.5
#: Fewest runs that a threshold may rest on; beyond, the tail goes on as that of a Student law.
FEWEST = 25


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
    windows: int

    def rounded(self) -> Axis:
        """Return it on a coarse grid, so that axes and robots share runs; rounded up, to the safe side."""

        def up(value: float, least: float) -> float:
            return float(least * 1.2 ** np.ceil(np.log(max(value, least) / least) / np.log(1.2) - 1e-9))

        return Axis(
            up(self.between, 0.005),
            round(max(self.spread, 0.1), 1),
            up(self.normal, 0.001),
            up(self.within, 0.0005),
            int(np.clip(2 ** round(np.log2(max(self.windows, 1))), 4, 32)),
        )


@lru_cache(maxsize=512)
def _maxima(axis: Axis) -> np.ndarray:
    """Return the sorted largest statistic of each run."""
    random = np.random.default_rng([20150824, axis.windows])
    law = np.sqrt((FREEDOM - 2) / FREEDOM)

    def heavy(*shape: int) -> np.ndarray:
        return law * random.standard_t(FREEDOM, shape)

    true = axis.between * np.exp(axis.spread * random.standard_normal((RUNS, 1)))
    carried = random.uniform(0.0, CARRIED, (RUNS, 1))
    level = np.empty((RUNS, JUDGED))
    fresh = heavy(RUNS, JUDGED)
    level[:, 0] = fresh[:, 0]
    for s in range(1, JUDGED):
        level[:, s] = carried[:, 0] * level[:, s - 1] + np.sqrt(1 - carried[:, 0] ** 2) * fresh[:, s]
    offset = axis.normal * heavy(RUNS, 1)
    # Means of the first 1/M, 2/M ... of a shift.
    parts = axis.within * np.sqrt(MOMENTS) * random.standard_normal((RUNS, JUDGED, MOMENTS))
    share = np.arange(1, MOMENTS + 1)
    running = np.cumsum(parts, axis=2) / share + (true * level + offset)[..., None]
    noise = axis.within**2 * MOMENTS / share + axis.between**2
    largest = np.full(RUNS, -np.inf)
    whole = noise[-1]
    for s in range(JUDGED):
        for m in range(MOMENTS):
            now = running[:, s, m]
            if share[m] * axis.windows / MOMENTS >= STEP_WINDOWS:
                z = (now - TOLERATED) / np.sqrt(noise[m] + axis.normal**2)
                largest = np.where(now > STEP, np.maximum(largest, z), largest)
            if not s:
                continue
            admitted = (now > TOLERATED) & (running[:, s - 1, -1] > TOLERATED)
            if not admitted.any():
                continue
            total, weight = now / noise[m], 1.0 / noise[m]
            for k in range(1, min(SHIFTS, s + 1)):
                total = total + running[:, s - k, -1] / whole
                weight += 1.0 / whole
                z = (total / weight - TOLERATED) / np.sqrt(1.0 / weight + axis.normal**2)
                largest = np.where(admitted, np.maximum(largest, z), largest)
    return np.sort(largest)


def null_threshold(axis: Axis, chance_per_window: float) -> float:
    """Return the threshold of z at which one axis alarms falsely with this chance in a window.

    Parameters
    ----------
    chance_per_window : false alarms of this axis a window; of all axes times :data:`BUDGET` for the stated rate.
    """
    rounded = axis.rounded()
    maxima = _maxima(rounded)
    wanted = -np.expm1(-chance_per_window * JUDGED * rounded.windows)
    smallest = FEWEST / RUNS
    if wanted >= smallest:
        found = np.quantile(maxima, 1 - min(wanted, 0.5), method="higher")
        return float(max(found, 1.0)) if np.isfinite(found) else 1.0
    anchor = np.quantile(maxima, 1 - smallest, method="higher")
    anchor = float(max(anchor, 1.0)) if np.isfinite(anchor) else 1.0
    return anchor * float((smallest / wanted) ** (1 / FREEDOM))
