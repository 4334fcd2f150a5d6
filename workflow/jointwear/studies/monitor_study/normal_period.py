"""What the normal period teaches the charts of the study: mean and scatter of its windows, and how long they remember.

The monitor itself learns a normal state under temperature, load and speed instead: :mod:`.learning`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.estimate import Pooled, Sums, column_estimate, pool_windows

#: Lags [windows] over which the correlation of normal windows is looked at, and laws that are tried for its decay.
LAGS, MEMORIES = 24, np.array([0.3, 0.6, 0.8, 0.9, 0.95, 0.98])
#: Standard deviations from which a correlation is there: one in a hundred of independent windows by chance.
CORRELATED = 2.6
_TINY = 1e-9


@dataclass(frozen=True)
class Normal:
    """What the normal period taught.

    `pooled`: its regression; `mean` (..., n): mean of the Coulomb estimate; `spread` (..., n): variance of the windows
    about it over what the noise explains; `slow`, `memory` (..., n): the correlation of windows k apart is
    slow memory^k, both 0 unless it is clearly there; `weight` (..., n): sum of inverse variances; `windows` (n,):
    number of windows that count.
    """

    pooled: Pooled
    mean: np.ndarray
    spread: np.ndarray
    memory: np.ndarray
    slow: np.ndarray
    weight: np.ndarray
    windows: np.ndarray


def learn_normal(sums: Sums, scale: np.ndarray) -> Normal:
    """Learn from the windows of the normal period.

    Parameters
    ----------
    sums : of the normal period alone. scale : (n, 5), :func:`jointwear.monitor.normal.estimate.prior_scale`.
    """
    pooled = pool_windows(sums, scale)
    raw, white = column_estimate(sums, pooled.held, pooled.free, pooled.variance)
    good = np.isfinite(raw) & (white > 0)
    weight = np.where(good, 1.0 / np.where(good, white, 1.0), 0.0)
    total = weight.sum(axis=-2)
    windows = good.sum(axis=-2)
    safe = np.where(total > 0, total, 1.0)
    mean = (weight * np.where(good, raw, 0.0)).sum(axis=-2) / safe
    z = np.where(good, raw - mean[..., None, :], 0.0) * np.sqrt(weight)
    degrees = np.maximum(windows - 1, 1)
    spread = np.where(windows > 1, np.maximum((z**2).sum(axis=-2) / degrees, _TINY), 1.0)
    memory, slow = _memory(z / np.sqrt(spread)[..., None, :], good)
    least = windows.reshape(-1, windows.shape[-1]).min(axis=0)
    return Normal(pooled, mean, spread, memory, slow, total / spread, least)


def coulomb_estimates(sums: Sums, normal: Normal) -> tuple[np.ndarray, np.ndarray]:
    """Return the growth (..., w, n) over the nominal Coulomb level, less its normal mean, and its standard deviation.

    NaN where a window shows nothing. The standard deviation holds what the noise and the scatter of the normal
    windows tell; the error of the normal mean, common to all windows, is not in it (:attr:`Normal.weight`).
    """
    pooled = normal.pooled
    raw, variance = column_estimate(sums, pooled.held, pooled.free, pooled.variance)
    return raw - normal.mean[..., None, :], np.sqrt(variance * normal.spread[..., None, :])


def _memory(z: np.ndarray, good: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return memory and slow share (..., n) of standardised windows z (..., w, n), 0 where not `good`.

    The law slow memory^k is fitted to the autocorrelations of the first :data:`LAGS` lags, if lag 1 or the mean over
    half of the lags lies :data:`CORRELATED` standard deviations above that of independent windows.
    """
    count = z.shape[-2]
    lags = min(LAGS, count // 4)
    if lags < 2:
        none = np.zeros((*z.shape[:-2], z.shape[-1]))
        return none, none
    found = []
    for k in range(1, lags + 1):
        pairs = np.maximum((good[..., k:, :] & good[..., :-k, :]).sum(axis=-2), 1)
        found.append((z[..., k:, :] * z[..., :-k, :]).sum(axis=-2) / pairs)
    rho = np.stack(found)
    half = max(lags // 2, 1)
    root_count = np.sqrt(good.sum(axis=-2))
    clear = (rho[0] * root_count > CORRELATED) | (rho[:half].mean(axis=0) * np.sqrt(half) * root_count > CORRELATED)
    laws = MEMORIES[:, None] ** np.arange(1, lags + 1)
    shares = np.clip(np.tensordot(laws, rho, 1) / (laws**2).sum(axis=1).reshape(-1, *[1] * (rho.ndim - 1)), 0.0, 1.0)
    error = ((rho[None] - shares[:, None] * laws.reshape(*laws.shape, *[1] * (rho.ndim - 1))) ** 2).sum(axis=1)
    best = error.argmin(axis=0)
    share = np.take_along_axis(shares, best[None], 0)[0]
    return np.where(clear, MEMORIES[best], 0.0), np.where(clear, share, 0.0)
