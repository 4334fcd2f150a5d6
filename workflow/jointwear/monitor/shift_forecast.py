"""Hours until the growth of an axis reaches a limit, from the means of its shifts.

Growth A (exp(lambda (t - t0)) - 1) / lambda since its onset t0: saturating for negative lambda, straight for 0,
accelerating for positive. A grid over lambda and t0 with a broad prior; for each pair the growth of now has a normal
posterior under the covariance of the shifts: their own error, one error that all share (the normal state), growth that
is uneven by :data:`UNEVEN`, and a slow wander. The share of all laws and sizes that reach the limit by a time gives
the interval; where the upper end stays open the limit may never be reached.
"""

from __future__ import annotations

import numpy as np
from scipy.special import log_ndtr, ndtr

from jointwear.monitor.forecast import Forecast, time_reached

#: lambda times the time since the onset, and mean and standard deviation of its prior: at an alarm a small part of the
#: way to the limit is gone, over which laws bend little, and wear rather hastens than comes to rest.
BENDS = np.linspace(-3.0, 5.0, 33)
BEND, BEND_SPREAD = 0.45, 0.85
#: Onsets between the normal period and now, as shares of the time between.
ONSETS = np.concatenate([np.linspace(0.0, 0.9, 13), [0.94, 0.97]])
#: Relative standard deviation of growth about its law; wander of the level, per root of a day; what no law knows of
#: the way ahead, relative.
UNEVEN, WANDER, AHEAD = 0.06, 0.003, 0.06
#: Times looked at: from now to this many times the history ahead.
FARTHEST, _TIMES = 30.0, 240


def forecast_shifts(
    time: np.ndarray,
    growth: np.ndarray,
    variance: np.ndarray,
    limit: float,
    *,
    shared: float,
    start: float,
    now: float,
    share: float = 0.8,
) -> Forecast:
    """Return hours from `now` until the growth reaches `limit`: median and interval.

    Parameters
    ----------
    time : (s,) [h] middle of the shifts. growth, variance : (s,) relative growth and the variance of its own error.
    limit : relative growth. shared : standard deviation of the error that all shifts share.
    start : end of the normal period [h], before which nothing had begun. now : [h]. share : of the interval.
    """
    good = np.isfinite(growth) & (variance > 0) & np.isfinite(variance)
    t, y, v = time[good], growth[good], variance[good]
    if len(t) < 2 or limit <= 0 or now <= start:
        return Forecast(np.nan, np.nan, np.nan)
    size = np.maximum(np.minimum(y, 3 * limit), 0.0)
    days = np.maximum(t - start, 0.0) / 24
    covariance = np.diag(v + (UNEVEN * size) ** 2) + shared**2
    covariance += WANDER**2 * np.minimum(days[:, None], days)
    precision = np.linalg.inv(covariance)
    onset = start + ONSETS * (now - start)
    since = now - onset
    law = np.stack([_laws(t[:, None] - onset, since, bend) for bend in BENDS])  # (b, s, o), 1 now
    prior = -0.5 * ((BENDS - BEND) / BEND_SPREAD) ** 2
    information = np.einsum("bso,st,bto->bo", law, precision, law)
    seen = information > 0
    safe = np.where(seen, information, 1.0)
    best = np.einsum("bso,s->bo", law, precision @ y) / safe
    error = 1.0 / np.sqrt(safe)
    tail = log_ndtr(best / error)
    evidence = np.where(seen, best**2 * safe / 2 + np.log(error) + tail + prior[:, None], -np.inf)
    weight = np.exp(evidence - evidence.max())
    weight /= weight.sum()
    spread = np.hypot(error, AHEAD * np.maximum(best, 0.0))
    history = now - start
    ahead = np.concatenate([[0.0], history * np.geomspace(1e-3, FARTHEST, _TIMES - 1)])
    reached = np.zeros(_TIMES)
    for b, bend in enumerate(BENDS):
        future = _laws(now + ahead[:, None] - onset, since, bend)
        with np.errstate(divide="ignore"):
            above = ndtr((best[b] - limit / np.maximum(future, 1e-300)) / spread[b])
        scaled = above / np.maximum(ndtr(best[b] / spread[b]), 1e-300)
        reached += np.clip(scaled, 0.0, 1.0) @ weight[b]
    reached = np.maximum.accumulate(reached)
    edge = (1 - share) / 2
    return Forecast(*(time_reached(reached, ahead, q) for q in (0.5, edge, 1 - edge)))


def _laws(since_onset: np.ndarray, reference: np.ndarray, bend: float) -> np.ndarray:
    """Return growth at times since the onset (..., o) over that at `reference` (o,); 0 before the onset."""
    x = np.maximum(since_onset, 0.0) / reference
    if abs(bend) < 1e-9:
        return x
    return np.expm1(np.minimum(bend * x, 300.0)) / np.expm1(bend)
