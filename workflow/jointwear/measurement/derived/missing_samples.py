"""Samples that are missing: short holes are bridged, by curves where splines follow, long ones end what is judged."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import binary_dilation

from jointwear.statistics.runs import runs

#: Samples in a row of a position, velocity or acceleration that may be missing and are bridged.
LONGEST_BRIDGE = 2
#: Share of the samples up to which they are a handful, and samples that a curve goes through at least.
FEW, FEWEST_OF_CURVE = 1e-3, 4


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


def few_short(missing: np.ndarray, pieces: list[slice]) -> bool:
    """Return whether next to none of the samples (m, n) are missing, and no more in a row than are bridged."""
    if missing.mean() > FEW:
        return False
    lengths = (r.stop - r.start for p in pieces for column in missing[p].T for r in runs(column) if column[r.start])
    return max(lengths, default=0) <= LONGEST_BRIDGE


def curved(values: np.ndarray, missing: np.ndarray, pieces: list[slice]) -> np.ndarray:
    """Return values (m, n) of a motion in even steps with a cubic spline in place of what is missing (m, n) in each
    piece."""
    result = np.array(values, dtype=float)
    for p in pieces:
        lead_over(np.arange(p.stop - p.start), result[p], missing[p])
    return result


def lead_over(time: np.ndarray, values: np.ndarray, missing: np.ndarray) -> None:
    """Put values (k, n) of a motion where they are `missing` (k, n) onto cubic splines through all others, in place.

    Beside positions to the last digit of an encoder a straight line through a curve is a sample that stands out, and
    its corner is an acceleration that nobody made.
    """
    for j in np.flatnonzero(missing.any(axis=0)):
        lost = missing[:, j]
        if (~lost).sum() >= FEWEST_OF_CURVE:
            values[lost, j] = CubicSpline(time[~lost], values[~lost, j])(time[lost])


def reached(missing: np.ndarray, reach: int) -> np.ndarray:
    """Return which samples (m,) bool lie within `reach` samples of one that is missing, (m,) bool."""
    return binary_dilation(missing, np.ones(2 * reach + 1))
