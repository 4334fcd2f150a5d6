"""The paper's detector on window statistics: histograms of |torque|, KL divergence, PCA, Q-statistic.

As in the reproduction with its default reading: |torque| over the largest of the normal period in equal bins, KL
divergence of every window against the first, principal components of the standardised series of the normal period,
onset where Q stays above its limit for some windows in a row. Its limit is raised by a factor for which the normal
period, scored in halves by models of the other half, promises the stated rate of false alarms. The paper's task repeats
itself; where a robot runs several programs, with loads and speeds of their own, what one window of the normal period
shows a later shift can show all day.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.reading.windows import HISTOGRAM_BINS, HISTOGRAM_SPAN, WindowStatistics

#: Reading of the paper's text that concerns windows; that of the reproduction.
READING = {
    "empty_bin_floor": "machine_epsilon",
    "kl_direction": "reference_from_hour",
    "scaling": "standardised",
    "components": "variance_share",
    "q_limit": "jackson_mudholkar",
}
CONFIDENCE, VARIANCE_SHARE, CONSECUTIVE, BINS = 0.95, 0.75, 5, 12
#: Share of the normal windows whose excess over their quantile gives the tail.
_TAIL = 0.2


@dataclass(frozen=True)
class PaperVerdict:
    """`q` (w,) over its limit, NaN where a window has no histogram; `alarm` (w,) bool; `axis` (w,) 1-based, 0: none."""

    q: np.ndarray
    alarm: np.ndarray
    axis: np.ndarray


def folded_histograms(statistics: WindowStatistics, baseline: int) -> np.ndarray:
    """Return histograms (w, n, BINS) of |torque| over the largest of the normal period, NaN where there is nothing."""
    half = HISTOGRAM_BINS // 2
    counts = statistics.torque_histogram
    size = counts[..., half:] + counts[..., :half][..., ::-1]
    peak = statistics.torque_peak[:baseline].max(axis=0) / statistics.torque_reference
    middle = (np.arange(half) + 0.5) * HISTOGRAM_SPAN / half
    result = np.zeros((*counts.shape[:2], BINS))
    for j in range(counts.shape[1]):
        place = np.floor(middle / max(peak[j], 1e-12) * BINS).astype(int)
        # What lies beyond the largest torque of the normal period is left out, as in the reproduction.
        for b in range(BINS):
            result[:, j, b] = size[:, j, place == b].sum(axis=1)
    total = result.sum(axis=2, keepdims=True)
    return np.where(total > 0, result / np.where(total > 0, total, 1.0), np.nan)


def raised_limit(ratio: np.ndarray, rate: float, mixed: bool = False) -> float:
    """Return the factor >= 1 on the limit at which runs of windows above it have at most `rate` alarms a window.

    Parameters
    ----------
    ratio : (w,) Q over its limit in normal windows that the model was not fitted to.
    mixed : whether the windows are of several programs.

    Notes
    -----
    The smallest ratio of :data:`CONSECUTIVE` windows in a row must exceed the factor. Its tail beyond what the normal
    period shows is continued as an exponential. Of several programs that change from window to window, such a run
    forgives what a later shift of one of them does not: there a window's own ratio must stay below the factor, one
    chance for every :data:`CONSECUTIVE` windows.
    """
    if len(ratio) < 2 * CONSECUTIVE:
        return 1.0
    if mixed:
        tried, chances = ratio, CONSECUTIVE
    else:
        tried, chances = np.lib.stride_tricks.sliding_window_view(ratio, CONSECUTIVE).min(axis=-1), 1
    edge = np.quantile(tried, 1 - _TAIL)
    excess = float(np.mean(tried[tried >= edge] - edge))
    return float(max(1.0, edge + excess * np.log(max(_TAIL / (chances * rate), 1.0))))


def paper_alarms(
    statistics: WindowStatistics, baseline: int, rate: float, programs: np.ndarray | None = None
) -> PaperVerdict:
    """Run the detector; reset after each alarm.

    Parameters
    ----------
    baseline : windows of the normal period, the first ones. rate : false alarms a window that are allowed.
    programs : (w,) program of each window (:mod:`.regimes`), or None where none are told apart.

    Notes
    -----
    The paper's task repeats itself. The torques of a program that the normal period never ran differ by their motion
    alone, so its windows have no Q.
    """
    from jointwear.reproduction.detection import score
    from jointwear.reproduction.features import kl_divergence
    from jointwear.reproduction.normal_model import by_numpy, fit_normal_model

    count = statistics.windows
    nothing = PaperVerdict(np.full(count, np.nan), np.zeros(count, dtype=bool), np.zeros(count, dtype=int))
    histograms = folded_histograms(statistics, baseline)
    # A robot that stands still all window has no torque pattern of its task.
    known = np.isfinite(histograms).all(axis=(1, 2)) & (statistics.count > 0).any(axis=1)
    if programs is not None:
        known &= np.isin(programs, programs[:baseline])
    normal = np.flatnonzero(known[:baseline])
    if len(normal) < 8:
        return nothing
    kl = np.full((count, statistics.axes), np.nan)
    kl[known] = kl_divergence(histograms[known], histograms[normal[0]], READING)
    varying = np.flatnonzero(kl[normal].std(axis=0) > 1e-12)
    if len(varying) < 2:
        return nothing
    series = kl[:, varying]

    def ratios(fitted: np.ndarray, scored: np.ndarray) -> np.ndarray:
        model = fit_normal_model(series[fitted][None], CONFIDENCE, VARIANCE_SHARE, READING, by_numpy)
        return score(series[scored][None], model)[0][0] / max(float(model.q_limit[0]), 1e-300)

    halves = np.array_split(normal, 2)
    spreads = [series[h].std(axis=0).min() for h in halves]
    crossed = (
        np.concatenate([ratios(halves[1], halves[0]), ratios(halves[0], halves[1])])
        if min(spreads) > 1e-12
        else np.zeros(0)
    )
    mixed = programs is not None and len(np.unique(programs[normal])) > 1
    factor = raised_limit(crossed, rate, mixed=mixed)
    used = np.flatnonzero(known)
    q = np.full(count, np.nan)
    q[used] = ratios(normal, used)
    z = (kl - kl[normal].mean(axis=0)) / np.where(kl[normal].std(axis=0) > 1e-12, kl[normal].std(axis=0), np.inf)
    alarm, axis = nothing.alarm.copy(), nothing.axis.copy()
    row = 0
    for place, k in enumerate(used):
        row = row + 1 if q[k] > factor else 0
        if row == CONSECUTIVE:
            alarm[k], row = k >= baseline, 0
            recent = used[place - CONSECUTIVE + 1 : place + 1]
            axis[k] = int(np.nan_to_num(z[recent]).mean(axis=0).argmax()) + 1
    return PaperVerdict(q / factor, alarm, np.where(alarm, axis, 0))
