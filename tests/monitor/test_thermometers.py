"""Temperatures of later logs in another unit are told with the unit; weather is not."""

import numpy as np
import pytest

from jointwear.measurement.units import converted
from jointwear.monitor.findings.thermometers import broken, other_unit, stuck
from jointwear.monitor.reading.windows import blank_statistics


def statistics(later):
    """Twenty windows of two axes at 20 to 38 degC, then `later`."""
    found = blank_statistics(np.arange(20 + len(later)) * 3600.0, 3600.0, np.ones(2), True)
    found.temperature[:20] = np.linspace(20, 38, 20)[:, None]
    found.temperature[20:] = np.asarray(later)[:, None]
    return found, np.arange(20 + len(later)) < 20


@pytest.mark.parametrize(("unit", "later"), [("degF", [77.0, 86.0, 100.0]), ("K", [295.0, 300.0, 305.0])])
def test_temperatures_in_another_unit_are_told_with_it(unit, later):
    (found,) = other_unit(*statistics([25.0, *later, 30.0]))
    assert found["axes"] == [1, 2]
    assert found["time"] == 21 * 3600.0
    assert f"near them if they are in {unit}" in found["words"]
    assert "of 3 windows" in found["words"]


@pytest.mark.parametrize("later", [[5.0, 8.0, 10.0], [50.0, 52.0, 45.0], [90.0], [-60.0] * 4, [np.nan] * 3])
def test_weather_a_hot_oil_and_a_broken_thermometer_are_no_unit(later):
    assert other_unit(*statistics(later)) == []


def test_fahrenheit_is_read():
    assert converted(np.array([32.0, 212.0]), "temperature", "°F", "a") == pytest.approx([0.0, 100.0])


def days(later, pause=16.0):
    """Ten shifts of eight windows in which two axes warm up from 20 to 34 degC, a pause [h] between them, then `later`
    of the first axis."""
    hours = np.arange(80 + len(later))
    found = blank_statistics((hours + pause * (hours // 8)) * 3600.0, 3600.0, np.ones(2), True)
    found.temperature[:] = (20.0 + 2 * (hours % 8))[:, None]
    found.temperature[80:, 0] = later
    return found, hours < 80


@pytest.mark.parametrize("value", [26.0, 0.0])
def test_a_thermometer_that_stops_is_told_and_not_believed(value):
    found, baseline = days([value] * 24)
    known = stuck(found, baseline)
    # From the third shift on it is known.
    assert known[96:, 0].all()
    assert not known[:96].any()
    assert not known[:, 1].any()
    (told,) = (f for f in broken(found, baseline) if "stopped" in f["words"])
    assert told["axes"] == [1]
    assert f"stopped at {value:.3g} degC" in told["words"]
    assert told["end"] == found.end[-1]


def test_a_thermometer_that_is_lost_is_told_before_it_is_known_to_be_stuck():
    (told,) = broken(*days([0.0] * 4))
    assert "more than 15 K" in told["words"]
    assert told["axes"] == [1]


def test_a_thermometer_that_never_worked_is_told():
    found, baseline = days([0.0] * 8)
    found.temperature[:, 0] = 0.0
    assert not stuck(found, baseline).any()
    (told,) = broken(found, baseline)
    assert "shows 0 degC throughout the normal period" in told["words"]
    assert "as if no temperature were logged, also once it is mended" in told["words"]


@pytest.mark.parametrize("later", [[20.0] * 15, list(20 + 2 * (np.arange(24) % 8)), [12.0, 14.0], [np.nan] * 30])
def test_a_quiet_shift_and_a_cold_day_are_no_broken_thermometer(later):
    found, baseline = days(later)
    assert broken(found, baseline) == []
    assert not stuck(found, baseline).any()


@pytest.mark.parametrize("whole", [True, False])
def test_a_robot_that_never_rests_may_keep_its_temperature(whole):
    found, baseline = days([30.0] * 40, pause=0.0)
    found.temperature[slice(None) if whole else slice(60, None)] = 30.0
    assert broken(found, baseline) == []
    assert not stuck(found, baseline).any()


def around_the_clock(still, weather=3.0, others=True, step=0.1):
    """Ten days of 24 windows of two axes that follow the hour and the day; the first axis is still in the last `still`
    windows, both unless `others`. `weather` [K] of the hour, `step` [K] of the thermometer."""
    hours = np.arange(240)
    found = blank_statistics(hours * 3600.0, 3600.0, np.ones(2), True)
    value = 30.0 + weather * np.sin(2 * np.pi * hours / 24) + np.sin(hours / 50)
    found.temperature[:] = step * np.round(np.stack([value, 2 + 1.1 * value], axis=1) / step)
    if still:
        found.temperature[-still:, : 1 if others else 2] = found.temperature[-still, : 1 if others else 2]
    return found, hours < 120


@pytest.mark.parametrize(("others", "whole"), [(True, 24), (False, 48)])
def test_a_thermometer_that_stops_on_a_robot_without_pauses_is_told_after_a_day_or_two(others, whole):
    found, baseline = around_the_clock(96, others=others)
    known = stuck(found, baseline)
    # Values at the edge may repeat before it stops.
    assert np.flatnonzero(known[:, 0])[0] in range(144 + whole - 3, 144 + whole)
    assert known[144 + whole :, 0].all()
    assert bool(known[:, 1].any()) is not others
    (told,) = broken(found, baseline)
    assert "has stopped at" in told["words"]
    assert told["axes"] == ([1] if others else [1, 2])


@pytest.mark.parametrize("given", [{"still": 0}, {"still": 20}, {"still": 90, "step": 1.0, "weather": 0.7}])
def test_a_still_night_and_a_coarse_thermometer_without_pauses_are_no_stop(given):
    assert not stuck(*around_the_clock(**given)).any()


def test_a_coarse_thermometer_keeps_its_value_for_long():
    found, baseline = days([30.0] * 24)
    found.temperature[:80, 0] = np.repeat([28.0, 30.0, 28.0, 30.0], 20)
    assert not stuck(found, baseline).any()
