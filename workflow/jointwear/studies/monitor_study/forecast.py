"""Hours until the friction of an axis reaches a limit, growth law unknown, from window to window.

The study of the monitor asks it of its estimates; what the monitor itself tells, from shift to shift, is
:mod:`jointwear.monitor.watching.shift_forecast`.

Bayesian average over growth laws f(t), each scaled to 1 at the time of issue so that its factor A is the growth of
now, with the same flat prior A > 0 for all:

    power laws ((t - t0) / (now - t0))^p with exponents p and onsets t0, and
    exponentials (exp((t - t0) / T) - 1) / (exp((now - t0) / T) - 1).

For each law, weighted least squares over all windows since the normal period gives a normal posterior of A (the error
of the normal mean is one more unknown), its marginal likelihood gives the weight of the law, and

    P(limit reached by t) = sum over laws of weight P(A f(t) >= limit)

is evaluated in closed form on a grid of times. Extrapolation by laws that all fit the past but differ later is where
the width of the interval comes from.
"""

from __future__ import annotations

import numpy as np
from scipy.special import log_ndtr, ndtr

from jointwear.monitor.watching.shift_forecast import Forecast

#: Exponents of the power laws: from straight to the steep growth before a failure.
EXPONENTS = tuple(np.geomspace(1.0, 6.0, 10))
#: Onsets between the end of the normal period and now, as shares of the time between.
ONSETS = tuple(np.linspace(0.0, 0.9, 10))
#: Time constants of the exponentials as shares of the same time.
CONSTANTS = (0.15, 0.25, 0.4, 0.7)
#: No law is exactly right: growth counts as known to this share at best, however many windows there are.
LAW_ERROR = 0.03
#: Times looked at: from now to this many times the history ahead.
FARTHEST, _TIMES = 20.0, 160


def forecast(
    time: np.ndarray,
    growth: np.ndarray,
    std: np.ndarray,
    limit: float,
    *,
    mean_std: float = 0.0,
    share: float = 0.8,
    start: float | None = None,
) -> Forecast:
    """Return when the growth reaches `limit`.

    Parameters
    ----------
    time, growth, std : (w,) windows since the normal period: time [h], growth of friction and its standard
        deviation, in the unit of `limit`. The forecast is issued at the last one.
    mean_std : standard deviation of the mean of the normal period, which all windows share.
    share : of the interval. start : end of the normal period [h], default the first window.
    """
    good = np.isfinite(growth) & (std > 0)
    t, y, s = time[good], growth[good], std[good]
    if len(t) < 3 or limit <= 0:
        return Forecast(np.nan, np.nan, np.nan)
    begin, now = (t[0] if start is None else start), t[-1]
    history = max(now - begin, 1e-6)
    weight = 1.0 / s**2
    past = _laws((t - begin) / history)
    ahead = np.concatenate([[0.0], np.geomspace(1e-3, FARTHEST, _TIMES - 1)])
    future = _laws(1.0 + ahead)
    ff, fy, f1 = (past**2) @ weight, past @ (weight * y), past @ weight
    total = weight.sum() + (1.0 / mean_std**2 if mean_std > 0 else np.inf)
    # The common error of the normal mean is integrated out.
    information = ff - (f1**2 / total if np.isfinite(total) else 0.0)
    score = fy - (f1 * (weight @ y) / total if np.isfinite(total) else 0.0)
    seen = information > 0
    information, score, future = information[seen], score[seen], future[seen]
    trust = min(1.0, 1.0 / (LAW_ERROR**2 * max(float(np.max(score**2 / information)), 1e-12)))
    information, score = trust * information, trust * score
    best, error = score / information, 1.0 / np.sqrt(information)
    tail = log_ndtr(best / error)
    evidence = score * best / 2 + np.log(error) + tail
    law = np.exp(evidence - evidence.max())
    law /= law.sum()
    with np.errstate(divide="ignore"):
        above = ndtr((best[:, None] - limit / future) / error[:, None]) / np.exp(tail)[:, None]
    # Friction that has reached the limit has reached it for good.
    reached = np.maximum.accumulate(law @ np.clip(above, 0.0, 1.0))
    edge = (1 - share) / 2
    return Forecast(*(time_reached(reached, history * ahead, q) for q in (0.5, edge, 1 - edge)))


def _laws(x: np.ndarray) -> np.ndarray:
    """Return all laws (g, m) at times x, 0 at the end of the normal period and 1 now."""
    exponents, onsets = np.array(EXPONENTS), np.array(ONSETS)
    since = np.maximum((x - onsets[:, None]) / (1 - onsets[:, None]), 0.0)
    with np.errstate(divide="ignore"):
        logarithm = np.log(since)
    power = np.exp(exponents[:, None, None] * logarithm).reshape(-1, len(x))
    constants = np.array(CONSTANTS)[:, None]
    # Far ahead an exponential is only very large.
    exponential = np.expm1(np.minimum(np.maximum(x, 0.0) / constants, 300.0)) / np.expm1(1.0 / constants)
    return np.concatenate([power, exponential])


def time_reached(reached: np.ndarray, time: np.ndarray, share: float) -> float:
    """Return when a share of all laws has reached the limit, inf where it does not within `time`.

    Parameters
    ----------
    reached : (t,) share that has reached it, never falling. time : (t,) from now, in any unit; 0 comes first.
    """
    if reached[0] >= share:
        return 0.0
    if reached[-1] < share:
        return float("inf")
    k = int(np.argmax(reached >= share))
    low, high = reached[k - 1], reached[k]
    return float(time[k - 1] + (time[k] - time[k - 1]) * (share - low) / max(high - low, 1e-300))
