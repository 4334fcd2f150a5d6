"""When growth reaches its limit, from the means of shifts."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.monitor.watching.shift_forecast import TOLD, forecast_shifts


@settings(max_examples=20, deadline=None)
@given(st.floats(0.002, 0.01), st.integers(4, 8))
def test_forecasts_of_steady_growth_hold_and_do_not_promise_an_end_too_soon(daily, days):
    time = 24.0 * np.arange(1, days + 1)
    growth = daily * np.arange(1, days + 1)
    told = forecast_shifts(time, growth, np.full(days, 1e-6), 0.2, shared=1e-3, start=0.0, now=time[-1])
    true = (0.2 / daily - days) * 24
    assert told.low <= true <= told.high
    assert told.low <= told.hours <= told.high


def test_a_limit_is_nearer_than_growth_that_is_told_low_says():
    days, daily = 8, 0.01
    time, variance = 24.0 * np.arange(1, days + 1), np.full(days, 1e-6)

    def hours(share: float) -> float:
        growth = share * daily * np.arange(1, days + 1)
        return forecast_shifts(time, growth, variance, 0.2, shared=1e-3, start=0.0, now=time[-1]).hours

    assert hours(1.0) < hours(TOLD)
    assert hours(1.0) < (0.2 / daily - days) * 24


def test_growth_on_its_way_has_an_end_and_growth_at_rest_has_none():
    days = 10
    time, variance = 24.0 * np.arange(1, days + 1), np.full(days, 1e-6)
    growing, resting = 0.01 * np.arange(days), np.minimum(0.02 * np.arange(days), 0.04)
    told, open_ended = (
        forecast_shifts(time, growth, variance, 0.2, shared=1e-3, start=0.0, now=time[-1])
        for growth in (growing, resting)
    )
    assert np.isfinite(told.high)
    assert open_ended.low > told.low
    assert not np.isfinite(open_ended.high)
