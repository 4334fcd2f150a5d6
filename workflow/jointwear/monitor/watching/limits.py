"""When the friction of an axis reaches its limit: of Coulomb or of viscous friction, whichever comes first."""

from __future__ import annotations

from collections.abc import Sequence
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
    viscous_scale,
    wander,
)
from jointwear.monitor.watching.shift_forecast import Forecast, forecast_shifts
from jointwear.monitor.watching.watching import Watch

COULOMB, VISCOUS = "coulomb friction", "viscous friction"
#: Last shifts whose mean is the growth of now.
LATEST = 2
NOTHING = Forecast(np.nan, np.nan, np.nan)


def in_sentence(quantity: str) -> str:
    """Return the quantity of an alarm as it stands within a sentence: Coulomb is a name."""
    return quantity.replace("coulomb", "Coulomb")


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
    """Forecasts of the axes of one robot.

    Parameters
    ----------
    level, viscous : what was watched. share : (n,) of Coulomb friction in the friction of the baseline.
    grown : of each axis, what of its growth is viscous. shift : (w,) labels. end : (w,) [s]. limit : relative growth.
    together : (w,) bool, where all axes move together, as in the cold, None for nowhere: what viscous friction does
    there raises no alarm, and where nothing else tells of its growth it gives no date either.
    """

    def __init__(
        self,
        level: Watch,
        viscous: Watch,
        share: np.ndarray,
        grown: Sequence[ViscousGrowth],
        shift: np.ndarray,
        end: np.ndarray,
        limit: float,
        together: np.ndarray | None = None,
    ) -> None:
        self._apart = np.ones(len(shift), dtype=bool) if together is None else ~together
        self._level, self._viscous, self._share, self._grown = level, viscous, share, grown
        self._shift, self._end, self._limit = shift, end, limit
        self._place = np.arange(len(shift))

    def forecast(self, k: int, j: int, name: str, now: bool = False) -> tuple[str, Forecast]:
        """Return which limit of axis `j` is reached first by what was known at window `k`, and when.

        That of the quantity `name`, or of the other one where that has clearly grown as well. With `now`, none of a
        quantity whose growth cannot be told from zero.
        """
        own, other = self._growth(k, j, name), COULOMB if name == VISCOUS else VISCOUS
        found = []
        if own is not None and (not now or own.clear(Q80)):
            found.append((name, self._of(own, k)))
        too = self._growth(k, j, other, self._apart if other == VISCOUS else None)
        counts = too is not None and len(too.value) >= LATEST and self._counts(j, other)
        if counts and too.clear(VISCOUS_CLEAR, self._wander(k, j, other)):
            found.append((other, self._of(too, k)))
        known = [one for one in found if not np.isnan(one[1].hours)]
        return min(known, key=lambda one: (one[1].hours, one[1].low, one[1].high), default=(name, NOTHING))

    def _of(self, grown: Growth, k: int) -> Forecast:
        return forecast_shifts(
            grown.time, grown.value, grown.variance, self._limit,
            shared=grown.shared, start=grown.start, now=float(self._end[k]) / 3600,
        )  # fmt: skip

    def _counts(self, j: int, name: str) -> bool:
        """Return whether a quantity makes up enough of the friction of an axis for its growth to be told in percent."""
        return name == COULOMB or self._share[j] <= 1.0 - LEAST_VISCOUS

    def _wander(self, k: int, j: int, name: str) -> float:
        """Return the variance of the growth of viscous friction in shifts outside episodes, 0 of Coulomb friction."""
        if name == COULOMB:
            return 0.0
        quiet = after_baseline(self._level.baseline) & (self._place <= k) & self._apart
        for episode, _ in episode_parts(self._level, j, self._shift):
            quiet[episode] = False
        means = shift_means(self._viscous, j, quiet, self._shift, self._end)
        return viscous_scale(float(self._share[j])) ** 2 * wander(means)

    def _growth(self, k: int, j: int, name: str, within: np.ndarray | None = None) -> Growth | None:
        """Return the growth of a quantity by window `k`, of viscous friction in windows `within` (w,) bool alone; None
        where none is known."""
        if name == COULOMB and self._level.axes[j] is not None:
            return self._coulomb(k, j)
        if self._viscous.axes[j] is None:
            return None
        means, start = self._means(self._viscous, k, j, within)
        if not len(means.value):
            return None
        scale, shared = viscous_scale(float(self._share[j])), normal_error(self._viscous, j)
        return Growth(means.time / 3600, scale * means.value, scale**2 * means.variance, scale * shared, start)

    def _coulomb(self, k: int, j: int) -> Growth | None:
        axis = self._level.axes[j]
        means, start = self._means(self._level, k, j)
        grown, known = self._grown[j], self._place <= k
        named = bool(grown.named[k])
        if not len(means.value) or (named and axis.source != "friction"):
            return None
        value, variance, shared = np.expm1(means.value), means.variance.copy(), normal_error(self._level, j)
        if named:
            # The part that is viscous is none of Coulomb friction; before the episode there is none.
            rows = grown.named & known
            parts = shift_means(self._viscous, j, rows, self._shift, self._end)
            _, a, b = np.intersect1d(means.shift, parts.shift, return_indices=True)
            value[a] -= parts.value[b]
            variance[a] += parts.variance[b]
            shared = float(np.hypot(shared, normal_error(self._viscous, j)))
        elif grown.taken[k] > 0:
            value[np.isin(means.shift, self._shift[(grown.taken > 0) & known])] *= 1.0 - grown.taken[k]
        scale = axis.to_coulomb
        return Growth(means.time / 3600, scale * value, scale**2 * variance, scale * shared, start)

    def _means(self, watched: Watch, k: int, j: int, within: np.ndarray | None = None) -> tuple[ShiftMeans, float]:
        """Return the means of the shifts since growth last began anew, and the end of what is normal [h]."""
        begin = max([s.window for s in watched.starts[j] if s.window <= k and s.grown is None], default=0)
        rows = after_baseline(watched.baseline) & (self._place <= k) & (self._place >= begin)
        rows &= True if within is None else within
        before = np.flatnonzero(watched.baseline) if not begin else np.arange(begin)
        start = float(self._end[before[-1]]) / 3600 if len(before) else float(self._end[0]) / 3600
        return shift_means(watched, j, rows, self._shift, self._end), start
