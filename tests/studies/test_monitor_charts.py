"""Control charts: thresholds, false alarms, windows that are passed over."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.normal.estimate import Pooled
from jointwear.studies.monitor_study.charts import CLIP, LENGTHS, inflation, run_chart, threshold_for, thresholds_for
from jointwear.studies.monitor_study.normal_period import Normal
from jointwear.studies.monitor_study.scores import named_axis


@given(st.integers(1, 200), st.floats(0.0, 0.98), st.floats(0.0, 1.0))
def test_inflation_is_the_variance_of_a_mean(length, memory, slow):
    lags = np.arange(1, length)
    expected = 1 + 2 * np.sum((1 - lags / length) * slow * memory**lags)
    assert float(inflation(length, np.float64(memory), np.float64(slow))) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def white(windows: int = 120, n: int = 1, lead: tuple[int, ...] = ()) -> Normal:
    one = np.ones((*lead, n))
    pooled = Pooled(np.zeros((*lead, n, 5)), np.zeros((n, 5), dtype=bool), one)
    return Normal(pooled, 0 * one, one, 0 * one, 0 * one, windows * one, np.full(n, windows))


def test_the_stated_rate_of_false_alarms_holds():
    random, windows, rate = np.random.default_rng(11), 120, 0.02
    x = random.standard_normal((300, 200, 3)) - random.standard_normal((300, 1, 3)) / np.sqrt(windows)
    threshold, fall = thresholds_for(rate, np.full(3, windows))
    trace = run_chart(x, np.ones_like(x), threshold, fall, white(windows, 3, (300,)))
    # Half of the allowance is kept back; 300 x 200 windows of 3 axes.
    assert 0.25 * rate < trace.alarm.sum() / (300 * 200) < rate


def test_thresholds_grow_where_less_is_allowed_or_known():
    assert threshold_for(1e-3, 6, 120) > threshold_for(1e-2, 6, 120) > threshold_for(1e-2, 1, 120)
    assert threshold_for(1e-5, 6, 120) > threshold_for(1e-4, 6, 120)
    assert threshold_for(1e-3, 6, 10) > threshold_for(1e-3, 6, 120)
    assert np.isinf(thresholds_for(1e-3, np.array([120, 5]))[0][1])


def test_one_absurd_window_does_not_alarm_and_a_shift_does():
    x = np.zeros((60, 1))
    x[20] = 1e6
    args = (np.ones_like(x), np.array([4.2]), np.array([4.8]), white())
    assert CLIP / np.sqrt(min(LENGTHS)) < 4.2
    assert not run_chart(x, *args).alarm.any()
    x[30:] = 2.0
    trace = run_chart(x, *args)
    first = int(trace.alarm[:, 0].argmax())
    assert 31 < first < 45
    assert trace.length[first, 0] <= first - 20


def test_windows_that_are_not_judged_are_passed_over():
    random = np.random.default_rng(12)
    x = random.standard_normal((80, 2)) + 0.4
    gappy, std = np.full((160, 2), np.nan), np.ones((160, 2))
    gappy[::2, 0], gappy[1::2, 1] = x[:, 0], x[:, 1]
    limits = (np.full(2, 3.0), np.full(2, 3.0), white(n=2))
    dense, sparse = run_chart(x, np.ones_like(x), *limits), run_chart(gappy, std, *limits)
    assert np.array_equal(dense.alarm[:, 0], sparse.alarm[::2, 0])
    assert np.allclose(dense.statistic[:, 1], sparse.statistic[1::2, 1])
    assert np.isnan(sparse.statistic[1::2, 0]).all()


def test_of_the_axes_that_alarm_the_one_with_most_evidence_is_named():
    z = np.array([5.0, 1.0, np.nan, 4.9])
    assert named_axis(np.array([True, False, False, True]), z) == 1
    assert named_axis(np.zeros(4, dtype=bool), z) == 0
