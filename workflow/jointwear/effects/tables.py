"""Tables over an argument: knots where the data lie, and the piecewise-linear columns between them."""

from __future__ import annotations

import numpy as np


def knots_of(values: np.ndarray, count: int) -> np.ndarray:
    """Return up to `count` knots (k,) over `values` (N,): half evenly spaced, half at quantiles: none is empty."""
    ordered = np.sort(values)
    quantiles = ordered[np.round(np.linspace(0.002, 0.998, count) * (len(ordered) - 1)).astype(int)]
    low, high = quantiles[0], quantiles[-1]
    if high - low <= 1e-9 * max(1.0, abs(low), abs(high)):
        return np.zeros(0)
    even = np.linspace(low, high, count)
    return np.unique(0.5 * (even + quantiles))


def hats(values: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Return piecewise-linear columns (N, k), constant beyond the ends; they sum to one."""
    if len(knots) < 2:
        return np.zeros((len(values), 0))
    x = np.clip(values, knots[0], knots[-1])
    right = np.clip(np.searchsorted(knots, x, side="right"), 1, len(knots) - 1)
    share = (x - knots[right - 1]) / (knots[right] - knots[right - 1])
    # Each column in one piece: they are whitened one by one.
    series = np.zeros((len(knots), len(values)))
    row = np.arange(len(values))
    series[right, row] = share
    series[right - 1, row] = 1 - share
    return series.T
