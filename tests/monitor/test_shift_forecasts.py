"""When growth reaches its limit, from the means of shifts."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.monitor.events import Event
from jointwear.monitor.findings.still_growth import STANDSTILL, standstill_findings
from jointwear.monitor.presentation.to_answer import asks_for_answer
from jointwear.monitor.watching.limits import LimitDate
from jointwear.monitor.watching.shift_forecast import STANDS, TOLD, forecast_shifts
from jointwear.monitor.watching.standstill import Standstill, standstill


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


def still(days, stop, daily=0.01, scatter=0.002, seed=0):
    """Growth that goes on to a day and stands still from there on, and what is told of it."""
    time = 24.0 * np.arange(1, days + 1)
    noise = scatter * np.random.default_rng(seed).standard_normal(days)
    growth = daily * np.minimum(np.arange(1, days + 1), stop) + noise
    kept = {"shared": 1e-3, "start": 0.0, "now": float(time[-1])}
    given = time, growth, np.full(days, scatter**2), 0.2
    return standstill(*given, **kept), forecast_shifts(*given, **kept)


@pytest.mark.parametrize("seed", range(4))
def test_growth_that_has_stopped_is_told_since_when_and_has_no_date(seed):
    found, told = still(20, 13, seed=seed)
    assert found.probability > STANDS
    assert found.since / 24 == pytest.approx(13, abs=2.5)
    assert (told.still, told.hours, told.high) == (found.since, np.inf, np.inf)


@pytest.mark.parametrize("seed", range(4))
def test_growth_that_goes_on_stands_not_still(seed):
    found, told = still(13, 13, seed=seed)
    assert found.probability < 0.05
    assert np.isnan(told.still)
    assert np.isfinite(told.high)


def test_a_standstill_at_the_limit_is_no_standstill_below_it():
    found, told = still(35, 26)
    assert found.probability < 0.1
    assert (told.hours, told.low) == (0.0, 0.0)


def test_a_standstill_takes_some_shifts_and_no_scatter_but_their_own():
    assert still(14, 13)[0].probability < 0.1
    # A factor in what is stated of the scatter changes nothing: it is learnt from the shifts.
    time, growth = 24.0 * np.arange(1, 21), 0.01 * np.minimum(np.arange(1, 21), 13)
    growth = growth + 0.004 * np.random.default_rng(1).standard_normal(20)
    kept = {"shared": 1e-3, "start": 0.0, "now": 480.0}
    small, large = (standstill(time, growth, np.full(20, s**2), 0.2, **kept) for s in (0.002, 0.008))
    assert small.probability == pytest.approx(large.probability, abs=0.15)
    assert standstill(time[:4], growth[:4], np.full(4, 1e-6), 0.2, **kept | {"now": 96.0}) == Standstill()
    assert still(300, 200, daily=0.0005)[0].probability > 0.9


def test_the_page_is_told_of_a_standstill():
    statistics = SimpleNamespace(dated=True)
    limit = LimitDate("coulomb friction", np.inf, np.inf, np.inf, still=1.7956e9)
    (found,) = standstill_findings(statistics, [None, limit])
    assert (found["kind"], found["axes"], found["time"]) == (STANDSTILL, [2], 1.7956e9)
    assert found["words"].startswith("Growth of the Coulomb friction of axis 2 has stood still since about 2026-11-25T")
    assert not asks_for_answer(found)
    assert "first alarm" not in found["words"]


@pytest.mark.parametrize(("first", "repair", "late"), [(8.0, None, True), (-2.0, None, False), (-2.0, -1.0, True)])
def test_growth_that_stood_still_before_its_first_alarm_is_told_so(first, repair, late):
    """A page told growth as still since nine days before the alarm of it, without a word on why."""
    statistics, since, day = SimpleNamespace(dated=True), 1.7956e9, 86400.0
    limit = LimitDate("coulomb friction", np.inf, np.inf, np.inf, still=since)
    alarms = [{"time": since + first * day, "axis": 2, "detector": "model"}]
    if repair is not None:
        alarms.append({**alarms[0], "time": since + 8 * day})
    alarms += [{**alarms[0], "time": since - 9 * day, "detector": "paper"}, {**alarms[0], "axis": 1}]
    events = [] if repair is None else [Event(since + repair * day, (), "service")]
    (found,) = standstill_findings(statistics, [None, limit], alarms, events)
    assert ("before its first alarm at 2026-12-03T" in found["words"]) is late
