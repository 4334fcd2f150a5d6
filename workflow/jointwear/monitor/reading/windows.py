"""Sufficient statistics of the residual torque, window by window: all that the judgement needs of a log.

Residual: measured torque minus the model with its nominal friction and effects. In a window and on one axis it is
regressed on five columns,

    residual = d_positive x_positive + d_negative x_negative + d_velocity v + k_gravity g + k_inertial i + noise

`positive`, `negative` : 1 where v > dead band, -1 where v < -dead band, else 0. Their coefficients are the changes of
    the Coulomb friction [N m] of either direction, both positive where friction grows: a symmetric change d has
    d_positive = d_negative = d, so that its column is the sum of the two; a constant torque offset o has
    d_positive = o, d_negative = -o.
`velocity` : v [rad/s]; its coefficient is the change of the viscous friction [N m s/rad].
`gravity`, `inertial` : torque of the model that holds the axis against gravity, and the rest of its rigid-body torque
    (inertia, motor inertia, Coriolis) [N m]. Nuisances: their coefficients are relative errors of the model, so that
    a model a few percent wrong does not look like wear. A column can be zero throughout (gravity of a vertical axis).

Only moving samples count: finite, faster than the dead band, and away from reversals, gaps and filter edges. At rest
friction takes any value between its two levels and shows nothing.

All sums add up, so statistics of pieces of a window (several files, several chunks) are merged without loss.
:func:`.accumulate.window_statistics` makes them from samples, :mod:`.window_files`
keeps them as netCDF.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.flags import DISQUALIFYING, Flag
from jointwear.monitor.reading.program_labels import add_labels

REGRESSORS = ("positive", "negative", "velocity", "gravity", "inertial")
#: Bins of the torque histogram from -SPAN to +SPAN times the reference torque; 120 bins fall on [0, 1], so that 12
#: (or 10, 15, 20, 24 ...) coarse bins are sums of whole fine ones.
HISTOGRAM_BINS, HISTOGRAM_SPAN = 288, 1.2
#: Highest correlation from sample to sample that noise is taken to have.
MOST_CORRELATED = 0.999


@dataclass(frozen=True)
class WindowStatistics:
    """Statistics of w windows of a robot with n axes and p = 5 regressors (:data:`REGRESSORS`).

    Attributes
    ----------
    start, end : (w,) [s] borders of the windows on a fixed grid; since 1970 UTC where `dated`, else of the log's clock.
    gram : (w, n, p, p) sum of x x' over the used samples. moment : (w, n, p) sum of x r. square : (w, n) sum of r^2.
    count : (w, n) used samples. samples : (w,) all samples of the log.
    residual_square, freedom : (w, n) sum of e^2 and its degrees of freedom, where e = r - x'b with b fitted in the same
        piece of the window; their ratio is the noise variance [N2 m2].
    lag_square, lag_count : (w, n) sum of e_k e_(k+1) over neighbouring used samples, and their number:
        lag_square / lag_count over the noise variance is the lag-1 autocorrelation.
    score : (w, n, p, p) sum over blocks of s s', s the sum of x e in a block: the middle of the sandwich estimate of
        covariance, inv(gram) score inv(gram), which is honest under noise coloured up to the length of a block, given
        many more blocks than columns; with fewer it is too small.
    blocks, stretches : (w, n) number of blocks in `score`, and of uninterrupted stretches of motion.
    travel : (w, n) path of the joint [rad]. torque_peak : (w, n) largest |torque| [N m].
    temperature, temperature_count : (w, n) mean [degC] (NaN if unknown) and the samples that it is the mean of.
    torque_histogram : (w, n, HISTOGRAM_BINS) number of finite torque samples in equal bins from -HISTOGRAM_SPAN to
        HISTOGRAM_SPAN times `torque_reference` (n,) [N m]; what lies beyond counts in the outer bins.
    pulse_near, pulse_far : (w, n) sums of the squares of the quick part of e [N2 m2] near reversals of the
        load and away from them, `near_count`, `far_count` their numbers of samples, `turns` the reversals
        (:mod:`jointwear.monitor.reading.reversals`).
    turned, turned_shown : (w, n) what all axes tell of the angle by which each joint counts from another zero
        (:mod:`jointwear.monitor.reading.zeros`): their ratio is the angle [rad]; zeros where that was not asked.
    labels : (w,) samples of each program that the log names, as text (:mod:`jointwear.monitor.reading.program_labels`);
        empty without.
    flags : (w, n) bit field of :class:`Flag`.
    """

    start: np.ndarray
    end: np.ndarray
    gram: np.ndarray
    moment: np.ndarray
    square: np.ndarray
    count: np.ndarray
    samples: np.ndarray
    residual_square: np.ndarray
    freedom: np.ndarray
    lag_square: np.ndarray
    lag_count: np.ndarray
    score: np.ndarray
    blocks: np.ndarray
    stretches: np.ndarray
    travel: np.ndarray
    torque_peak: np.ndarray
    temperature: np.ndarray
    temperature_count: np.ndarray
    torque_histogram: np.ndarray
    torque_reference: np.ndarray
    pulse_near: np.ndarray
    pulse_far: np.ndarray
    near_count: np.ndarray
    far_count: np.ndarray
    turns: np.ndarray
    turned: np.ndarray
    turned_shown: np.ndarray
    labels: np.ndarray
    flags: np.ndarray
    dated: bool = False

    @property
    def windows(self) -> int:
        """Number of windows."""
        return len(self.start)

    @property
    def axes(self) -> int:
        """Number of axes."""
        return self.count.shape[1]

    @property
    def length(self) -> float:
        """Length of a window [s]."""
        return float(self.end[0] - self.start[0]) if self.windows else float("nan")

    @property
    def share_used(self) -> np.ndarray:
        """Share of the samples that were used, (w, n)."""
        return self.count / np.maximum(self.samples, 1)[:, None]

    @property
    def noise_variance(self) -> np.ndarray:
        """Variance of the noise around the regression [N2 m2], (w, n); NaN without degrees of freedom."""
        return np.where(self.freedom > 0, self.residual_square / np.maximum(self.freedom, 1), np.nan)

    @property
    def autocorrelation(self) -> np.ndarray:
        """Lag-1 autocorrelation of the noise in [-1, 1], (w, n); 0 where it is unknown."""
        covariance = self.lag_square / np.maximum(self.lag_count, 1)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = covariance / self.noise_variance
        return np.clip(np.nan_to_num(ratio, nan=0.0, posinf=0.0, neginf=0.0), -1.0, 1.0)

    @property
    def effective_count(self) -> np.ndarray:
        """Number of independent samples that tell as much as `count` first-order autoregressive ones, (w, n)."""
        rho = np.clip(self.autocorrelation, 0.0, MOST_CORRELATED)
        return self.count * (1 - rho) / (1 + rho)

    @property
    def judgeable(self) -> np.ndarray:
        """Where nothing disqualifies the window, (w, n) bool; says nothing on how well friction can be seen."""
        return (self.flags & int(DISQUALIFYING)) == 0

    def part(self, chosen: Any) -> WindowStatistics:
        """Return the windows `chosen` (mask, index or slice over windows)."""
        return replace(self, **{name: getattr(self, name)[chosen] for name in PER_WINDOW})


#: Fields with one row a window, and how the rows of two pieces of one window are put together.
_SUMMED = (
    "gram", "moment", "square", "count", "samples", "residual_square", "freedom", "lag_square", "lag_count", "score",
    "blocks", "stretches", "travel", "temperature_count", "torque_histogram", "pulse_near", "pulse_far", "near_count",
    "far_count", "turns", "turned", "turned_shown",
)  # fmt: skip
PER_WINDOW = tuple(f.name for f in fields(WindowStatistics) if f.name not in ("torque_reference", "dated"))
_WHOLE = (
    "count", "samples", "lag_count", "blocks", "stretches", "temperature_count", "torque_histogram", "near_count",
    "far_count", "turns", "flags",
)  # fmt: skip


def blank_statistics(
    start: np.ndarray, length: float, torque_reference: np.ndarray, dated: bool = False
) -> WindowStatistics:
    """Return windows without any sample; `start` (w,) [s], `length` [s], `torque_reference` (n,) [N m]."""
    start = np.asarray(start, dtype=float)
    w, n, p = len(start), len(torque_reference), len(REGRESSORS)
    shapes = {"gram": (w, n, p, p), "score": (w, n, p, p), "moment": (w, n, p), "samples": (w,)}
    shapes["torque_histogram"] = (w, n, HISTOGRAM_BINS)
    values = {
        name: np.zeros(shapes.get(name, (w, n)), dtype=np.int64 if name in _WHOLE else float)
        for name in PER_WINDOW
        if name not in ("start", "end", "labels")
    }
    values["labels"] = np.full(w, "", dtype=object)
    values["temperature"][:] = np.nan
    return WindowStatistics(
        start=start,
        end=start + length,
        **values,
        torque_reference=np.asarray(torque_reference, dtype=float),
        dated=dated,
    )


def merge(parts: Sequence[WindowStatistics]) -> WindowStatistics:
    """Put statistics of files or chunks together: windows with the same start are added up; ordered by time.

    Raises
    ------
    ValueError : if there is nothing to merge, or the parts differ in length of window or axes.
    InputError : if their torque references differ.
    """
    parts = [p for p in parts if p.windows] or list(parts)[:1]
    if not parts:
        raise ValueError("no statistics to merge")
    length, first = parts[0].length, parts[0]
    for other in parts[1:]:
        if other.axes != first.axes or not np.isclose(other.length, length):
            raise ValueError("statistics of different windows or robots cannot be merged")
        if not np.allclose(other.torque_reference, first.torque_reference):
            raise InputError("windows with different torque references cannot be merged; delete them and run again")
    if not first.windows:
        return first
    key = np.concatenate([np.rint(p.start / length).astype(np.int64) for p in parts])
    keys, place = np.unique(key, return_inverse=True)
    total = blank_statistics(keys * length, length, first.torque_reference, all(p.dated for p in parts))
    for name in _SUMMED:
        np.add.at(getattr(total, name), place, np.concatenate([getattr(p, name) for p in parts]))
    add_labels(total.labels, place, np.concatenate([p.labels for p in parts]))
    np.maximum.at(total.torque_peak, place, np.concatenate([p.torque_peak for p in parts]))
    np.bitwise_or.at(total.flags, place, np.concatenate([p.flags for p in parts]))
    # A window that rests in one file and moves in another moves.
    total.flags[total.count > 0] &= ~int(Flag.AT_REST)
    warm = np.zeros_like(total.temperature)
    sums = [np.nan_to_num(p.temperature) * p.temperature_count for p in parts]
    np.add.at(warm, place, np.concatenate(sums))
    with np.errstate(invalid="ignore", divide="ignore"):
        total.temperature[:] = np.where(total.temperature_count > 0, warm / total.temperature_count, np.nan)
    return total
