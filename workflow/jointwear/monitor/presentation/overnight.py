"""Growth that came overnight and has kept since, as new grease does and no wear."""

from __future__ import annotations

import numpy as np

#: Seconds of a day; days before and after the step that must show it.
DAY, FEWEST = 86400.0, 2
#: Part of the step by which days may lie off: before it from none, after it from what they have in common. What wears
#: grows for days, and goes on.
KEPT = 0.25
#: Part of the first day's step that grease which is worked soft leaves, and standard errors by which Coulomb friction
#: is lower since, which thicker grease lowers and no wear.
SOFT, CLEAR = 0.3, 3.0
#: Days looked back at from an alarm: it may have needed some shifts.
BACK = 7


def rose_overnight(end: np.ndarray, growth: np.ndarray, alarm: float, coulomb: np.ndarray | None = None) -> bool:
    """Return whether growth came within a day, or from one to the next, before an alarm, and has kept since; or has
    gone back in part, where Coulomb friction fell with it.

    Parameters
    ----------
    end : (w,) [s] of the windows after the baseline. growth : (w,) in any unit, NaN unknown. alarm : time [s] of the
    first alarm. coulomb : (w,) growth of Coulomb friction, in any unit, None for unknown.
    """
    names, means = _days(end, growth)
    other_names, others = _days(end, np.full(len(end), np.nan) if coulomb is None else coulomb)
    first = int(np.searchsorted(names, np.floor(alarm / DAY), side="right"))
    for k in range(max(FEWEST, first - BACK), min(first, len(names) - FEWEST)):
        # The day of the step may lie between: it came in the middle of it, or the days are not those of UTC.
        before, after = means[:k], means[k + 1 :]
        fell = _fell(others[np.isin(other_names, names[:k])], others[np.isin(other_names, names[k + 1 :])])
        step = float(after[0] if fell else np.mean(after))
        between = -KEPT * step < means[k] < (1 + KEPT) * step
        kept = (after > SOFT * step) & (after < (1 + KEPT) * step) if fell else np.abs(after - step) < KEPT * step
        if between and kept.all() and np.abs(before).max() < KEPT * step:
            return True
    return False


def _days(end: np.ndarray, growth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the days (d,) of which growth (w,) is known, and its mean (d,) in each."""
    known = np.isfinite(growth)
    day = np.floor(end[known] / DAY)
    names = np.unique(day)
    return names, np.array([np.mean(growth[known][day == d]) for d in names])


def _fell(before: np.ndarray, after: np.ndarray) -> bool:
    """Return whether the mean of days `after` is clearly below that of those `before`, by their own scatter."""
    if min(len(before), len(after)) < FEWEST:
        return False
    error = np.sqrt(sum(np.var(days, ddof=1) / len(days) for days in (before, after)))
    return bool(np.mean(before) - np.mean(after) > CLEAR * error)
