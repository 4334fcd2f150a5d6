"""Lag matrices and the decision rule."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.reproduction import readings
from jointwear.reproduction.location import lag_matrix, largest_shift, locate, shift_at


def direct_lag(x, y, means_removed):
    """Equation (5) and (6) as printed, by double loop."""
    n = len(x)
    if means_removed:
        x, y = x - x.mean(), y - y.mean()
    best, best_value = 0, -np.inf
    for lag in sorted(range(-(n - 1), n), key=lambda d: (abs(d), d < 0)):
        value = sum(x[t] * y[t + lag] for t in range(n) if 0 <= t + lag < n)
        if value > best_value + 1e-9:
            best, best_value = lag, value
    return best


@given(seed=st.integers(0, 10_000), correlation=st.sampled_from(["raw", "means_removed"]))
@settings(max_examples=25)
def test_lags_are_those_of_equation_5(seed, correlation):
    series = np.random.default_rng(seed).normal(0.5, 1, (1, 20, 3))
    inside = np.ones((1, 20), dtype=bool)
    lag = lag_matrix(series, inside, correlation)[0]
    for i in range(3):
        for j in range(i + 1, 3):
            assert lag[i, j] == direct_lag(series[0, :, i], series[0, :, j], correlation == "means_removed")


@given(
    seed=st.integers(0, 10_000),
    correlation=st.sampled_from(["raw", "means_removed"]),
    peak=st.sampled_from(["maximum", "absolute_maximum"]),
)
def test_the_lag_matrix_is_antisymmetric(seed, correlation, peak):
    series = np.random.default_rng(seed).gamma(1.0, 1.0, (3, 40, 6))
    lag = lag_matrix(series, np.ones((3, 40), dtype=bool), correlation, peak)
    assert np.array_equal(lag, -lag.swapaxes(1, 2))


def test_a_delayed_copy_trails():
    series = np.random.default_rng(0).normal(size=(1, 200, 2))
    series[0, 7:, 1] = series[0, :-7, 0]
    assert lag_matrix(series, np.ones((1, 200), dtype=bool), "means_removed")[0, 0, 1] == 7


def test_a_constant_series_has_no_lag():
    series = np.random.default_rng(0).normal(size=(1, 50, 2))
    series[..., 1] = 2.0
    assert not lag_matrix(series, np.ones((1, 50), dtype=bool), "means_removed").any()


def test_of_two_lags_as_short_and_as_good_the_second_axis_trails():
    """A pulse between two others that are alike: it correlates as well with the one before as with the one after."""
    series = np.zeros((1, 9, 2))
    series[0, 4, 0] = series[0, 2, 1] = series[0, 6, 1] = 1.0
    lag = lag_matrix(series, np.ones((1, 9), dtype=bool), "raw")
    assert lag[0].tolist() == [[0, 2], [-2, 0]]


def test_hours_outside_do_not_count():
    series = np.random.default_rng(1).normal(size=(1, 60, 2))
    inside = np.arange(60)[None] < 30
    changed = series.copy()
    changed[:, 30:] = 99
    assert np.array_equal(lag_matrix(series, inside, "raw"), lag_matrix(changed, inside, "raw"))


PUBLISHED = np.array(
    [
        [0, -3, -3, -27, 0, -4],
        [3, 0, 0, 0, -38, -2],
        [3, 0, 0, 0, 6, 0],
        [27, 0, 0, 0, -22, 5],
        [0, 38, -6, 22, 0, 32],
        [4, 2, 0, -5, -32, 0],
    ]
)


def test_the_rule_names_axis_1_in_the_printed_table_ii():
    rules = readings.ambiguities()["source_rule"].alternatives
    assert rules["column_not_negative"](PUBLISHED[None])[0] == 1
    # Axis 1 has a lag of 0 to axis 5, so a rule that wants only positive lags names none.
    assert rules["column_positive"](PUBLISHED[None])[0] == 0
    assert rules["row_not_negative"](-PUBLISHED[None])[0] == 1


@pytest.mark.parametrize(
    ("name", "value"),
    [(n, v) for n in readings.of_stage("location") for v in readings.ambiguities()[n].alternatives],
)
def test_every_alternative_locates(default_reading, name, value):
    random = np.random.default_rng(3)
    features = {"kl_divergence": random.random((4, 50, 6)), "mean_absolute_torque": random.random((4, 50, 6))}
    features["kl_divergence"][..., 2] += np.linspace(0, 5, 50) ** 2
    onset = np.array([30.0, 40.0, np.nan, 20.0])
    lag, source = locate(features, onset, np.zeros((4, 6)), np.ones((4, 6)), {**default_reading, name: value})
    assert lag.shape == (4, 6, 6)
    assert ((source >= 0) & (source <= 6)).all()


def test_the_largest_shift_names_the_rising_axis():
    kl = np.random.default_rng(3).normal(size=(2, 50, 6))
    kl[0, 25:, 3] += 4
    shift = largest_shift(kl, np.zeros((2, 6)), np.ones((2, 6)))
    assert shift.shape == (2, 50)
    assert shift_at(shift, np.array([26.0, np.nan])).tolist() == [4, 0]
    assert shift[0, 49] == kl[0, 49].argmax() + 1
