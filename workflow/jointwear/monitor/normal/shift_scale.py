"""How far off a shift is, told by the other axes.

What the normal state does not know comes to all axes of a robot at once, in different directions: weather that no
thermometer shows, a program that warms some axes and cools others, services of several axes. Standardised residuals
of the axes of a shift thus follow a multivariate Student law, whose axes share one scale. Given the others, that of
an axis is (nu + sum of their squares) / (nu + their number): beyond one where several axes are off, below one where
all keep still. About which scale that of a shift lies is learnt from the robot's shifts before, again from the other
axes: a robot in a steady hall stays far within what floors and priors expect of robots at large.

Scatters are estimated axis by axis. Where those of the others are too wide their keeping still says nothing of this
one, so that growth is held to no scale below that of the axis itself in the shifts of its baseline
(:func:`own_scale`).

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
) -> np.ndarray:
    """Return the factor (w, n) of what is not known of each axis in the shift of each window, so far.

    Parameters
    ----------
    residual : (w, n) log levels less normal state and shared error, NaN where not judged. variance : (w, n) of the
    residuals. noise : (w, n) the part that windows do not share. memory : (n,) of windows within a shift.
    shift : (w,) labels. outside : (w, n) bool, beyond the range of the baseline or where all axes rose, where others
    that keep still say little of the error of a law that is carried too far.
    """
    starts = shift_starts(shift)
    square, known = _squares(residual, variance, noise, memory, starts)
    others, squares = _of_others(known.astype(float)), _of_others(square)
    seen, before = PAST * _before(others, starts), PAST * _before(squares, starts)
    usual = (FREEDOM + before) / (FREEDOM + seen)
    scale = (FREEDOM * usual + squares) / (FREEDOM + others)
    return np.where(outside, np.maximum(scale, 1.0), scale)


def own_scale(
    residual: np.ndarray,
    variance: np.ndarray,
    noise: np.ndarray,
    memory: np.ndarray,
    shift: np.ndarray,
    baseline: np.ndarray,
) -> np.ndarray:
    """Return the factor (n,), up to 1, of what is not known of each axis by its own shifts of the `baseline` (w,) bool.

    The others are those of :func:`shift_scale`.
    """
    starts = shift_starts(shift)
    square, known = _squares(residual, variance, noise, memory, starts)
    ends = baseline & _ends(starts)
    return np.minimum((FREEDOM + square[ends].sum(axis=0)) / (FREEDOM + known[ends].sum(axis=0)), 1.0)


def _squares(
    residual: np.ndarray, variance: np.ndarray, noise: np.ndarray, memory: np.ndarray, starts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the standardised square (w, n) of the mean of the shift so far at each window, and where it is known."""
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
    return square, known


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
