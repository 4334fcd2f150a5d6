"""Forecasts of the hours to a limit, and their intervals."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.studies.monitor_study.forecast import forecast


@settings(deadline=None, max_examples=25)
@given(st.floats(1.0, 4.0), st.integers(60, 110))
def test_forecasts_of_clear_growth_are_close(exponent, now):
    hour = np.arange(1.0, now + 1)
    growth = 0.2 * (hour / 120) ** exponent
    told = forecast(hour, growth, np.full(now, 1e-4), 0.2, start=0.0)
    assert told.low <= told.hours <= told.high
    assert told.low - 3 <= 120 - now <= told.high + 3


def test_forecast_says_now_never_and_unknown():
    hour = np.arange(1.0, 61)
    risen = 0.3 * (hour / 60) ** 2
    now = forecast(hour, risen, np.full(60, 1e-3), 0.2, start=0.0)
    assert now.low == now.hours == 0.0
    flat = forecast(hour, np.zeros(60), np.full(60, 1e-5), 0.2, start=0.0)
    assert flat.hours > 300
    assert np.isnan(forecast(hour[:2], risen[:2], np.full(2, 1e-3), 0.2).hours)


def test_a_less_certain_past_gives_a_wider_interval():
    hour = np.arange(1.0, 81)
    growth = 0.2 * (hour / 120) ** 3
    widths = []
    for std in (1e-3, 1e-2, 3e-2):
        told = forecast(hour, growth, np.full(80, std), 0.2, start=0.0)
        widths.append(told.high - told.low)
    assert widths[0] < widths[1] < widths[2]
