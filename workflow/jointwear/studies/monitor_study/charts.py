"""Control chart of the study of the monitor: averages over the last 2 to 96 windows against the normal period.

It judges the estimates of the monitor at one rate of false alarms with the other detectors, window by window. What the
monitor itself decides by, shift by shift, is :mod:`jointwear.monitor.watching.decision`.

For every length m of a grid the statistic is the mean change of the last m windows over its standard deviation, in
which the error of the normal mean counts too,

    Z(m) = (sum w x / sum w) / sqrt(f(m) / sum w + f(w0) / W0),

w inverse variances, W0 their sum over the normal period, f the inflation by slow variation from window to window. The
largest over m is the window-limited generalised likelihood ratio for a shift (Lai, 1995); short averages see a step,
long ones a slow drift, and no size of the change has to be named. A window counts for at most
:data:`CLIP` standard deviations, so that one absurd window alone does not alarm.

The normal period stays the reference for ever: a running mean would follow the wear. The threshold comes from
simulating exactly this chart, normal period of the same length included, so that the stated false-alarm rate holds
over the luck of that period too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from jointwear.studies.monitor_study.normal_period import Normal

LENGTHS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96)
CLIP = 4.0
#: Horizon [windows] of a simulated run, and number of runs.
_HORIZON, _RUNS, _BLOCK = 240, 40000, 2000
#: Share of the allowed false alarms that the threshold uses up; the rest is for tails heavier than the normal law's.
BUDGET = 0.5
#: Share of it for falls of friction: they are told (running-in, new grease), but growth is what is looked for.
FALL_SHARE = 0.1
#: Fewest windows of the normal period of an axis.
FEWEST_NORMAL = 8


@dataclass(frozen=True)
class Trace:
    """What a chart says in every window, arrays (..., w, n).

    `statistic`: largest Z since the last reset, NaN where the axis could not be judged; that of a fall is scaled by
    the ratio of the two thresholds. `length`: windows of that average. `alarm`: bool.
    """

    statistic: np.ndarray
    length: np.ndarray
    alarm: np.ndarray


def inflation(length: np.ndarray | float, memory: np.ndarray, slow: np.ndarray) -> np.ndarray:
    """Return by how much correlation slow memory^k of windows k apart raises the variance of a mean of `length`."""
    m = np.maximum(length, 1.0)
    rest = (1 - memory**m) / (m * (1 - memory))
    return 1 + 2 * slow * memory / (1 - memory) * (1 - rest)


def mean_variance(normal: Normal) -> np.ndarray:
    """Return the variance (..., n) of the mean of the normal period, infinite where there is none."""
    known = normal.weight > 0
    raised = inflation(normal.windows, normal.memory, normal.slow)
    return np.where(known, raised / np.where(known, normal.weight, 1.0), np.inf)


def run_chart(
    change: np.ndarray,
    std: np.ndarray,
    threshold: np.ndarray,
    fall: np.ndarray,
    normal: Normal,
    lengths: tuple[int, ...] = LENGTHS,
) -> Trace:
    """Run one chart an axis, reset after each alarm.

    Parameters
    ----------
    change, std : (..., w, n), NaN where not judged; such windows are passed over.
    threshold, fall : (..., n) for growth and for a fall, :func:`thresholds_for`.
    normal : what the normal period taught.
    lengths : of the averages.
    """
    good = np.isfinite(change) & (std > 0)
    safe = np.where(good, std, 1.0)
    w = np.where(good, 1.0 / safe**2, 0.0)
    x = np.where(good, np.clip(np.where(good, change, 0.0), -CLIP * safe, CLIP * safe), 0.0)
    lead, (count, n) = change.shape[:-2], change.shape[-2:]
    order = np.cumsum(good, axis=-2)
    summed, weights = (np.zeros((*lead, count + 1, n)) for _ in range(2))
    np.cumsum(w * x, axis=-2, out=summed[..., 1:, :])
    np.cumsum(w, axis=-2, out=weights[..., 1:, :])
    dense = bool(good.all())
    if not dense:
        # Windows that are passed over leave no gap: sums are kept by count of judged windows.
        summed, weights = _by_judged(summed, good), _by_judged(weights, good)
    reset = np.zeros((*lead, n), dtype=np.int64)
    base = mean_variance(normal)
    with np.errstate(invalid="ignore"):
        falling = np.where(np.isfinite(fall) & (fall > 0), threshold / fall, 0.0)
    shape = change.shape
    trace = Trace(np.full(shape, np.nan), np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=bool))
    factors = [inflation(m, normal.memory, normal.slow) for m in lengths]
    for t in range(count):
        judged = order[..., t, :]
        best, which = np.zeros((*lead, n)), np.zeros((*lead, n), dtype=np.int64)
        for m, factor in zip(lengths, factors, strict=True):
            if m > t + 1:
                break
            if dense:
                s, v = (a[..., t + 1, :] - a[..., t + 1 - m, :] for a in (summed, weights))
            else:
                rows = np.stack([judged, np.maximum(judged - m, 0)], axis=-2)
                s, v = (-np.diff(np.take_along_axis(a, rows, -2), axis=-2)[..., 0, :] for a in (summed, weights))
            known = (v > 0) & (judged - reset >= m)
            v = np.where(known, v, 1.0)
            z = np.where(known, s / v / np.sqrt(factor / v + base), 0.0)
            z = np.maximum(z, -falling * z)
            better = z > best
            best, which = np.where(better, z, best), np.where(better, m, which)
        here = good[..., t, :]
        alarm = here & (best > threshold)
        trace.statistic[..., t, :] = np.where(here, best, np.nan)
        trace.length[..., t, :] = which
        trace.alarm[..., t, :] = alarm
        reset = np.where(alarm, judged, reset)
    return trace


def _by_judged(total: np.ndarray, good: np.ndarray) -> np.ndarray:
    """Return running sums (..., w + 1, n) in order of judged windows instead of all windows."""
    result = np.repeat(total[..., -1:, :], total.shape[-2], axis=-2)
    result[..., 0, :] = 0.0
    judged = np.cumsum(good, axis=-2)
    flat_t, flat_r = np.moveaxis(total, -2, 0), np.moveaxis(result, -2, 0)
    flat_j, flat_g = np.moveaxis(judged, -2, 0), np.moveaxis(good, -2, 0)
    index = np.nonzero(flat_g)
    flat_r[(flat_j[index], *index[1:])] = flat_t[(index[0] + 1, *index[1:])]
    return result


@lru_cache(maxsize=64)
def _run_maxima(windows: int) -> np.ndarray:
    """Return the sorted largest statistic for growth of normal runs after a normal period of `windows` windows."""
    random = np.random.default_rng([20150824, windows])
    maxima = np.empty(_RUNS)
    for start in range(0, _RUNS, _BLOCK):
        # Only mean and scatter of the normal period matter: both have known laws.
        scatter = np.sqrt(random.chisquare(windows - 1, (_BLOCK, 1)) / (windows - 1))
        mean = random.standard_normal((_BLOCK, 1)) / np.sqrt(windows)
        x = np.clip((random.standard_normal((_BLOCK, _HORIZON)) - mean) / scatter, -CLIP, CLIP)
        total = np.concatenate([np.zeros((_BLOCK, 1)), np.cumsum(x, axis=1)], axis=1)
        best = np.zeros(_BLOCK)
        for m in LENGTHS:
            spread = m * np.sqrt(1 / m + 1 / windows)
            best = np.maximum(best, (total[:, m:] - total[:, :-m]).max(axis=1) / spread)
        maxima[start : start + _BLOCK] = best
    return np.sort(maxima)


def threshold_for(rate: float, axes: int, windows: int) -> float:
    """Return the one-sided threshold of one axis at which `axes` of them have `rate` false alarms a window.

    Parameters
    ----------
    rate : false alarms a window, all axes together. axes : number of axes that are charted.
    windows : length of the normal period.

    Notes
    -----
    The chance that a run of :data:`_HORIZON` windows alarms is 1 - exp(-rate horizon). Below what the simulated runs
    resolve, the tail is continued as one that falls like exp(-c z^2) with the c of its last decade. Correlated
    windows give fewer independent looks at a statistic of the same law: the threshold errs on the safe side.
    """
    if windows < 3:
        return float("inf")
    maxima = _run_maxima(int(windows))
    wanted = -np.expm1(-rate / max(axes, 1) * _HORIZON)
    smallest = 100 / len(maxima)
    if wanted >= smallest:
        return float(np.quantile(maxima, 1 - wanted))
    anchor, low = np.quantile(maxima, 1 - smallest), np.quantile(maxima, 1 - 10 * smallest)
    slope = np.log(10.0) / (anchor**2 - low**2)
    return float(np.sqrt(anchor**2 + np.log(smallest / wanted) / slope))


def thresholds_for(rate: float, windows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return thresholds (n,) for growth and for a fall of friction; infinite where an axis cannot be charted.

    Parameters
    ----------
    rate : false alarms a window that are allowed for the whole robot.
    windows : (n,) length of the normal period of every axis.
    """
    charted = windows >= FEWEST_NORMAL
    result = np.full((2, len(windows)), np.inf)
    for side, share in enumerate((1 - FALL_SHARE, FALL_SHARE)):
        for j in np.flatnonzero(charted):
            result[side, j] = threshold_for(BUDGET * share * rate, int(charted.sum()), int(windows[j]))
    return result[0], result[1]
