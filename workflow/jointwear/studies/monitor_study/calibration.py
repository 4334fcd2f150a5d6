"""How wide the forecast's interval must be: measured on made-up growth, never on the paper's grid.

The forecaster averages over growth laws, and the prior among them is a choice. Here histories are drawn from laws that
it does not have (logistic growth, steps in rate) and from some that it has, with onsets, sizes and noise drawn too;
each is charted, forecast at its alarm and a day later, and the share of intervals that hold the truth is counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.estimate import Pooled
from jointwear.studies.monitor_study.charts import run_chart, thresholds_for
from jointwear.studies.monitor_study.forecast import forecast
from jointwear.studies.monitor_study.normal_period import Normal

HOURS, NORMAL = 240, 120
#: Hours after an alarm at which its forecast is looked at once more.
LATER = 24


@dataclass(frozen=True)
class History:
    """Measured growth (h,), its standard deviation, the true growth on a long grid, and the limit."""

    measured: np.ndarray
    std: float
    true: np.ndarray
    limit: float


def draw_history(random: np.random.Generator) -> History:
    """Return one history of hourly estimates."""
    hour = np.arange(1.0, 20 * HOURS + 1)
    size, scale = np.exp(random.uniform(np.log(0.05), np.log(0.3))), random.uniform(60.0, 240.0)
    since = np.maximum(hour - random.uniform(0.0, 60.0), 0.0) / scale
    kind = random.integers(4)
    if kind == 0:
        growth = since ** np.exp(random.uniform(0.0, np.log(6.0)))
    elif kind == 1:
        steepness = random.uniform(3.0, 8.0)
        growth = np.expm1(np.minimum(steepness * since, 50.0)) / np.expm1(steepness)
    elif kind == 2:
        # Logistic in a power of time: accelerates, then settles.
        growth = np.tanh(0.5 * (random.uniform(1.0, 2.0) * since) ** random.uniform(1.5, 5.0))
    else:
        # Slow, then faster from some moment on.
        bend = random.uniform(0.2, 0.6)
        growth = 0.3 * since + random.uniform(1.0, 3.0) * np.maximum(since - bend, 0.0)
    true = size * growth
    std = np.exp(random.uniform(np.log(0.001), np.log(0.01)))
    measured = true[:HOURS] + std * (random.standard_normal(HOURS) - random.standard_normal() / np.sqrt(NORMAL))
    return History(measured, float(std), true, size / 2)


def _normal(std: float) -> Normal:
    zero, one = np.zeros(1), np.ones(1)
    return Normal(
        pooled=Pooled(np.zeros((1, 5)), np.zeros((1, 5), dtype=bool), one),
        mean=zero,
        spread=one,
        memory=zero,
        slow=zero,
        weight=NORMAL / std**2 * one,
        windows=np.array([NORMAL]),
    )


def coverage(seed: int, histories: int, share: float) -> dict[str, np.ndarray]:
    """Return for the forecasts at the alarm and :data:`LATER` hours after whether the interval holds the truth.

    Each value is a boolean array over the histories that alarmed before the limit was reached.
    """
    random = np.random.default_rng(seed)
    threshold, fall = thresholds_for(0.3e-3, np.array([NORMAL]))
    found: dict[str, list[bool]] = {"alarm": [], "later": []}
    for _ in range(histories):
        drawn = draw_history(random)
        normal = _normal(drawn.std)
        std = np.full((HOURS, 1), drawn.std)
        trace = run_chart(drawn.measured[:, None], std, threshold, fall, normal)
        hits = np.flatnonzero(trace.alarm[:, 0])
        reached = np.argmax(drawn.true >= drawn.limit) + 1.0 if drawn.true[-1] >= drawn.limit else np.inf
        for name, wait in (("alarm", 0), ("later", LATER)):
            last = hits[0] + 1 + wait if len(hits) else HOURS + 1
            if last > HOURS or reached <= last:
                continue
            told = forecast(
                np.arange(1.0, last + 1), drawn.measured[:last], std[:last, 0], drawn.limit,
                mean_std=drawn.std / NORMAL**0.5, start=0.0, share=share,
            )  # fmt: skip
            found[name].append(told.low <= reached - last <= told.high)
    return {name: np.array(values) for name, values in found.items()}
