"""Which axis changed: probabilities from the charts of all axes.

Friction acts on its own joint's torque, so that the Coulomb estimates of the axes are independent of each other but
for the noise they share; no propagation through the arm has to be undone. The evidence for a change of one axis is
exp(Z^2 / 2), the largest likelihood ratio over its averages.
"""

from __future__ import annotations

import numpy as np


def axis_probability(statistic: np.ndarray, threshold: np.ndarray) -> np.ndarray:
    """Return for every axis the probability that it changed, given that one of those not yet explained did, (..., n).

    Parameters
    ----------
    statistic : (..., n) of :class:`jointwear.monitor.charts.Trace`, NaN where an axis is not judged.
    threshold : (..., n). Axes above their own are certain to be told apart: several may wear at once, so that they
        are no rivals of each other, only of the axes below.
    """
    z = np.nan_to_num(statistic)
    evidence = np.where(np.isfinite(statistic), np.exp(np.minimum(z, 30.0) ** 2 / 2), 0.0)
    rivals = np.where(z > threshold, 0.0, evidence)
    others = rivals.sum(axis=-1, keepdims=True) - rivals
    total = evidence + others
    return np.divide(evidence, total, out=np.zeros_like(total), where=total > 0)


def named_axis(alarm: np.ndarray, statistic: np.ndarray) -> np.ndarray:
    """Return the 1-based axis with the largest evidence among those that alarm, 0 where none does, (...,)."""
    z = np.where(alarm, np.nan_to_num(statistic), -1.0)
    return np.where(alarm.any(axis=-1), z.argmax(axis=-1) + 1, 0)
