"""Growth that came overnight and has kept since, as new grease, another scale of the torque or a temperature make it
and no wear; and Coulomb friction that fell overnight while viscous friction rose, as where a worn axis was greased."""

from __future__ import annotations

import numpy as np

#: Seconds of a day; days before and after the step that must show it.
DAY, FEWEST_DAYS = 86400.0, 2
#: Part of the step by which days may lie off: before it from none, after it from what they have in common. What wears
#: grows for days, and goes on.
KEPT = 0.25
#: Part of the first day's step that grease which is worked soft leaves, and standard errors by which Coulomb friction
#: is lower since, which thicker grease lowers and no wear.
SOFT, SURELY_LOWER = 0.3, 3.0
#: Part of a step by which another one may differ to be of the same share, and of what stood before it that is left at
#: most of what fell.
SAME_SHARE, LEFT = 0.5, 0.5
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
    for k in range(max(FEWEST_DAYS, first - BACK), min(first, len(names) - FEWEST_DAYS)):
        # The day of the step may lie between: it came in the middle of it, or the days are not those of UTC.
        before, after = means[:k], means[k + 1 :]
        fell = _fell(others[np.isin(other_names, names[:k])], others[np.isin(other_names, names[k + 1 :])])
        step = float(after[0] if fell else np.mean(after))
        between = -KEPT * step < means[k] < (1 + KEPT) * step
        kept = (after > SOFT * step) & (after < (1 + KEPT) * step) if fell else np.abs(after - step) < KEPT * step
        if between and kept.all() and np.abs(before).max() < KEPT * step:
            return True
    return False


def rose_alike(end: np.ndarray, coulomb: np.ndarray, viscous: np.ndarray, alarm: float) -> bool:
    """Return whether Coulomb and viscous friction rose by the same share at once before an alarm, and have kept: both
    clearly, by the scatter of their days, Coulomb friction from one day to the next, by more than half of the step on
    every day since and on the first ones by as much as later.

    Parameters
    ----------
    end : (w,) [s] of the windows after the baseline. coulomb, viscous : (w,) growth [%] of itself, NaN unknown. alarm :
    time [s] of the first alarm.
    """
    names, own, other = _days_of_both(end, coulomb, viscous)
    first = int(np.searchsorted(names, np.floor(alarm / DAY), side="right"))
    for k in range(max(FEWEST_DAYS, first - BACK), min(first, len(names) - FEWEST_DAYS + 1)):
        step = float(np.mean(own[k:]) - np.mean(own[:k]))
        along = float(np.mean(other[k:]) - np.mean(other[:k]))
        # Over days without a log what wears rises as well, and it goes on.
        at_once = names[k] - names[k - 1] <= 1 and own[:k].max() < LEFT * step < own[k:].min()
        at_once = at_once and np.mean(own[k : k + FEWEST_DAYS]) > (1 - KEPT) * np.mean(own[k:])
        if at_once and abs(along - step) < SAME_SHARE * step and all(_fell(x[k:], x[:k]) for x in (own, other)):
            # The later half of the days since is as the earlier one, by what they scatter.
            half = (len(own) - k) // 2
            if not (_fell(own[k + half :], own[k : k + half]) or np.ptp(own[k:]) > step):
                return True
    return False


def greased_since(end: np.ndarray, coulomb: np.ndarray, viscous: np.ndarray, alarm: float) -> bool:
    """Return whether Coulomb friction fell to less than half from one day to the next after an alarm, and has kept,
    while viscous friction rose: both clearly, by the scatter of their days.

    Parameters are those of :func:`rose_alike`.
    """
    names, own, other = _days_of_both(end, coulomb, viscous)
    first = int(np.searchsorted(names, np.floor(alarm / DAY)))
    for k in range(first + 1, len(names) - FEWEST_DAYS + 1):
        # What has grown for days lies below the newest of them: these alone stand for what was before.
        before, after = slice(max(k - FEWEST_DAYS, 0), k), slice(k, None)
        fallen = own[k:].max() < LEFT * own[before].min()
        if fallen and _fell(own[before], own[after]) and _fell(other[after], other[before]):
            return True
    return False


def _days_of_both(
    end: np.ndarray, coulomb: np.ndarray, viscous: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the days (d,) of which both kinds of friction (w,) are known, and the mean (d,) of each in them."""
    known = np.isfinite(coulomb) & np.isfinite(viscous)
    (names, own), (_, other) = (_days(end[known], growth[known]) for growth in (coulomb, viscous))
    return names, own, other


def _days(end: np.ndarray, growth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the days (d,) of which growth (w,) is known, and its mean (d,) in each."""
    known = np.isfinite(growth)
    day = np.floor(end[known] / DAY)
    names = np.unique(day)
    return names, np.array([np.mean(growth[known][day == d]) for d in names])


def _fell(before: np.ndarray, after: np.ndarray) -> bool:
    """Return whether the mean of days `after` is clearly below that of those `before`, by their own scatter."""
    if min(len(before), len(after)) < FEWEST_DAYS:
        return False
    error = np.sqrt(sum(np.var(days, ddof=1) / len(days) for days in (before, after)))
    return bool(np.mean(before) - np.mean(after) > SURELY_LOWER * error)
