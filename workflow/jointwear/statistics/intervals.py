"""Intervals for what was counted and measured over replicates."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any

import numpy as np

#: Confidence of the intervals.
CONFIDENCE = 0.95


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval for a probability of which `successes` of `trials` came true.

    References
    ----------
    E. B. Wilson, Probable inference, the law of succession, and statistical inference, JASA 22 (1927) 209-212.
    """
    if trials == 0:
        return 0.0, 1.0
    z = NormalDist().inv_cdf((1 + CONFIDENCE) / 2)
    share = successes / trials
    centre = (share + z**2 / (2 * trials)) / (1 + z**2 / trials)
    half = z / (1 + z**2 / trials) * np.sqrt(share * (1 - share) / trials + z**2 / (4 * trials**2))
    # Round-off must not push a bound past the share itself.
    low = 0.0 if successes == 0 else min(centre - half, share)
    high = 1.0 if successes == trials else max(centre + half, share)
    return float(low), float(high)


def counted_share(successes: int, trials: int, empty: float | None = None) -> dict[str, Any]:
    """Return `count`, `of`, `share` and its 95 % interval `low`, `high`; the share is `empty` without trials."""
    low, high = wilson_interval(int(successes), int(trials))
    share = successes / trials if trials else empty
    return {"count": int(successes), "of": int(trials), "share": share, "low": low, "high": high}


def spread_over_replicates(values: np.ndarray) -> tuple[float, float, float]:
    """Return median, 5 % and 95 % quantile over the finite replicates (NaN where there are none)."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    if not len(values):
        return np.nan, np.nan, np.nan
    low, middle, high = np.quantile(values, [0.05, 0.5, 0.95])
    return float(middle), float(low), float(high)
