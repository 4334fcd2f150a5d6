"""Medians and sizes of what is known, without a warning where nothing is."""

from __future__ import annotations

import numpy as np

#: Standard deviation of a normal law over the median of its absolute values.
OVER_MEDIAN = 1.4826


def known_median(values: np.ndarray, axis: int | None = None) -> np.ndarray:
    """Return the median of the finite values (...,) along an axis, NaN where there are none.

    By one sort for all rows: numpy takes the medians of rows with gaps one by one, or by masked arrays.
    """
    values = np.asarray(values, dtype=float)
    rows = values.reshape(-1) if axis is None else np.moveaxis(values, axis, -1)
    ordered = np.sort(np.where(np.isfinite(rows), rows, np.nan), axis=-1)
    count = np.isfinite(ordered).sum(axis=-1, keepdims=True)
    if not ordered.shape[-1]:
        return np.full(ordered.shape[:-1], np.nan)[()]
    low, high = (np.take_along_axis(ordered, np.maximum(k, 0) // 2, -1)[..., 0] for k in (count - 1, count))
    # Without any, the first of the ordered values is NaN.
    return 0.5 * (low + high)


def known_rms(values: np.ndarray, fewest: int = 0) -> np.ndarray:
    """Return the root mean square (n,) of the finite ones of values (k, n), infinite where fewer than `fewest` are; 0
    where none is and none is asked for."""
    count = np.isfinite(values).sum(axis=0)
    return np.where(count >= fewest, np.sqrt(np.nansum(values**2, axis=0) / np.maximum(count, 1)), np.inf)
