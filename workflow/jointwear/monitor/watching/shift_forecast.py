"""Hours until the growth of an axis reaches a limit, from the means of its shifts.

A grid over the laws of growth (:mod:`.growth_laws`): bend B, onset t0, time T to the limit, and the size that the limit
has in what is told, or growth comes to rest below the limit. Each is as likely as a broad prior and the means of the
shifts make it, under their own error, one error that all share (the normal state), and growth that is uneven by
:data:`UNEVEN`. The times to the limit so weighted give the median and the interval; where the upper end stays open the
limit may never be reached. Growth that stands still (:mod:`.standstill`) has no time to the limit at all, with the
probability of that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.watching.growth_laws import TOLD, laws_at, prior_of_bends, prior_of_lengths, sizes, ways
from jointwear.monitor.watching.standstill import standstill

#: Probability a priori that growth comes to rest below the limit, at one of these shares of it.
REST, RESTS = 0.01, (0.1, 0.2, 0.35, 0.5, 0.7, 0.9)
#: Relative standard deviation of growth about its law. The level of a healthy axis has no wander beside it: what its
#: shifts leave does not grow with the days since the baseline.
UNEVEN = 0.25
#: A limit farther away than this many times the history may never be reached.
FARTHEST = 30.0
#: Probability of the interval, and that from which on growth is said to stand still.
INTERVAL, STANDS = 0.8, 0.5


@dataclass(frozen=True)
class Forecast:
    """Hours to the limit: median and 80 % interval; infinite where it may never be reached, 0 where it is.

    `still`: time [h] since which growth stands still, NaN where it hardly does.
    """

    hours: float
    low: float
    high: float
    still: float = np.nan


def forecast_shifts(
    time: np.ndarray,
    growth: np.ndarray,
    variance: np.ndarray,
    limit: float,
    *,
    shared: float,
    start: float,
    now: float,
) -> Forecast:
    """Return hours from `now` until the growth reaches `limit`: median and interval.

    Parameters
    ----------
    time : (s,) [h] middle of the shifts. growth, variance : (s,) relative growth and the variance of its own error.
    limit : relative growth, as it is, not as it is told. shared : standard deviation of the error all shifts share.
    start : end of the normal period [h], before which nothing had begun. now : [h].
    """
    good = np.isfinite(growth) & (variance > 0) & np.isfinite(variance)
    t, y, v = time[good], growth[good], variance[good]
    if len(t) < 2 or limit <= 0 or now <= start:
        return Forecast(np.nan, np.nan, np.nan)
    still = standstill(t, y, v, limit, shared=shared, start=start, now=now)
    limit = TOLD * limit
    size = np.maximum(np.minimum(y, 3 * limit), 0.0)
    covariance = np.diag(v + (UNEVEN * size) ** 2) + shared**2
    precision = np.linalg.inv(covariance)
    onset, length = ways(start, now)
    law = laws_at(t, onset, length)
    projected = law @ precision
    match, norm = projected @ y, np.einsum("bols,bols->bol", projected, law)
    prior = np.log((1 - REST) * prior_of_bends())[:, None, None] + prior_of_lengths()
    reaching = np.array([end * match - 0.5 * end**2 * norm + prior + weight for end, weight in sizes(limit)])
    # The law that bends most to rest, towards an end below the limit.
    resting = np.array([limit * q * match[0] - 0.5 * (limit * q) ** 2 * norm[0] for q in RESTS])
    resting += np.log(REST / len(RESTS)) + prior_of_lengths()
    largest = max(reaching.max(), resting.max())
    weight = np.exp(reaching - largest).sum(axis=(0, 1)).ravel()
    left = (onset[:, None] + length - now).ravel()
    order = np.argsort(left)
    total = np.cumsum(weight[order])
    never = float(np.exp(resting - largest).sum())
    edge = (1 - INTERVAL) / 2
    wanted = np.array([0.5, edge, 1 - edge]) * (total[-1] + never) / max(1.0 - still.probability, 1e-12)
    found = np.interp(wanted, total, left[order], right=np.inf)
    hours = np.where(found > FARTHEST * (now - start), np.inf, np.maximum(found, 0.0))
    return Forecast(*(float(h) for h in hours), still.since if still.probability > STANDS else np.nan)
