"""Whether growth has stood still for some shifts, below its limit: play that has worn in, a load that was taken off.

The laws of growth (:mod:`.growth_laws`) as they are, against the same laws cut off between two of the shifts, whose
growth stays as it was from there on. Growth that goes on is not told from one that stands still by how far each lies
from a law: the unevenness that a forecast allows for is as large as what a week adds. Here shifts scatter about either
by their own error alone, times a factor that nobody knows, for what is stated of it is too much on one axis and too
little on another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from jointwear.monitor.watching.growth_laws import (
    BENDS,
    LENGTHS,
    TOLD,
    laws_at,
    prior_of_bends,
    prior_of_lengths,
    sizes,
    ways,
)

#: Probability a priori that growth has come to a standstill between two of the shifts (docs/decisions/forecasts.md).
STOPPED = 0.05
#: Fewest shifts since, and most numbers of them that are tried.
FEWEST_SHIFTS, MOST = 3, 20
#: Relative standard deviation of growth about its law, or about what it stood still at: laws of a grid lie no closer.
UNEVEN = 0.05
#: Growth since over the mean growth in the same time until then, that is none.
SLOW = 0.35
#: Every second bend and third length suffice, as sums over laws are all that is asked.
_BENDS, _LENGTHS = BENDS[::2], LENGTHS[::3]
#: Variance of the shifts over what is stated, each as likely a priori.
FACTORS = np.geomspace(1 / 8, 16.0, 4)


@dataclass(frozen=True)
class Standstill:
    """`probability` that growth stands still below its limit; `since` [h] it most likely does, NaN where that cannot be
    asked."""

    probability: float = 0.0
    since: float = np.nan


def standstill(
    time: np.ndarray, growth: np.ndarray, variance: np.ndarray, limit: float, *, shared: float, start: float, now: float
) -> Standstill:
    """Return whether growth stands still.

    Parameters
    ----------
    time : (s,) [h] middle of the shifts, ascending. growth, variance : (s,) relative growth and the variance of its own
    error, all known. limit : relative growth, as it is. shared : standard deviation of the error all shifts share.
    start : end of the normal period [h]. now : [h].
    """
    if len(time) < FEWEST_SHIFTS + 2:
        return Standstill()
    # Shifts before each standstill.
    after = np.unique(np.geomspace(FEWEST_SHIFTS, len(time) - 2, MOST).round().astype(int))
    before = len(time) - after[::-1]
    stop = 0.5 * (time[before] + time[before - 1])
    onset, length = ways(start, now, _LENGTHS)
    law, at_stop = (laws_at(t, onset, length, _BENDS) for t in (time, stop))  # (b, o, l, s) and (b, o, l, m)
    weight = 1.0 / (variance + (UNEVEN * growth) ** 2)

    def sums(values: np.ndarray, stopped: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weighted sums over the shifts (b, o, l, m + 1) of a law that stops, and last of one that does not."""
        until = np.cumsum(values * weights, axis=-1)
        tail = weights.sum() - np.cumsum(weights)[before - 1]
        return np.concatenate([until[..., before - 1] + stopped * tail, until[..., -1:]], axis=-1)

    match, of_one = (sums(law, at_stop, w) for w in (weight * growth, weight))
    norm = sums(law**2, at_stop**2, weight)
    prior = np.log(prior_of_bends(_BENDS))[:, None, None, None] + prior_of_lengths(_LENGTHS)[:, None]
    chance = np.append(np.full(len(before), np.log(STOPPED / len(before))), np.log(1 - STOPPED))
    chance[:-1][~_slow(time, growth, weight, before, stop - start)] = -np.inf
    begun = np.append(stop, np.inf) > onset[:, None, None]
    prior = np.where(begun, prior + chance, -np.inf)
    total = _evidence(match, of_one, norm, prior, growth, weight, TOLD * limit, shared)
    stands = total[..., :-1][..., at_stop < 1.0]
    each = [logsumexp(total[..., k][:, at_stop[..., k] < 1.0]) for k in range(len(before))]
    return Standstill(float(np.exp(logsumexp(stands) - logsumexp(total))), float(stop[int(np.argmax(each))]))


def _slow(
    time: np.ndarray, growth: np.ndarray, weight: np.ndarray, before: np.ndarray, grown_for: np.ndarray
) -> np.ndarray:
    """Return for each number of shifts `before` (m,) a standstill whether the shifts since grow by less than
    :data:`SLOW` of the mean rate until then, over `grown_for` (m,) [h]; laws of a grid do not fit many shifts well
    enough to be left to tell that."""
    slow = []
    for count, hours in zip(before, grown_for, strict=True):
        w, t, y = weight[count:], time[count:], growth[count:]
        t, level = t - np.average(t, weights=w), np.average(y, weights=w)
        slow.append(float(w @ (t * y)) * hours < SLOW * level * float(w @ t**2))
    return np.array(slow)


def _evidence(
    match: np.ndarray,
    of_one: np.ndarray,
    norm: np.ndarray,
    prior: np.ndarray,
    growth: np.ndarray,
    weight: np.ndarray,
    limit: float,
    shared: float,
) -> np.ndarray:
    """Return the log of prior times likelihood (f, b, o, l, m) for each factor of the variance and each size of the
    limit (f, together).

    Parameters
    ----------
    match, of_one, norm : (b, o, l, m) weighted sums of the law times growth, of the law and of its square.
    prior : (b, o, l, m) log. weight : (s,) of the shifts, one over their variance. limit : as it is told.
    """
    total, mean, square = weight.sum(), float(weight @ growth), float(weight @ growth**2)
    result = []
    for factor in FACTORS:
        # What all shifts share is known of one of them as of all: a covariance of rank one beside the diagonal.
        common = shared**2 / (factor**2 + shared**2 * factor * total)
        own = -0.5 * (square / factor - common * mean**2)
        own -= 0.5 * (len(weight) * np.log(factor) + np.log1p(shared**2 * total / factor))
        for size, share in sizes(limit):
            fit = size * (match / factor - common * of_one * mean)
            fit -= 0.5 * size**2 * (norm / factor - common * of_one**2)
            result.append(prior + fit + own + share)
    return np.array(result)
