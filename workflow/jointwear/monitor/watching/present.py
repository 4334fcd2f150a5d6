"""What counts as now, and how well the mean over it is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jointwear.monitor.normal.dispersion import Q80, inflated
from jointwear.monitor.watching.decision import NORMAL
from jointwear.monitor.watching.parts import ViscousGrowth, viscous_part
from jointwear.monitor.watching.watching import Watch

#: Length of time at the end [s] that counts as now: a day, so that the shifts of a day weigh alike.
NOW = 86400.0
#: Fewest windows of now, where the windows are longer than that.
FEWEST_NOW = 3
#: Share of the growth that alarmed below which growth of now is nearer to none.
NEARER = 0.5


def now_windows(end: np.ndarray) -> np.ndarray:
    """Return the indices of the windows that count as now; `end` (w,) [s] of all."""
    recent = np.flatnonzero(end > end[-1] - NOW)
    return recent if len(recent) >= FEWEST_NOW else np.arange(max(0, len(end) - FEWEST_NOW), len(end))


def mean_now(values: np.ndarray, std: np.ndarray, end: np.ndarray) -> float:
    """Return the weighted mean over the windows of now of an estimate (w,) with standard deviations (w,), NaN where
    none of them has one; `end` (w,) [s]."""
    rows = now_windows(end)
    rows = rows[np.isfinite(values[rows]) & (std[rows] > 0)]
    return float(np.average(values[rows], weights=1 / std[rows] ** 2)) if len(rows) else np.nan


def coulomb_growth(
    level: Watch, viscous: Watch, j: int, shift: np.ndarray, end: np.ndarray, grown: ViscousGrowth
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the growth (w,) of the level of axis `j` over its normal value, without what of it is viscous, its
    standard deviation (w,), and that of its mean now.

    Errors of a logarithm are shares of what has grown: a level that is three times its normal value has three times
    the error of one that is as it was.

    Parameters
    ----------
    shift : (w,) labels. end : (w,) [s]. grown : what of the growth is viscous.
    """
    part, spread = viscous_part(level, viscous, j, shift, grown)
    of_part = error_now(viscous, j, shift, end) if viscous.axes[j] is not None and spread[-1] > 0 else 0.0
    residual, std = level.residual[:, j], level.std[:, j]
    error = float(np.hypot(np.exp(mean_now(residual, std, end)) * error_now(level, j, shift, end), of_part))
    return np.expm1(residual) - part, np.hypot(np.exp(residual) * std, spread), error


def error_now(watched: Watch, j: int, shift: np.ndarray, end: np.ndarray) -> float:
    """Return the standard deviation of the mean residual of the 0-based axis `j` now, NaN where it is not known.

    Windows of a shift share what shifts differ by, and all of them what is not known of the normal state. `shift` (w,)
    labels, `end` (w,) [s] of the windows.
    """
    axis, rows = watched.axes[j], now_windows(end)
    rows = rows[np.isfinite(watched.residual[rows, j])]
    if axis is None or not len(rows):
        return np.nan
    between, noise = axis.dispersion.between**2, watched.noise[rows, j]
    own = float(inflated(len(rows), axis.dispersion.memory)) / np.sum(1.0 / noise)
    normal = max(float(np.median(watched.std[rows, j] ** 2 - noise - between)), 0.0)
    return float(np.sqrt(own + between / len(np.unique(shift[rows])) + normal))


def back_to_normal(watches: Sequence[tuple[Watch, np.ndarray]], shift: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return on which axes (n,) what has alarmed since the last event of the config is by now as it was before.

    Parameters
    ----------
    watches : what was watched, each with its alarms (w, n) bool. shift : (w,) labels. end : (w,) [s] of the windows.

    Notes
    -----
    That is where the 80 % interval of the growth of now reaches down to what the decision tolerates, and the growth is
    nearer to zero than to what alarmed: an axis that shows little by now is none that is back.
    """
    n = watches[0][1].shape[1]
    result = np.zeros(n, dtype=bool)
    for j in range(n):
        found = []
        for watched, alarm in watches:
            begin = max([s.window for s in watched.starts[j] if s.closes], default=0)
            hits = begin + np.flatnonzero(alarm[begin:, j])
            if len(hits):
                found.append(_is_back(watched, j, hits, shift, end))
        result[j] = bool(found) and all(found)
    return result


def _is_back(watched: Watch, j: int, hits: np.ndarray, shift: np.ndarray, end: np.ndarray) -> bool:
    now, error = mean_now(watched.residual[:, j], watched.std[:, j], end), error_now(watched, j, shift, end)
    if not np.isfinite(now + error):
        return False
    told = watched.mean[hits, j]
    told = told[np.isfinite(told)]
    return now - NORMAL <= Q80 * error and (not len(told) or now < NEARER * float(told.max()))
