"""Which axis changed: probabilities from the evidence of all axes.

Friction acts on its own joint's torque, so that the Coulomb estimates of the axes are independent of each other but
for the noise they share; no propagation through the arm has to be undone. The evidence for a change of one axis is
exp(Z^2 / 2), the largest likelihood ratio over its averages.
"""

from __future__ import annotations

import numpy as np

#: Odds that an alarm at its threshold is wear and no chance, where another cause is at hand: beside a stronger alarm of
#: another axis, as robots on which two axes begin to wear in one month are rarer than the false alarms that the stated
#: rate allows in it; and while all axes move together, where what they share may not be all taken out, or where an axis
#: is hardly above normal and has but risen since the shifts before.
SECOND, TOGETHER = 0.2, 1.0
#: Largest statistic, and exponent, of which an exponential is taken: beyond, it is certain all the same.
LARGEST, STEEPEST = 30.0, 700.0


def honest_probability(statistic: np.ndarray, threshold: np.ndarray, together: bool = False) -> np.ndarray:
    """Return :func:`axis_probability` (n,) of one window, with chance as a rival where another cause is at hand.

    Parameters
    ----------
    statistic, threshold : (n,), as there. together : all axes move together at that time, or what alarms may be none.

    Notes
    -----
    Chance has the evidence that an axis has at its threshold, over the odds there: what barely alarms beside a stronger
    axis is rather chance, what is far beyond its threshold is a second axis that wears.
    """
    z = np.nan_to_num(statistic)
    excess = np.where(z > threshold, z**2 - threshold**2, -np.inf)
    odds = np.full(len(z), TOGETHER if together else np.inf)
    odds[(excess > -np.inf) & (np.arange(len(z)) != excess.argmax())] = SECOND
    alone = axis_probability(statistic, threshold)
    with np.errstate(over="ignore"):
        chance = np.exp(np.minimum(threshold**2 - np.minimum(z, LARGEST) ** 2, STEEPEST) / 2) / odds
    # Both are odds against this axis.
    return np.where(alone > 0, 1.0 / (1.0 / np.where(alone > 0, alone, 1.0) + chance), 0.0)


def axis_probability(statistic: np.ndarray, threshold: np.ndarray) -> np.ndarray:
    """Return for every axis the probability that it changed, given that one of those not yet explained did, (..., n).

    Parameters
    ----------
    statistic : (..., n) largest standardised change of an axis over its averages, NaN where it is not judged.
    threshold : (..., n). Axes above their own are certain to be told apart: several may wear at once, so that they
        are no rivals of each other, only of the axes below.
    """
    z = np.nan_to_num(statistic)
    evidence = np.where(np.isfinite(statistic), np.exp(np.minimum(z, LARGEST) ** 2 / 2), 0.0)
    rivals = np.where(z > threshold, 0.0, evidence)
    others = rivals.sum(axis=-1, keepdims=True) - rivals
    total = evidence + others
    return np.divide(evidence, total, out=np.zeros_like(total), where=total > 0)
