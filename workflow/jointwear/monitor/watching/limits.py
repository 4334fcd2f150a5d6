"""When the friction of an axis reaches its limit: of Coulomb or of viscous friction, whichever comes first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.dispersion import Q80
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.watching.parts import (
    LEAST_VISCOUS,
    VISCOUS_CLEAR,
    ShiftMeans,
    ViscousGrowth,
    episode_parts,
    normal_error,
    shift_means,
    viscous_growth,
    viscous_scale,
    wander,
)
from jointwear.monitor.watching.shift_forecast import forecast_shifts
from jointwear.monitor.watching.watching import Watch

COULOMB, VISCOUS = "coulomb friction", "viscous friction"
#: Last shifts whose mean is the growth of now.
LATEST = 2


def in_sentence(quantity: str) -> str:
    """Return the quantity of an alarm as it stands within a sentence: Coulomb is a name."""
    return quantity.replace("coulomb", "Coulomb")


@dataclass(frozen=True)
class LimitDate:
    """When the growth of `quantity` reaches its limit: the `median` moment, and `low` and `high`, the ends of its 80 %
    interval, all [s] on the clock of the windows; infinite where it may never be reached.

    None lies before the moment that it was worked out for, which also stands for a limit that may be reached by then.
    `still`: time [s] since which growth stands still, NaN where it hardly does.
    """

    quantity: str
    median: float
    low: float
    high: float
    still: float = np.nan

    def hours_from(self, time: float) -> tuple[float, float, float]:
        """Return the hours from `time` [s] to the median and to both ends; 0 where that moment has passed."""
        median, low, high = (max(float(at - time), 0.0) / 3600 for at in (self.median, self.low, self.high))
        return median, low, high


@dataclass(frozen=True)
class Growth:
    """Growth of one quantity over its own baseline, arrays (s,) of shifts: `time` [h], `value`, `variance`; `shared`:
    standard deviation of the error that all shifts share; `start`: end of what is normal [h]."""

    time: np.ndarray
    value: np.ndarray
    variance: np.ndarray
    shared: float
    start: float

    def clear(self, by: float, least_variance: float = 0.0) -> bool:
        """Return whether the growth of the last shifts is more than `by` standard deviations above zero."""
        if not len(self.value):
            return False
        value, variance = self.value[-LATEST:], np.maximum(self.variance[-LATEST:], least_variance)
        return bool(np.mean(value) > by * np.sqrt(np.mean(variance) / len(value) + self.shared**2))


class Limits:
    """What of the growth of the axes of one robot is viscous, and when it reaches a limit, by what is known at the last
    of the windows.

    Parameters
    ----------
    level, viscous : what was watched. share : (n,) of Coulomb friction in the friction of the baseline.
    shift : (w,) labels. end : (w,) [s]. limit : relative growth.
    together : (w,) bool, where all axes move together, as in the cold, None for nowhere: what viscous friction does
    there raises no alarm, and where nothing else tells of its growth it gives no date either.
    """

    def __init__(
        self,
        level: Watch,
        viscous: Watch,
        share: np.ndarray,
        shift: np.ndarray,
        end: np.ndarray,
        limit: float,
        together: np.ndarray | None = None,
    ) -> None:
        self._apart = np.ones(len(shift), dtype=bool) if together is None else ~together
        self.level, self.viscous, self._share = level, viscous, share
        self._shift, self._end, self._limit = shift, end, limit
        self._place = np.arange(len(shift))
        self._grown: dict[int, ViscousGrowth] = {}

    def grown(self, j: int) -> ViscousGrowth:
        """Return what of the growth of the 0-based axis `j` is viscous, by all windows."""
        if j not in self._grown:
            share = float(self._share[j])
            self._grown[j] = viscous_growth(self.level, self.viscous, j, self._shift, share)
        return self._grown[j]

    def forecast(self, j: int, name: str, now: bool = False) -> LimitDate | None:
        """Return which limit of the 0-based axis `j` is reached first, and when, None where no date is due.

        That of the quantity `name`, or of the other one where that has clearly grown as well. With `now`, none of a
        quantity whose growth cannot be told from zero.
        """
        own, other = self._growth(j, name), COULOMB if name == VISCOUS else VISCOUS
        found = []
        if own is not None and (not now or own.clear(Q80)):
            found.append(self._of(own, name))
        too = self._growth(j, other, self._apart if other == VISCOUS else None)
        counts = too is not None and len(too.value) >= LATEST and self._counts(j, other)
        if counts and too.clear(VISCOUS_CLEAR, self._wander(j, other)):
            found.append(self._of(too, other))
        known = [date for date in found if not np.isnan(date.median)]
        return min(known, key=lambda date: (date.median, date.low, date.high), default=None)

    def _of(self, grown: Growth, name: str) -> LimitDate:
        """Return when growth of a quantity reaches its limit, NaN where too few shifts tell."""
        now = float(self._end[-1])
        found = forecast_shifts(
            grown.time, grown.value, grown.variance, self._limit,
            shared=grown.shared, start=grown.start, now=now / 3600,
        )  # fmt: skip
        median, low, high = (now + 3600 * hours for hours in (found.hours, found.low, found.high))
        return LimitDate(name, median, low, high, 3600 * found.still)

    def _counts(self, j: int, name: str) -> bool:
        """Return whether a quantity makes up enough of the friction of an axis for its growth to be told in percent."""
        return name == COULOMB or self._share[j] <= 1.0 - LEAST_VISCOUS

    def _wander(self, j: int, name: str) -> float:
        """Return the variance of the growth of viscous friction in shifts outside episodes, 0 of Coulomb friction."""
        if name == COULOMB:
            return 0.0
        quiet = after_baseline(self.level.baseline) & self._apart
        for episode, _ in episode_parts(self.level, j, self._shift):
            quiet[episode] = False
        means = shift_means(self.viscous, j, quiet, self._shift, self._end)
        return viscous_scale(float(self._share[j])) ** 2 * wander(means)

    def _growth(self, j: int, name: str, within: np.ndarray | None = None) -> Growth | None:
        """Return the growth of a quantity, of viscous friction in windows `within` (w,) bool alone; None where none is
        known."""
        if name == COULOMB and self.level.axes[j] is not None:
            return self._coulomb(j)
        if self.viscous.axes[j] is None:
            return None
        means, start = self._means(self.viscous, j, within)
        if not len(means.value):
            return None
        scale, shared = viscous_scale(float(self._share[j])), normal_error(self.viscous, j)
        return Growth(means.time / 3600, scale * means.value, scale**2 * means.variance, scale * shared, start)

    def _coulomb(self, j: int) -> Growth | None:
        axis = self.level.axes[j]
        means, start = self._means(self.level, j)
        grown = self.grown(j)
        named = bool(grown.named[-1])
        if not len(means.value) or (named and axis.source != "friction"):
            return None
        value, variance, shared = np.expm1(means.value), means.variance.copy(), normal_error(self.level, j)
        if named:
            # The part that is viscous is none of Coulomb friction; before the episode there is none.
            parts = shift_means(self.viscous, j, grown.named, self._shift, self._end)
            _, a, b = np.intersect1d(means.shift, parts.shift, return_indices=True)
            value[a] -= parts.value[b]
            variance[a] += parts.variance[b]
            shared = float(np.hypot(shared, normal_error(self.viscous, j)))
        elif grown.taken[-1] > 0:
            value[np.isin(means.shift, self._shift[grown.taken > 0])] *= 1.0 - grown.taken[-1]
        scale = axis.to_coulomb
        return Growth(means.time / 3600, scale * value, scale**2 * variance, scale * shared, start)

    def _means(self, watched: Watch, j: int, within: np.ndarray | None = None) -> tuple[ShiftMeans, float]:
        """Return the means of the shifts since growth last began anew, and the end of what is normal [h]."""
        begin = max([s.window for s in watched.starts[j] if s.grown is None], default=0)
        rows = after_baseline(watched.baseline) & (self._place >= begin)
        rows &= True if within is None else within
        before = np.flatnonzero(watched.baseline) if not begin else np.arange(begin)
        start = float(self._end[before[-1]]) / 3600 if len(before) else float(self._end[0]) / 3600
        return shift_means(watched, j, rows, self._shift, self._end), start
