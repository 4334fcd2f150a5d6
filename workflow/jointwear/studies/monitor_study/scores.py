"""Charts of many replicates at once: hour of the first alarm, the axis it names, false alarms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.estimate import Sums
from jointwear.monitor.watching.locate import axis_probability
from jointwear.studies.monitor_study.charts import Trace, run_chart, thresholds_for
from jointwear.studies.monitor_study.normal_period import Normal, coulomb_estimates


@dataclass(frozen=True)
class Charted:
    """Charts of r replicates: `change`, `std` (r, h, n), `trace`, `threshold` (n,)."""

    change: np.ndarray
    std: np.ndarray
    trace: Trace
    threshold: np.ndarray

    @property
    def hour(self) -> np.ndarray:
        """Hour (r,) of the first alarm of any axis, NaN without one."""
        return first_hour(self.trace.alarm.any(axis=-1))

    @property
    def named(self) -> np.ndarray:
        """The 1-based axis (r,) that the first alarm names, 0 without one."""
        any_axis = self.trace.alarm.any(axis=-1)
        first = any_axis.argmax(axis=1)
        rows = np.arange(len(first))
        return np.where(any_axis.any(axis=1), named_axis(self.trace.alarm, self.trace.statistic)[rows, first], 0)

    @property
    def probability(self) -> np.ndarray:
        """Probability (r,) of the axis that the first alarm names, NaN without one."""
        first = self.trace.alarm.any(axis=-1).argmax(axis=1)
        rows, named = np.arange(len(first)), self.named
        chance = axis_probability(self.trace.statistic[rows, first], self.threshold)
        return np.where(named > 0, chance[rows, np.maximum(named - 1, 0)], np.nan)

    def axis_hour(self, axis: int) -> np.ndarray:
        """Hour (r,) of the first alarm of a 0-based axis, NaN without one."""
        return first_hour(self.trace.alarm[:, :, axis])


def named_axis(alarm: np.ndarray, statistic: np.ndarray) -> np.ndarray:
    """Return the 1-based axis with the largest evidence among those that alarm, 0 where none does, (...,)."""
    z = np.where(alarm, np.nan_to_num(statistic), -1.0)
    return np.where(alarm.any(axis=-1), z.argmax(axis=-1) + 1, 0)


def first_hour(alarm: np.ndarray) -> np.ndarray:
    """Return the first 1-based hour (r,) of alarms (r, h), NaN without one."""
    return np.where(alarm.any(axis=1), alarm.argmax(axis=1) + 1.0, np.nan)


def chart(sums: Sums, normal: Normal, rate_per_1000_h: float) -> Charted:
    """Run the charts of all axes at a stated rate of false alarms of the robot; windows of one hour."""
    change, std = coulomb_estimates(sums, normal)
    threshold, fall = thresholds_for(rate_per_1000_h / 1000, normal.windows)
    trace = run_chart(change, std, threshold, fall, normal)
    return Charted(change, std, trace, threshold)


def run_minimum(ratio: np.ndarray, consecutive: int) -> np.ndarray:
    """Return the smallest ratio of the last `consecutive` hours (r, h), 0 before there are that many."""
    result = np.zeros_like(ratio)
    windows = np.lib.stride_tricks.sliding_window_view(ratio, consecutive, axis=1)
    result[:, consecutive - 1 :] = windows.min(axis=-1)
    return result


def reset_alarms(ratio: np.ndarray, factor: float, consecutive: int) -> np.ndarray:
    """Return the alarms (r, h) of runs of `consecutive` hours above the factor, starting anew after each alarm."""
    alarm = np.zeros(ratio.shape, dtype=bool)
    row = np.zeros(len(ratio), dtype=int)
    for t in range(ratio.shape[1]):
        row = np.where(ratio[:, t] > factor, row + 1, 0)
        alarm[:, t] = row >= consecutive
        row = np.where(alarm[:, t], 0, row)
    return alarm


def factor_for(ratio: np.ndarray, rate_per_1000_h: float, consecutive: int) -> float:
    """Return the least factor on a limit at which normal hours (r, h) have at most the stated rate of alarms."""
    allowed = rate_per_1000_h / 1000 * ratio.size
    tried = np.sort(run_minimum(ratio, consecutive).ravel())[::-1]
    low, high = 0, len(tried) - 1
    # Alarms grow as the factor falls along the sorted values: bisection on their number.
    if reset_alarms(ratio, tried[0], consecutive).sum() > allowed:
        return float(tried[0])
    while high - low > 1:
        middle = (low + high) // 2
        if reset_alarms(ratio, tried[middle], consecutive).sum() <= allowed:
            low = middle
        else:
            high = middle
    return float(tried[low])
