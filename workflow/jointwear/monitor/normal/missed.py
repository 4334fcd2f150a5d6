"""By how much shifts of the baseline miss the prediction of their program, where that is more than its errors tell.

One dispersion stands for all windows of an axis, and is estimated so that a few odd ones do not count. But a program
whose motion hardly tells a quantity may show it differently from shift to shift by far more than the others: a light
wrist with parts of several masses.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.monitor.normal.dispersion import ShiftMeans, shift_means
from jointwear.monitor.normal.learning import AxisNormal


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
        design=replace(axis.design, beyond=axis.design.beyond + missed),
        fit=replace(axis.fit, left_out_variance=told + missed),
        missed=float(np.sqrt(missed.max(initial=0.0))),
    )


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
