"""Thresholds of runs on which nothing happens."""

import numpy as np
import pytest

from jointwear.files.schemas import read_schema
from jointwear.monitor.watching.null_runs import JUDGED, RUNS, Axis, _draws, _maxima, null_thresholds


def test_thresholds_rise_with_what_is_asked_and_with_what_is_not_known():
    axis = Axis(0.006, 0.2, 0.003, 0.002, 8)
    usual = null_thresholds(axis, 1e-4)
    rare = null_thresholds(axis, 1e-6)
    unknown = null_thresholds(Axis(0.006, 0.6, 0.003, 0.002, 8), 1e-4)
    for k in range(2):
        assert rare[k] > usual[k] > null_thresholds(axis, 1e-3)[k]
        assert unknown[k] > usual[k]
    # A normal state that is hardly known hides steps of the level, not those from shift to shift.
    coarse = null_thresholds(Axis(0.006, 0.2, 0.05, 0.002, 8), 1e-4)
    assert coarse[0] < coarse[1]


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_runs_on_which_nothing_happens_alarm_as_often_as_is_allowed(share):
    axis = Axis(0.006, 0.2, 0.003, 0.002, 8).rounded()
    a_window = -np.log1p(-share) / (JUDGED * axis.windows)
    level, step = _maxima(axis)
    of_level, of_step = null_thresholds(axis, a_window)
    assert np.mean((level > of_level) | (step > of_step)) == pytest.approx(share, rel=0.1)


@pytest.mark.parametrize("windows", [6, 11, 12, 23, 24, 48])
def test_the_rate_holds_however_many_windows_a_shift_has(windows):
    """Runs of the axis as it is, against the threshold that it gets from those of an axis on the grid."""
    axis, a_window = Axis(0.0077, 0.44, 0.0054, 0.0021, windows), 5 / 1000 / 6
    (level, step), (of_level, of_step) = _maxima(axis), null_thresholds(axis, a_window)
    alarms = np.mean((level > of_level) | (step > of_step))
    assert alarms == pytest.approx(-np.expm1(-a_window * JUDGED * windows), rel=0.15)


def test_shifts_of_null_runs_scatter_as_is_stated():
    drawn = _draws(8)
    assert np.std(drawn.fresh) == pytest.approx(1.0, rel=0.1)
    assert np.quantile(np.abs(drawn.fresh), 0.999) > 4.0


def test_fewer_false_alarms_than_the_runs_can_tell_are_not_promised():
    """One in all hours of the runs, shifts of eight, of an arm of six axes."""
    rates = read_schema("config")["properties"]["monitor"]["properties"]["robots"]["additionalProperties"]["properties"]
    hours = RUNS * JUDGED * 8 / 6
    assert rates["false_alarms_per_1000_h"]["minimum"] == pytest.approx(1000 / hours, rel=0.1)
