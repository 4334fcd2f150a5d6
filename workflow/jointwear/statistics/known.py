"""Medians of what is known: NaN where nothing is, without a warning."""

from __future__ import annotations

import warnings

import numpy as np


def known_median(values: np.ndarray, axis: int | None = None) -> np.ndarray:
    """Return the median of the finite values along an axis, NaN where there are none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.nanmedian(np.where(np.isfinite(values), values, np.nan), axis=axis)
