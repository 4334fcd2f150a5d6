"""By how much shifts and windows of the baseline miss the prediction of their program, where that is more than their
errors tell.

One dispersion stands for all windows of an axis, and is estimated so that a few odd ones do not count. But a program
whose motion hardly tells a quantity may show it differently from shift to shift by far more than the others: a light
wrist with parts of several masses. Or from window to window, by the part of the cycle that a short log holds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.monitor.normal.dispersion import START, ShiftMeans, shift_means, within_shifts
from jointwear.monitor.normal.learning import FEWEST_WINDOWS, AxisNormal

#: Times the scatter of an axis's windows up to which that of a program's windows is the same.
SAME = 2.0


def with_missed(axis: AxisNormal, regime: np.ndarray | None, shift: np.ndarray) -> AxisNormal:
    """Return the axis with what left-out shifts of a program miss as variance of its prediction in that program.

    Parameters
    ----------
    regime : (w,) program of each window, or None. shift : (w,) labels.
    """
    label = np.zeros(len(shift), dtype=int) if regime is None else np.asarray(regime)
    left, told = axis.fit.left_out, axis.fit.left_out_variance
    missed = np.zeros(len(shift))
    for name in np.unique(label[np.isfinite(left)]):
        own = label == name
        of_shifts = shift_means(
            np.where(own, left, np.nan), np.nan_to_num(told), axis.noise, shift, axis.dispersion.memory
        )
        missed[own] = missed_variance(of_shifts, axis.dispersion.between)
    return replace(
        axis,
        design=replace(axis.design, beyond=axis.design.beyond + missed, besides=axis.design.besides + missed),
        fit=replace(axis.fit, left_out_variance=told + missed),
        missed=float(np.sqrt(missed.max(initial=0.0))),
    )


def with_scatter(axis: AxisNormal, regime: np.ndarray | None, shift: np.ndarray) -> AxisNormal:
    """Return the axis with the variance by which windows of a program scatter about their shift, more than the usual
    ones of the axis do, as variance of its windows in that program.

    The parameters are those of :func:`with_missed`.

    Notes
    -----
    The one dispersion is that of the windows in the middle: five windows of a program whose estimate jumped by 20 %,
    of an axis whose others scattered by 4 %, were a false alarm on a robot of the thirty-fourth fleet.
    """
    if regime is None:
        return axis
    left, label = axis.fit.left_out, np.asarray(regime)
    more = np.zeros(len(shift))
    for name in np.unique(label[np.isfinite(left) & (label >= 0)]):
        own = label == name
        if np.isfinite(left[own]).sum() >= FEWEST_WINDOWS:
            extra, _ = within_shifts(np.where(own, left, np.nan), axis.series_variance, shift)
            more[own] = max(extra - SAME**2 * max(axis.dispersion.extra, START.extra), 0.0)
    return replace(axis, series_variance=axis.series_variance + more)


def missed_variance(means: ShiftMeans, between: float) -> float:
    """Return the variance by which left-out shifts miss more than their errors and the standard deviation `between`
    shifts tell; 0 where they do not, or there are none.

    Notes
    -----
    The estimator of DerSimonian and Laird (1986) about zero, less what chance adds to it by one standard deviation.
    """
    count = len(means.mean)
    if not count:
        return 0.0
    weight = 1.0 / (means.variance + between**2)
    excess = float(weight @ means.mean**2) - count - np.sqrt(2 * count)
    return float(max(excess, 0.0) / weight.sum())
