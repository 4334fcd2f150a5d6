"""Scores of a judge over robots: counts with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.stats import bootstrap, chi2

from jointwear.statistics.intervals import CONFIDENCE, counted_share
from jointwear.statistics.randomness import generator

#: Worn axes are to be found within this time [h].
TWO_WEEKS = 336.0
#: Resamples of the robots, from a stream of their own.
RESAMPLES, SEED = 9999, 0


def poisson_rate(count: int, hours: float) -> dict[str, Any]:
    """Return `count`, `hours` and the rate per 1,000 h with its exact 95 % interval (Garwood 1936)."""
    if hours <= 0:
        return {"count": count, "hours": 0, "per_1000_h": None, "low": None, "high": None}
    side = (1 - CONFIDENCE) / 2
    low = float(chi2.ppf(side, 2 * count) / 2) if count else 0.0
    high = float(chi2.ppf(1 - side, 2 * count + 2) / 2)
    per = 1000 / hours
    return {"count": count, "hours": int(hours), "per_1000_h": count * per, "low": low * per, "high": high * per}


def rate_over_robots(counts: Sequence[int], hours: Sequence[float]) -> dict[str, Any]:
    """Return the 95 % interval `robots_low`, `robots_high` of a rate per 1,000 h; events of one robot belong together.

    Parameters
    ----------
    counts, hours : (robots,) events and hours of each robot.

    Notes
    -----
    Robots are resampled, not events: the bias-corrected and accelerated bootstrap (Efron 1987). None where fewer than
    two robots have an event, of which no scatter can be told.
    """
    counts, hours = np.asarray(counts, dtype=float), np.asarray(hours, dtype=float)
    if np.count_nonzero(counts) < 2:
        return {"robots_low": None, "robots_high": None}

    def per_1000_h(events: np.ndarray, watched: np.ndarray, axis: int = -1) -> np.ndarray:
        return 1000 * events.sum(axis=axis) / watched.sum(axis=axis)

    drawn = generator(SEED, "rate over robots", replicate=0)
    interval = bootstrap(
        (counts, hours), per_1000_h, paired=True, n_resamples=RESAMPLES, confidence_level=CONFIDENCE, rng=drawn
    ).confidence_interval
    return {"robots_low": float(interval.low), "robots_high": float(interval.high)}


def false_alarms(facts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the rate of false alarms before any wear; of `robots` so many `alarmed`, on `axes` axes in all."""
    rate = poisson_rate(sum(len(f["false"]) for f in facts), sum(f["quiet_hours"] for f in facts))
    axes = sum(len({axis for _, axis, _ in f["false"]}) for f in facts)
    return rate | {"robots": len(facts), "alarmed": sum(bool(f["false"]) for f in facts), "axes": axes}


def _quantiles(values: Sequence[float]) -> dict[str, Any]:
    if not values:
        return {"median": None, "low": None, "high": None}
    low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
    return {"median": float(middle), "low": float(low), "high": float(high)}


def detection(facts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return `found` within two weeks, `right` axis of the first alarm after the onset, `delay` [h], `growth`.

    A false alarm of another axis between onset and alarm makes a first alarm wrong, and at a stated rate there are so
    many of them. `named`: of the worn axes that alarmed, those that then were the likeliest of all told so far.
    """
    worn = [f for f in facts if f["worn"]]
    told = [f["likeliest"] for f in worn if f["likeliest"] is not None]
    found = [f for f in worn if f["delay"] is not None and f["delay"] <= TWO_WEEKS]
    alarmed = [f for f in worn if f["first_axis"] is not None]
    return {
        "found": counted_share(len(found), len(worn)),
        "right": counted_share(sum(f["first_axis"] == f["axis"] for f in alarmed), len(alarmed)),
        "named": counted_share(sum(told), len(told)),
        "delay": _quantiles([f["delay"] for f in found]),
        "operating": _quantiles([f["operating"] for f in found]),
        "growth": _quantiles([100 * f["growth"] for f in found]),
        "unjudgeable": sum(f["judgeable"] < 0.5 for f in worn),
    }


def forecasts(facts: Sequence[dict[str, Any]], later: float) -> dict[str, Any]:
    """Return how many 80 % intervals `held` of those `given` for Coulomb friction, and how many were open ended."""
    told = [g for f in facts if f["worn"] and f["kind"] == "coulomb" for g in f["forecasts"] if g["later"] == later]
    given = [g for g in told if g["given"]]
    return {
        "held": counted_share(sum(g["held"] for g in given), len(given)),
        "open": sum(g["high"] is None for g in given),
        "missing": len(told) - len(given),
        "early": sum(g["low"] is not None and g["true"] < g["low"] - 1 for g in given),
    }


def curve(facts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the share of worn axes (Coulomb) found by `days` since the onset."""
    worn = [f for f in facts if f["worn"] and f["kind"] == "coulomb"]
    delays = np.array([np.inf if f["delay"] is None else f["delay"] for f in worn])
    days = np.arange(0, 14.25, 0.25)
    return {"days": days.tolist(), "found": [float(np.mean(delays <= 24 * d)) if len(worn) else 0.0 for d in days]}


def summary(facts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return all scores of the outcomes at one stated rate."""

    def groups(key: str) -> dict[str, Any]:
        names = list(dict.fromkeys(f[key] for f in facts))
        parts = {name: [f for f in facts if f[key] == name] for name in names}
        return {k: false_alarms(p) | {"unjudged": float(np.mean([f["unjudged"] for f in p]))} for k, p in parts.items()}

    coulomb = [f for f in facts if f["worn"] and f["kind"] == "coulomb"]
    fast = [f for f in coulomb if f["duration"] <= TWO_WEEKS]
    return {
        "rate": facts[0]["rate"],
        "robots": len(facts),
        "false": false_alarms(facts)
        | rate_over_robots([len(f["false"]) for f in facts], [f["quiet_hours"] for f in facts]),
        "by_scenario": groups("scenario"),
        "by_thermometer": groups("thermometer"),
        "by_arm": groups("arm"),
        "unjudged": float(np.mean([f["unjudged"] for f in facts])),
        "coulomb_in_two_weeks": detection(fast),
        "coulomb": detection(coulomb),
        "viscous": detection([f for f in facts if f["worn"] and f["kind"] == "viscous"]),
        "together": detection([f for f in coulomb if f["scenario"] == "all"]),
        "forecast": forecasts(facts, 0),
        "forecast_later": forecasts(facts, 24.0),
    }
