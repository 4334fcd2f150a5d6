"""The normal state of an axis: shifts, its fit, the scatter between shifts, warming."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.monitor.normal.dispersion import (
    FLOOR,
    USUAL_NONE,
    USUAL_OWN,
    Dispersion,
    ShiftMeans,
    between_shifts,
    inflated,
    updated_between,
)
from jointwear.monitor.normal.normal_state import Noise, Posterior, fit_normal_state, taught
from jointwear.monitor.normal.shifts import shift_labels
from jointwear.monitor.normal.warm_up import warm_up_state

HOUR = 3600.0


def windows(days: int, first: int = 6, length: int = 8) -> np.ndarray:
    return HOUR * np.concatenate([24.0 * d + first + np.arange(length) for d in range(days)])


def test_pauses_end_shifts_and_a_robot_that_never_stops_is_cut_into_parts():
    start = windows(5)
    label = shift_labels(start, start + HOUR, np.ones(len(start), dtype=bool))
    assert np.array_equal(label, np.repeat(np.arange(5), 8))
    start = HOUR * np.arange(240.0)
    label = shift_labels(start, start + HOUR, start < 48 * HOUR)
    assert (np.bincount(label) == 8).all()
    # A day where programs change, a working shift where one runs alone.
    for steady, hours in ((False, 24), (True, 8)):
        label = shift_labels(start, start + HOUR, start < 168 * HOUR, steady)
        assert (np.bincount(label) == hours).all()


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 60))
def test_a_later_window_moves_no_shift(more):
    start = HOUR * np.arange(100.0 + more)
    base = start < 48 * HOUR
    assert np.array_equal(
        shift_labels(start[:100], start[:100] + HOUR, base[:100]), shift_labels(start, start + HOUR, base)[:100]
    )


def with_and_without_a_shift(seed):
    """Six shifts of a level that follows one condition: design, values, labels, the fit of all and that without 2."""
    random = np.random.default_rng(seed)
    shift = np.repeat(np.arange(6), 10)
    x = np.stack([np.ones(60), random.standard_normal(60)], axis=1)
    y = x @ [0.3, 0.1] + 0.01 * random.standard_normal(60)
    noise, prior = Noise(np.full(60, 1e-4), 0.0, 1e-5), Posterior(np.zeros(2), np.eye(2))
    values = y, np.where(shift == 2, np.nan, y)
    return x, y, shift, *(fit_normal_state(x, value, noise, shift, prior) for value in values)


def test_left_out_residuals_are_those_of_a_fit_without_the_shift():
    x, y, shift, whole, rest = with_and_without_a_shift(1)
    assert whole.posterior.mean == pytest.approx([0.3, 0.1], abs=0.01)
    expected = y[shift == 2] - x[shift == 2] @ rest.posterior.mean
    assert whole.left_out[shift == 2] == pytest.approx(expected, abs=2e-3)


def test_the_mean_of_a_shift_is_predicted_as_its_mean_conditions_are():
    """Windows at other temperatures err apart: their mean is known better than each of them."""
    x, _, shift, whole, rest = with_and_without_a_shift(3)
    _, variance = rest.posterior.predict(x[shift == 2].mean(axis=0, keepdims=True))
    assert whole.mean_variance[shift == 2] == pytest.approx(np.full(10, variance[0]), rel=0.1)
    assert (whole.mean_variance < [whole.left_out_variance[shift == k].mean() for k in shift]).all()


def test_an_odd_day_of_the_baseline_does_not_rule_it():
    shift = np.repeat(np.arange(8), 8)
    y = 0.002 * np.random.default_rng(2).standard_normal(64) + 0.2 * (shift == 3)
    fit = fit_normal_state(
        np.ones((64, 1)), y, Noise(np.full(64, 1e-5), 0.0, 2.5e-5), shift, Posterior(np.zeros(1), np.eye(1))
    )
    assert abs(fit.posterior.mean[0]) < 0.006


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.5, 0.5))
def test_a_shift_teaches_contrasts_and_never_its_level(step):
    random = np.random.default_rng(5)
    x = np.stack([np.ones(30), random.standard_normal(30)], axis=1)
    y = x @ [0.0, 0.1] + 0.002 * random.standard_normal(30)
    before = Posterior(np.zeros(2), np.diag([1e-4, 0.09]))
    after = taught(before, x, y, np.full(30, 4e-6))
    worn = taught(before, x, y + step, np.full(30, 4e-6))
    assert after.mean == pytest.approx([0.0, 0.1], abs=5e-3)
    assert worn.mean == pytest.approx(after.mean, abs=1e-9)
    assert after.covariance[0, 0] == pytest.approx(1e-4)
    assert after.covariance[1, 1] < 1e-5


def test_scatter_between_shifts_has_a_floor_and_is_found():
    random = np.random.default_rng(3)
    quiet = [ShiftMeans(np.zeros(6), np.full(6, 1e-8)) for _ in range(3)]
    assert all(FLOOR <= b < 2 * FLOOR for b, _ in between_shifts(quiet, [USUAL_OWN] * len(quiet)))
    wide = [ShiftMeans(0.05 * random.standard_normal(12), np.full(12, 1e-6)) for _ in range(3)]
    assert all(0.03 < b < 0.09 for b, _ in between_shifts(wide, [USUAL_OWN] * len(wide)))


def test_an_axis_without_a_logged_temperature_is_expected_to_scatter_more():
    few = [ShiftMeans(np.zeros(4), np.full(4, 1e-4)) for _ in range(2)]
    (known, _), (unknown, _) = (between_shifts(few, [usual] * 2)[0] for usual in (USUAL_OWN, USUAL_NONE))
    assert unknown > 1.3 * known


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 0.008))
def test_later_shifts_widen_the_scatter_and_slow_growth_hardly_does(growth):
    first, none = Dispersion(0.0, 0.0, 0.007, 0.4), np.full(16, 1e-6)
    random = np.random.default_rng(6)
    quiet = 0.005 * random.standard_normal(16)
    same = np.zeros(16, dtype=int)
    steady = updated_between(first, quiet, none, same)
    worn = updated_between(first, quiet + growth * np.arange(16), none, same)
    assert steady[0] == pytest.approx(0.007, rel=0.2)
    assert worn[-1] < 0.012
    assert updated_between(first, 6 * quiet, none, same)[-1] > 0.018
    # One step of a service says little, and none where the axis was learnt anew.
    service = np.where(np.arange(16) >= 8, -0.1, 0.0)
    assert updated_between(first, quiet + service, none, same)[-1] < 2.5 * steady[-1]
    anew = updated_between(first, quiet + service, none, (np.arange(16) >= 8).astype(int))
    assert anew[-1] < 1.2 * steady[-1]


def test_warm_up_rises_in_operation_and_falls_at_rest():
    start = windows(2)
    state = warm_up_state(start, start + HOUR, np.ones((16, 1)), 2.0)[:, 0]
    assert (np.diff(state[:8]) > 0).all()
    assert state[8] < state[7]
    assert state.max() < 1.0


@pytest.mark.parametrize("memory", [0.0, 0.3, 0.9])
def test_the_mean_of_windows_that_remember_each_other_varies_as_the_sum_of_their_covariances(memory):
    for count in (1, 2, 8, 30):
        place = np.arange(count)
        covariance = memory ** np.abs(place[:, None] - place)
        assert inflated(count, memory) == pytest.approx(covariance.sum() / count)
