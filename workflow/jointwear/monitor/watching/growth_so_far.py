"""What an axis has grown by when a program begins that its baseline lacks, or that an event of the config tells of.

The level of a new program is learnt from its own first windows. Wear does not stop for it: what was learnt as the level
without the growth so far would hide that growth from then on.
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.normal.dispersion import inflated
from jointwear.monitor.normal.learning import AxisNormal

#: Last shifts of known programs that tell of it.
SHIFTS = 2
#: A priori most axes have grown by nothing (with the standard deviation LITTLE, log level), and the share WORN of them
#: by something of the order of LARGE: without it the errors of the last shifts would become those of the new program.
LITTLE, LARGE, WORN = 0.002, 0.15, 0.1


def growth_so_far(
    normal: AxisNormal, residual: np.ndarray, predicted: np.ndarray, shift: np.ndarray, known: np.ndarray
) -> tuple[float, float]:
    """Return the growth of the level (log) over the normal state and its variance, 0 and 0 where nothing tells.

    Parameters are those of :func:`measured_growth`.
    """
    measured = measured_growth(normal, residual, predicted, shift, known)
    return (0.0, 0.0) if measured is None else shrunk(*measured)


def measured_growth(
    normal: AxisNormal, residual: np.ndarray, predicted: np.ndarray, shift: np.ndarray, known: np.ndarray
) -> tuple[float, float] | None:
    """Return what the last shifts show of the growth of the level (log), and its variance; None where nothing tells.

    Parameters
    ----------
    residual, predicted : (w,) log level over the normal state, and variance of what that predicts.
    shift : (w,) labels. known : windows so far that ran known programs.
    """
    names = np.unique(shift[known])[-SHIFTS:]
    if not len(names):
        return None
    means, precisions = [], []
    for name in names:
        rows = known[shift[known] == name]
        weight = 1.0 / (normal.noise[rows] + predicted[rows])
        spread = float(inflated(len(rows), normal.dispersion.memory)) / weight.sum() + normal.dispersion.between**2
        means.append(float(weight @ residual[rows] / weight.sum()))
        precisions.append(1.0 / spread)
    share = np.array(precisions)
    return float(share @ means / share.sum()), float(1.0 / share.sum())


def shrunk(mean: float, variance: float) -> tuple[float, float]:
    """Return mean and variance of the growth that a measured `mean` of `variance` tells of, under the prior above."""
    prior, odds = np.array([LITTLE**2, LARGE**2]), _odds(mean, variance)
    total = prior + variance
    each = prior / total * mean
    value = float(odds @ each)
    return value, float(odds @ (prior * variance / total + each**2)) - value**2


def stands_out(mean: float, variance: float) -> bool:
    """Return whether a measured `mean` of `variance` is rather growth than none, under the prior above."""
    return mean > 0 and bool(_odds(mean, variance)[1] > 0.5)


def _odds(mean: float, variance: float) -> np.ndarray:
    """Return how likely it is (2,) that the axis has not grown, and that it has."""
    total = np.array([LITTLE**2, LARGE**2]) + variance
    logs = np.log([1.0 - WORN, WORN]) - 0.5 * np.log(total) - 0.5 * mean**2 / total
    odds = np.exp(logs - logs.max())
    return odds / odds.sum()
