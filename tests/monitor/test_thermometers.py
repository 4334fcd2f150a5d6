"""Temperatures of later logs in another unit are told with the unit; weather is not."""

import numpy as np
import pytest

from jointwear.measurement.units import converted
from jointwear.monitor.thermometers import other_unit
from jointwear.monitor.windows import blank_statistics


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
