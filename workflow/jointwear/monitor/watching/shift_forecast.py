"""Hours until the growth of an axis reaches a limit, from the means of its shifts.

Growth limit (exp(B x) - 1) / (exp(B) - 1) with x = (t - t0) / T: it begins at t0 and is at the limit T later, bent on
all the way: saturating for negative B, straight for 0, accelerating for positive; or it comes to rest below the limit.
A grid over B, t0, T and the size that the limit has in what is told, with a broad prior; each is as likely as the
means of the shifts make it, under their own error, one error that all share (the normal state), and growth that is
uneven by :data:`UNEVEN`. The times to the limit so weighted give the median and the interval; where the upper end stays
open the limit may never be reached.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Bend of growth over the whole way to the limit; mean and standard deviation of its prior. Of the way and not of what
#: is past: at an alarm a small part of the way is gone, on which any law is nearly straight, and a prior of the bend
#: so far would let a good part of the laws come to rest below the limit.
BENDS = np.linspace(-4.0, 5.0, 15)
BEND, BEND_SPREAD = 0.4, 1.5
#: Probability a priori that growth comes to rest below the limit, at one of these shares of it.
REST, RESTS = 0.01, (0.1, 0.2, 0.35, 0.5, 0.7, 0.9)
#: Onsets between the normal period and now, as shares of the time between.
ONSETS = np.concatenate([np.linspace(0.0, 0.9, 13), [0.94, 0.97]])
#: Times from onset to limit over that from onset to now, as likely a priori per log of them as this power of their rate
#: says: 0 would be flat in the log of the time, which leaves a quarter of the ends open, 1 in the rate. This, the bend,
#: :data:`SCALE` and :data:`UNEVEN` together have the best interval score (docs/decisions/forecasts.md).
LENGTHS, HASTE = np.geomspace(0.25, 100.0, 45), 0.3
#: What growth is told as over what it is, and the standard deviation of its log: its share in the friction that is
#: judged and its size under the conditions of the day are known no better, and a part of it is taken for the normal
#: state (docs/decisions/forecasts.md). Points and weights of the normal law for it.
TOLD, SCALE = 0.9, 0.15
_POINTS = ((-1.35, 0.25), (0.0, 0.5), (1.35, 0.25))
#: Relative standard deviation of growth about its law. The level of a healthy axis has no wander beside it: what its
#: shifts leave does not grow with the days since the baseline.
UNEVEN = 0.25
#: A limit farther away than this many times the history may never be reached.
FARTHEST = 30.0
#: Probability of the interval.
INTERVAL = 0.8


@dataclass(frozen=True)
class Forecast:
    """Hours to the limit: median and 80 % interval; infinite where it may never be reached, 0 where it is."""

    hours: float
    low: float
    high: float


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
    limit = TOLD * limit
    size = np.maximum(np.minimum(y, 3 * limit), 0.0)
    covariance = np.diag(v + (UNEVEN * size) ** 2) + shared**2
    precision = np.linalg.inv(covariance)
    onset = start + ONSETS * (now - start)
    length = (now - onset)[:, None] * LENGTHS
    law = _laws(np.maximum(t - onset[:, None], 0.0)[:, None, :] / length[..., None])  # (b, o, l, s), 1 at the limit
    projected = law @ precision
    match, norm = projected @ y, np.einsum("bols,bols->bol", projected, law)
    prior = np.exp(-0.5 * ((BENDS - BEND) / BEND_SPREAD) ** 2)
    prior = np.log((1 - REST) * prior / prior.sum())[:, None, None] - HASTE * np.log(LENGTHS)
    ends = [(limit * np.exp(SCALE * point), np.log(weight)) for point, weight in _POINTS]
    reaching = np.array([end * match - 0.5 * end**2 * norm + prior + weight for end, weight in ends])
    # The law that bends most to rest, towards an end below the limit.
    resting = np.array([limit * q * match[0] - 0.5 * (limit * q) ** 2 * norm[0] for q in RESTS])
    resting += np.log(REST / len(RESTS)) - HASTE * np.log(LENGTHS)
    largest = max(reaching.max(), resting.max())
    weight = np.exp(reaching - largest).sum(axis=(0, 1)).ravel()
    left = (onset[:, None] + length - now).ravel()
    order = np.argsort(left)
    total = np.cumsum(weight[order])
    never = float(np.exp(resting - largest).sum())
    edge = (1 - INTERVAL) / 2
    wanted = np.array([0.5, edge, 1 - edge]) * (total[-1] + never)
    found = np.interp(wanted, total, left[order], right=np.inf)
    hours = np.where(found > FARTHEST * (now - start), np.inf, np.maximum(found, 0.0))
    return Forecast(*(float(h) for h in hours))


def _laws(x: np.ndarray) -> np.ndarray:
    """Return growth over that at the limit (b, ...) at times x (...) since the onset over those of the limit."""
    bend = BENDS.reshape(-1, *[1] * x.ndim)
    straight = np.abs(bend) < 1e-9
    safe = np.where(straight, 1.0, bend)
    return np.where(straight, x, np.expm1(np.minimum(safe * x, 300.0)) / np.expm1(safe))
