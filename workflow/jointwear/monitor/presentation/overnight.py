"""Growth that came overnight and has kept since, as new grease does and no wear."""

from __future__ import annotations

import numpy as np

#: Seconds of a day; days before and after the step that must show it.
DAY, FEWEST = 86400.0, 2
#: Part of the step by which days may lie off: before it from none, after it from what they have in common. What wears
#: grows for days, and goes on.
KEPT = 0.25
#: Days looked back at from an alarm: it may have needed some shifts.
BACK = 7


def rose_overnight(end: np.ndarray, growth: np.ndarray, alarm: float) -> bool:
    """Return whether growth came within a day, or from one to the next, before an alarm, and has kept since.

    Parameters
    ----------
    end : (w,) [s] of the windows after the baseline. growth : (w,) in any unit, NaN unknown. alarm : time [s] of the
    first alarm.
    """
    known = np.isfinite(growth)
    day = np.floor(end[known] / DAY)
    names = np.unique(day)
    means = np.array([np.mean(growth[known][day == d]) for d in names])
    first = int(np.searchsorted(names, np.floor(alarm / DAY), side="right"))
    for k in range(max(FEWEST, first - BACK), min(first, len(names) - FEWEST)):
        # The day of the step may lie between: it came in the middle of it, or the days are not those of UTC.
        before, after = means[:k], means[k + 1 :]
        step = float(np.mean(after))
        between = -KEPT * step < means[k] < (1 + KEPT) * step
        if between and np.abs(after - step).max() < KEPT * step and np.abs(before).max() < KEPT * step:
            return True
    return False
