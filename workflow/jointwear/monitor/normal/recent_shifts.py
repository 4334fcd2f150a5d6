"""What the last shifts of one axis tell at every window: their residuals, their variance and what they share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.dispersion import inflated
from jointwear.monitor.normal.normal_state import Posterior
from jointwear.monitor.normal.shifts import places_of_shifts, running_sums, shift_starts

#: Shifts looked back at, and so many more to find them among, as some show nothing.
BACK, SPARE = 12, 4
#: Windows of a shift that scatter more than their noise show that their conditions are not all known; what is unknown
#: comes in runs (a program, a part, a speed), of which a shift holds no more than this many.
RUNS_IN_SHIFT = 2.0
#: Share of the variance of shared error and range that neighbouring shifts have in common: weather lasts for days.
CARRIED = 0.7
#: Variance of a place without a shift: it is known to nothing.
UNKNOWN = 1e6


@dataclass(frozen=True)
class AxisWindows:
    """The windows of one axis in order of time, arrays (w,) unless told.

    Attributes
    ----------
    value : log level less shared error; NaN where not judged. variance : noise of the windows.
    design : (w, p). which : the normal state that holds at each window, by what was known then. shift : labels.
    between : standard deviation between shifts. extra : variance that all windows of a shift share (shared error,
    range), and part of which carries on. inside : bool, at temperatures that the baseline had.
    scale : factor of what is not known of the shift of each window so far (:mod:`.shift_scale`); the noise of its
    windows is known from the windows, and stays.
    calm : bool, in shifts in which the axes have not moved together so far.
    """

    value: np.ndarray
    variance: np.ndarray
    design: np.ndarray
    which: np.ndarray
    shift: np.ndarray
    between: np.ndarray
    extra: np.ndarray
    inside: np.ndarray
    scale: np.ndarray
    calm: np.ndarray

    def part(self, rows: slice) -> AxisWindows:
        """Return the windows `rows` alone."""
        return AxisWindows(**{name: value[rows] for name, value in vars(self).items()})


@dataclass(frozen=True)
class RecentShifts:
    """The last :data:`BACK` shifts of every window, its own first as far as it goes; (w, BACK) unless told.

    Attributes
    ----------
    judged : (w,) bool. count : windows of the shift that are judged, of the running one so far.
    known : bool, whether there is such a shift; those that show nothing are passed over.
    residual : mean of the shift less the normal state that holds at the window. variance : its own; infinite where
    nothing is known. noise : the part of it that comes of the noise of windows. carried : standard deviation of the
    part of it that neighbours share. loud : factor of the standard deviation of all but the noise. usual : bool, mostly
    at temperatures that the baseline had.
    design : (w, BACK, p). which : (w,) the normal state that holds. normal : covariances (s, p, p) of normal states.
    """

    judged: np.ndarray
    count: np.ndarray
    known: np.ndarray
    residual: np.ndarray
    variance: np.ndarray
    noise: np.ndarray
    carried: np.ndarray
    loud: np.ndarray
    usual: np.ndarray
    design: np.ndarray
    which: np.ndarray
    normal: np.ndarray

    def covariance(self, rows: np.ndarray, count: int) -> np.ndarray:
        """Return the covariance (r, count, count) of the residuals of the last `count` shifts at windows `rows` (r,).

        Parameters
        ----------
        count : up to :data:`BACK`. A place without a shift has the variance :data:`UNKNOWN`.
        """
        known, noise, carried, loud = (a[rows, :count] for a in (self.known, self.noise, self.carried, self.loud))
        predicted = _of_predictions(self.design[rows, :count], self.normal, self.which[rows])
        shared = predicted + carried[:, :, None] * carried[:, None, :]
        result = np.where(known[:, :, None] & known[:, None, :], shared, 0.0)
        own = np.arange(count)
        result[:, own, own] += np.where(known, self.variance[rows, :count] - noise - carried**2, UNKNOWN)
        result *= loud[:, :, None] * loud[:, None, :]
        result[:, own, own] += noise
        return result


def recent_shifts(windows: AxisWindows, normal: Sequence[Posterior], memory: float) -> RecentShifts:
    """Return what the last shifts tell at every window.

    Parameters
    ----------
    normal : normal states. memory : lag-1 correlation of windows within a shift.
    """
    means = np.stack([n.mean for n in normal])
    good = np.isfinite(windows.value) & np.isfinite(windows.variance)
    weight = np.where(good, 1.0 / np.where(good, windows.variance, 1.0), 0.0)
    starts = shift_starts(windows.shift)
    # Rows that are not judged may hold NaN in their design.
    clean = np.where(good[:, None], windows.design, 0.0)
    total, count = running_sums(weight, starts), running_sums(good.astype(float), starts)
    safe = np.where(total > 0, total, 1.0)
    mean = running_sums(weight * np.where(good, windows.value, 0.0), starts) / safe
    at = np.stack([running_sums(weight * column, starts) for column in clean.T], axis=1) / safe[:, None]
    shared = running_sums(weight * np.where(good, windows.extra, 0.0), starts) / safe
    noise = inflated(count, memory) / safe
    own = noise + shared
    odd = _unexplained(windows.value - np.einsum("wp,wp->w", clean, means[windows.which]), weight, count, starts)
    own += np.maximum(odd, _so_far(odd, count, starts)) / RUNS_IN_SHIFT
    order = _judged_first(places_of_shifts(windows.shift, BACK + SPARE), total > 0)
    known, index = order >= 0, np.maximum(order, 0)
    return RecentShifts(
        judged=good,
        count=np.where(known, count[index], 0.0),
        known=known,
        residual=mean[index] - np.einsum("wkp,wp->wk", at[index], means[windows.which]),
        variance=np.where(known, own[index] + windows.between[:, None] ** 2, np.inf),
        noise=np.where(known, noise[index], 0.0),
        carried=np.sqrt(CARRIED * shared[index]),
        loud=np.sqrt(windows.scale)[index],
        usual=(running_sums((good & windows.inside).astype(float), starts) > 0.5 * count)[index],
        design=at[index],
        which=windows.which,
        normal=np.stack([n.covariance for n in normal]),
    )


def _of_predictions(x: np.ndarray, covariances: np.ndarray, which: np.ndarray) -> np.ndarray:
    """Return the covariance (w, k, k) of predictions for designs `x` (w, k, p) by the normal states `which` (w,)."""
    result = np.empty((len(x), x.shape[1], x.shape[1]))
    for state in np.unique(which):
        rows = np.flatnonzero(which == state)
        result[rows] = x[rows] @ covariances[state] @ np.swapaxes(x[rows], 1, 2)
    return result


def _unexplained(error: np.ndarray, weight: np.ndarray, count: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the variance (w,) by which the windows of a shift so far scatter more than their noise.

    Parameters
    ----------
    error : (w,) residuals. weight : (w,) 1 / variance, 0 where not judged. count : (w,) windows of the shift so far.

    Notes
    -----
    The estimator of DerSimonian and Laird (1986), less what chance adds to it by one standard deviation.
    """
    error = np.where(weight > 0, error, 0.0)
    total, square = running_sums(weight, starts), running_sums(weight**2, starts)
    safe = np.where(total > 0, total, 1.0)
    spread = running_sums(weight * error**2, starts) - running_sums(weight * error, starts) ** 2 / safe
    freedom = np.maximum(count - 1, 0.0)
    beyond = spread - freedom - np.sqrt(2 * freedom)
    scale = total - square / safe
    return np.where((freedom > 0) & (beyond > 0), beyond / np.where(scale > 0, scale, np.inf), 0.0)


def _so_far(odd: np.ndarray, count: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the mean (w,) of `odd` (w,) at the end of all shifts before, which may come to any shift; 0 before any.

    Parameters
    ----------
    count : (w,) windows of the shift so far; a shift of one says nothing. starts : (w,) bool.
    """
    last = np.flatnonzero(np.append(starts[1:], True)) if len(starts) else np.zeros(0, dtype=int)
    told = count[last] > 1
    total = np.concatenate([[0.0], np.cumsum(np.where(told, odd[last], 0.0))])
    shifts = np.concatenate([[0], np.cumsum(told)])
    before = np.cumsum(starts) - 1
    return total[before] / np.maximum(shifts[before], 1)


def _judged_first(place: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Return the places (w, BACK) with shifts that show nothing passed over, the running one kept first."""
    valid = (place >= 0) & seen[np.maximum(place, 0)]
    rank = np.argsort(~valid, axis=1, kind="stable")
    ordered = np.where(np.take_along_axis(valid, rank, 1), np.take_along_axis(place, rank, 1), -1)
    return ordered[:, :BACK]
