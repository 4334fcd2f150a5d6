"""Samples that are missing: short holes are bridged by straight lines, long ones end what can be judged."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import binary_dilation

from jointwear.statistics.runs import runs

#: Samples in a row of a position, velocity or acceleration that may be missing and are bridged.
LONGEST_BRIDGE = 2


def long_gaps(values: np.ndarray, pieces: list[slice]) -> np.ndarray:
    """Return the samples (m,) at which more values (m, n) of some joint are missing in a row than are bridged."""
    result = np.zeros(len(values), bool)
    missing = ~np.isfinite(values)
    for j in np.flatnonzero(missing.any(axis=0)):
        for p in pieces:
            for run in runs(missing[p, j]):
                if run.stop - run.start > LONGEST_BRIDGE:
                    result[p][run] |= missing[p, j][run]
    return result


def bridge(values: np.ndarray, pieces: list[slice]) -> np.ndarray:
    """Return values (m, n) with straight lines through what is missing within a piece, 0 where a piece has none."""
    if np.isfinite(values).all():
        return np.asarray(values, dtype=float)
    result = np.array(values, dtype=float)
    for p in pieces:
        for j in range(result.shape[1]):
            x = result[p, j]
            good = np.isfinite(x)
            if good.any() and not good.all():
                x[~good] = np.interp(np.flatnonzero(~good), np.flatnonzero(good), x[good])
            elif not good.any():
                x[:] = 0.0
    return result


def reached(missing: np.ndarray, reach: int) -> np.ndarray:
    """Return which samples (m,) bool lie within `reach` samples of one that is missing, (m,) bool."""
    return binary_dilation(missing, np.ones(2 * reach + 1))
