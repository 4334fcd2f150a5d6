"""How far off a shift is, told by the other axes.

What the normal state does not know comes to all axes of a robot at once, in different directions: weather that no
thermometer shows, a program that warms some axes and cools others, services of several axes. Standardised residuals
of the axes of a shift thus follow a multivariate Student law, whose axes share one scale. Given the others, that of
an axis is (nu + sum of their squares) / (nu + their number): beyond one where several axes are off, below one where
all keep still. About which scale that of a shift lies is learnt from the robot's shifts before, again from the other
axes: a robot in a steady hall stays far within what floors and priors expect of robots at large.

How far off an axis itself was in the shifts of the baseline bounds how far the others may narrow it: scatters are
estimated axis by axis, and where those of the others are too wide, their keeping still says nothing of this one.

The noise of the windows themselves is measured, axis by axis, and no such expectation: the scale leaves it as it is, or
the first windows of a shift would count for more than they tell.
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.normal.dispersion import inflated
from jointwear.monitor.normal.shifts import running_sums, shift_starts

#: Degrees of freedom of the law, and the largest square of an axis that counts: one worn axis is no shift that is off.
FREEDOM, LARGEST = 5.0, 6.0
#: What an axis in an earlier shift counts for: shifts share the error of the normal state, and weather lasts.
PAST = 0.25


def shift_scale(
    residual: np.ndarray,
    variance: np.ndarray,
    noise: np.ndarray,
    memory: np.ndarray,
    shift: np.ndarray,
    outside: np.ndarray,
    baseline: np.ndarray | None = None,
) -> np.ndarray:
    """Return the factor (w, n) of what is not known of each axis in the shift of each window, so far.

    Parameters
    ----------
    residual : (w, n) log levels less normal state and shared error, NaN where not judged. variance : (w, n) of the
    residuals. noise : (w, n) the part that windows do not share. memory : (n,) of windows within a shift.
    shift : (w,) labels. outside : (w, n) bool, beyond the range of the baseline or where all axes rose, where others
    that keep still say little of the error of a law that is carried too far.
    baseline : (w,) bool, windows of the normal period, in which an axis tells of itself; default none are told.
    """
    starts = shift_starts(shift)
    good = np.isfinite(residual) & np.isfinite(variance) & (noise > 0)
    square = np.zeros(residual.shape)
    known = np.zeros(residual.shape, dtype=bool)
    for j in np.flatnonzero(good.any(axis=0)):
        rows = good[:, j]
        weight = np.where(rows, 1.0 / np.where(rows, noise[:, j], 1.0), 0.0)
        total, count = running_sums(weight, starts), running_sums(rows.astype(float), starts)
        known[:, j] = total > 0
        safe = np.where(known[:, j], total, 1.0)
        mean = running_sums(weight * np.where(rows, residual[:, j], 0.0), starts) / safe
        apart = np.where(rows, variance[:, j] - noise[:, j], 0.0)
        spread = running_sums(weight * apart, starts) / safe + inflated(count, float(memory[j])) / safe
        square[:, j] = np.where(known[:, j], np.minimum(mean**2 / spread, LARGEST), 0.0)
    others, squares = _of_others(known.astype(float)), _of_others(square)
    seen, before = PAST * _before(others, starts), PAST * _before(squares, starts)
    usual = (FREEDOM + before) / (FREEDOM + seen)
    scale = (FREEDOM * usual + squares) / (FREEDOM + others)
    if baseline is not None:
        ends = baseline & _ends(starts)
        own = (FREEDOM + square[ends].sum(axis=0)) / (FREEDOM + known[ends].sum(axis=0))
        scale = np.maximum(scale, np.minimum(own, 1.0))
    return np.where(outside, np.maximum(scale, 1.0), scale)


def _of_others(values: np.ndarray) -> np.ndarray:
    """Return the sum (w, n) of `values` (w, n) over all axes but each one."""
    return values.sum(axis=1, keepdims=True) - values


def _ends(starts: np.ndarray) -> np.ndarray:
    """Return the last window of each shift, (w,) bool, of their first ones."""
    return np.append(starts[1:], True) if len(starts) else np.zeros(0, dtype=bool)


def _before(values: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the sum (w, n) of `values` (w, n) at the ends of all shifts before that of each window.

    Parameters
    ----------
    starts : (w,) bool, the first window of a shift.
    """
    ends = np.flatnonzero(_ends(starts))
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values[ends], axis=0)])
    return total[np.cumsum(starts) - 1]
