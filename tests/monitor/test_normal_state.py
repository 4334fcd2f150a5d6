"""The parts of the decision: shifts, normal state, dispersion, threshold, forecast, baseline, programs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.monitor.normal.dispersion import (
    FLOOR,
    START,
    USUAL_NONE,
    USUAL_OWN,
    Dispersion,
    ShiftMeans,
    between_shifts,
    inflated,
    updated_between,
)
from jointwear.monitor.normal.normal_state import Noise, Posterior, fit_normal_state, taught
from jointwear.monitor.normal.recent_shifts import AxisWindows, _unexplained
from jointwear.monitor.normal.shift_scale import shift_scale
from jointwear.monitor.normal.shifts import shift_labels
from jointwear.monitor.normal.warm_up import warm_up_state
from jointwear.monitor.reading.regimes import find_regimes
from jointwear.monitor.watching.decision import DOUBT, STEP_WINDOWS, TOLERATED, shift_evidence
from jointwear.monitor.watching.null_runs import JUDGED, Axis, _draws, _maxima, null_thresholds
from jointwear.monitor.watching.shared_error import SLOPE_SPREAD, _location, shared_error, units_of_levels
from jointwear.monitor.watching.shift_forecast import TOLD, forecast_shifts
from jointwear.monitor.watching.watching import outside_baseline

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


def test_left_out_residuals_are_those_of_a_fit_without_the_shift():
    random = np.random.default_rng(1)
    shift = np.repeat(np.arange(6), 10)
    x = np.stack([np.ones(60), random.standard_normal(60)], axis=1)
    y = x @ [0.3, 0.1] + 0.01 * random.standard_normal(60)
    noise, prior = Noise(np.full(60, 1e-4), 0.0, 1e-5), Posterior(np.zeros(2), np.eye(2))
    whole = fit_normal_state(x, y, noise, shift, prior)
    assert whole.posterior.mean == pytest.approx([0.3, 0.1], abs=0.01)
    rest = fit_normal_state(x, np.where(shift == 2, np.nan, y), noise, shift, prior)
    expected = y[shift == 2] - x[shift == 2] @ rest.posterior.mean
    assert whole.left_out[shift == 2] == pytest.approx(expected, abs=2e-3)


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


def evidence(
    level: np.ndarray,
    extra: float = 0.0,
    inside: bool = True,
    odd: np.ndarray | float = 0.0,
    known=1e-6,
    loud=1.0,
    calm=True,
    noise=1e-5,
    least=0.0,
):
    shift = np.repeat(np.arange(len(level)), 8)
    w = len(shift)
    windows = AxisWindows(
        value=np.repeat(level, 8)
        + np.tile(np.repeat([1, -1], 4), len(level)) * np.repeat(odd * np.ones(len(level)), 8),
        variance=np.full(w, noise),
        design=np.ones((w, 1)),
        which=np.zeros(w, dtype=int),
        shift=shift,
        between=np.full(w, START.between),
        extra=np.full(w, extra),
        inside=np.full(w, inside),
        scale=np.full(w, loud),
        calm=np.full(w, calm),
    )
    return shift_evidence(windows, [Posterior(np.zeros(1), np.full((1, 1), known))], START.memory, least)


def test_growth_and_falls_count_beyond_what_is_tolerated():
    """Of the mean of a steady growth over its error, what is tolerated is taken off; as much growth alone is none."""
    grown, fallen = evidence(np.full(6, 3 * TOLERATED)), evidence(np.full(6, -3 * TOLERATED))
    assert grown.mean[-1] == pytest.approx(3 * TOLERATED, rel=0.05)
    assert grown.growth[-1] == pytest.approx((grown.mean[-1] - TOLERATED) / grown.std[-1])
    assert fallen.fall[-1] == pytest.approx((-fallen.mean[-1] - TOLERATED) / fallen.std[-1])
    assert evidence(np.full(6, 0.99 * TOLERATED)).growth[-1] == -np.inf


def test_growth_on_which_nobody_has_to_act_yet_has_to_be_clearer():
    small, large = np.full(6, 0.015), np.full(6, 0.025)
    for level, times in ((small, DOUBT), (large, 1.0)):
        whole, counted = evidence(level), evidence(level, least=0.02)
        assert counted.growth[-1] == pytest.approx(whole.growth[-1] / times)
        np.testing.assert_array_equal(counted.fall, whole.fall)
    # Growth since the shifts before counts so as well, wherever it began.
    begun = np.array([-0.02] * 6 + [0.003] * 3)
    assert evidence(begun, least=0.02).step[-1] == pytest.approx(evidence(begun).step[-1])
    assert evidence(begun, least=0.03).step[-1] == pytest.approx(evidence(begun).step[-1] / DOUBT)


def test_a_large_step_in_weather_waits_for_a_second_shift():
    stepped = np.array([0, 0, 0, 0.05])
    assert np.isfinite(evidence(stepped).growth[-1])
    assert evidence(stepped, calm=False).growth[-1] == -np.inf
    twice = np.append(stepped, 0.05)
    assert np.isfinite(evidence(twice, calm=False).growth[-1])


def test_weather_that_lasts_is_not_averaged_away_and_a_fall_in_the_cold_proposes_nothing():
    grown, fallen = np.array([0, 0, 0.04, 0.04, 0.04, 0.04]), np.array([0, 0, -0.04, -0.04, -0.04])
    sure, unsure = evidence(grown), evidence(grown, extra=4e-4)
    assert unsure.growth[-1] < 0.5 * sure.growth[-1]
    assert unsure.std[-1] > 0.015
    assert evidence(fallen).fall[-1] > 2
    assert np.isneginf(evidence(fallen, inside=False).fall[-1])


def test_a_shift_in_which_the_other_axes_are_off_too_tells_less_of_an_axis():
    shift, windows = np.repeat(np.arange(6), 8), 48
    noise, variance = np.full((windows, 6), 1e-6), np.full((windows, 6), 1e-4)
    own = np.zeros((windows, 6))
    own[shift >= 4, 0] = 0.04
    inside, off = np.zeros(own.shape, dtype=bool), own.copy()
    off[shift == 5, 3:] = [0.025, -0.025, 0.03]
    quiet, loud = (shift_scale(r, variance, noise, np.full(6, 0.3), shift, inside) for r in (own, off))
    # Its own growth is no sign that the shift is off; that of one axis is hardly one for the others.
    assert np.all(quiet[:, 0] < 0.6)
    left = shift_scale(own, variance, noise, np.full(6, 0.3), shift, ~inside)
    assert np.allclose(left[:, 0], 1.0)
    assert np.all(quiet[-1, 1:] < 2.0)
    assert np.allclose(loud[shift == 4], quiet[shift == 4])
    assert np.all(loud[shift == 5, 0] > 1.5)
    # Axes that are not judged say nothing.
    unknown = np.where(np.arange(6) > 0, np.nan, own)
    assert np.allclose(shift_scale(unknown, variance, noise, np.full(6, 0.3), shift, inside)[:, 0], 1.0)
    grown = np.array([0, 0, 0.04, 0.04])
    assert np.isclose(evidence(grown, loud=4.0, noise=1e-12).growth[-1], 0.5 * evidence(grown, noise=1e-12).growth[-1])


def test_the_noise_of_windows_is_measured_and_follows_no_scale_of_the_shift():
    grown = np.array([0, 0, 0.04, 0.04])
    steady, usual, off = (evidence(grown, loud=loud, noise=0.1) for loud in (0.25, 1.0, 4.0))
    # The first windows of a shift tell little, however still the other axes keep.
    assert np.allclose(steady.std[16:], usual.std[16:], rtol=0.02)
    assert np.allclose(off.std[16:], usual.std[16:], rtol=0.02)
    assert steady.growth[-1] < 1.02 * usual.growth[-1]


def test_a_shift_in_which_all_axes_rose_is_beyond_what_the_baseline_saw():
    shift, beyond = np.repeat(np.arange(4), 3), np.zeros((12, 2))
    beyond[0, 1] = 1e-4
    outside = outside_baseline(beyond, np.repeat([0.0, 0.05, -0.05, 0.02], 3), shift)
    assert outside[0].tolist() == [False, True]
    assert outside[shift == 1].all()
    # A fall raises no alarm of growth, and what is no finding is weather as usual.
    assert not outside[1:3].any()
    assert not outside[shift >= 2].any()


def test_a_robot_that_stays_still_is_held_to_its_own_scale_and_wear_widens_none():
    shift = np.repeat(np.arange(20), 8)
    noise, variance = np.full((160, 6), 1e-4), np.full((160, 6), 2e-4)
    inside, memory = np.zeros((160, 1), bool), np.full(6, 0.3)
    still = shift_scale(np.zeros((160, 6)), variance, noise, memory, shift, inside)
    assert (np.diff(still[::8], axis=0) < 0).all()  # each shift that keeps still tells more
    worn = np.zeros((160, 6))
    worn[:, 2] = 0.002 * shift
    scale = shift_scale(worn, variance, noise, memory, shift, inside)
    assert np.allclose(scale[:, 2], still[:, 2])
    assert (scale[:, 0] >= still[:, 0]).all()
    # What comes later changes no earlier scale.
    later = worn.copy()
    later[120:] = 0.5
    assert np.allclose(shift_scale(later, variance, noise, memory, shift, inside)[:120], scale[:120])


def test_two_shifts_of_growth_are_evidence_and_one_small_one_is_none():
    assert evidence(np.array([0, 0, 0.04, 0.04])).growth[-1] > 2
    assert np.isneginf(evidence(np.array([0, 0, 0, 0.025])).growth[-1])
    assert np.isneginf(evidence(np.array([0, 0, -0.04, -0.04])).fall[-1])
    fall = evidence(np.array([0, 0, -0.04, -0.04, -0.04]))
    assert np.isneginf(fall.growth[-1])
    assert fall.fall[-1] > 2
    # A large step is told within its first shift.
    step = evidence(np.array([0, 0, 0, 0.1])).growth
    assert np.isfinite(step[-8 + STEP_WINDOWS - 1])
    assert np.isneginf(step[-8 + STEP_WINDOWS - 2])


def test_a_fall_that_is_over_by_its_third_shift_proposes_nothing():
    # A product on two of three shifts, as an example: the third lies just below normal by its noise.
    over = np.array([0, 0, -0.27, -0.27, -0.004])
    assert np.isneginf(evidence(over).fall[-1])
    assert np.isneginf(evidence(over[[0, 1, 2, 4, 3]]).fall[-1])
    # One that goes on slowly is a fall all the same.
    assert np.isfinite(evidence(-0.01 * np.arange(7)).fall[-1])


def test_friction_that_fell_before_does_not_hide_wear_that_begins_from_there():
    grown = np.array([*[-0.05] * 8, -0.01, 0.02, 0.03])
    told = evidence(grown)
    assert told.step[-1] > 2 * told.growth[-1]
    # What is not known of the normal state is the same before and after.
    unsure = evidence(grown, known=4e-4)
    assert unsure.growth[-1] < 0.5 * told.growth[-1]
    assert unsure.step[-1] > 0.9 * told.step[-1]
    # It must lie above the normal state, and above what went before.
    assert np.isneginf(evidence(grown - 0.03).step[-1])
    assert evidence(np.full(11, 0.02)).step[-1] < 0
    assert np.isneginf(evidence(grown[-4:]).step[-1])


def test_shifts_whose_windows_disagree_tell_less_and_so_do_those_after_them():
    level = np.array([0, 0, 0, 0.04, 0.04])
    sure = evidence(level)
    now, before = np.array([0, 0, 0, 0.05, 0.05]), np.array([0.05, 0.05, 0.05, 0, 0])
    assert evidence(level, odd=now).growth[-1] < 0.5 * sure.growth[-1]
    assert evidence(level, odd=before).growth[-1] < 0.5 * sure.growth[-1]
    # As much as their noise says is no disagreement.
    assert evidence(level, odd=0.003).growth[-1] == pytest.approx(sure.growth[-1], rel=0.02)


def test_one_worn_axis_is_no_shared_error():
    worn = np.zeros((100, 6))
    worn[50:, 2] = 0.1
    result = shared_error(worn, np.full((100, 6), 1e-4), np.arange(100) < 40, np.arange(100) // 10)
    assert np.abs(result.value[:, 2]).max() < 1e-3
    assert np.abs(result.value).max() < 0.01


def test_thicker_oil_moves_the_level_of_an_axis_with_much_viscous_friction_further():
    coulomb = np.array([0.85, 0.8, 0.75, 0.8, 0.7, 0.55])
    alone = np.array([False, False, True, True, False, True])
    unit = units_of_levels(coulomb, alone)
    assert np.median(unit) == pytest.approx(1.0)
    # Viscous friction that is held goes into a Coulomb level that is smaller than all friction.
    assert unit[3] == pytest.approx(unit[1] / 0.8)
    drift = np.zeros((100, 6))
    drift[50:] = 0.02 * unit + np.random.default_rng(3).normal(0, 5e-4, (50, 6))
    args = drift, np.full((100, 6), 1e-5), np.arange(100) < 40, np.arange(100) // 10
    mended, plain = (drift - shared_error(*args, unit=u).value for u in (unit, 1.0))
    assert np.abs(mended[50:60]).max() < 0.006
    # Held to one size for all axes, this one would look worn.
    assert plain[50:60, 5].min() > 0.014


def test_axes_that_leave_the_temperatures_of_the_baseline_together_are_moved_by_the_weather():
    cold = np.zeros((100, 6))
    cold[60:] = 0.02
    beyond = np.where(cold > 0, 0.02**2, 0.0)
    first, shift = np.arange(100) < 40, np.arange(100) // 10
    quiet = np.random.default_rng(2).normal(0, 1e-3, cold.shape)
    told = shared_error(cold + quiet, 1e-6 + beyond, first, shift, beyond)
    assert np.abs(told.value[60:] - 0.02).max() < 0.008
    # What is left may differ from axis to axis, and one that wears in the cold stands out.
    worn = cold + quiet
    worn[70:, 2] += 0.08
    alone = shared_error(worn, 1e-6 + beyond, first, shift, beyond)
    assert (worn - alone.value)[70:, 2].min() > 0.06
    assert np.abs((worn - alone.value)[70:, [0, 1, 3, 4, 5]]).max() < 0.02
    # Two axes cannot tell what they share: all of it stays unsure.
    two = shared_error(cold[:, :2], 1e-6 + beyond[:, :2], first, shift, beyond[:, :2])
    assert (two.value == 0).all()
    assert (two.variance[60:] > 0.5 * beyond[60:, :2]).all()


def test_warm_up_rises_in_operation_and_falls_at_rest():
    start = windows(2)
    state = warm_up_state(start, start + HOUR, np.ones((16, 1)), 2.0)[:, 0]
    assert (np.diff(state[:8]) > 0).all()
    assert state[8] < state[7]
    assert state.max() < 1.0


def test_programs_are_told_apart_and_an_unseen_one_is_said_so():
    first, second, third = np.zeros(6), np.full(6, 1.0), np.full(6, -1.0)
    signature = np.stack([*[first] * 10, *[second] * 10, *[third] * 3])
    regime = find_regimes(signature, np.arange(23) < 20)
    assert len(set(regime[:20])) == 2
    assert (regime[20:] == -1).all()
    # From the fourth window on it is a program of its own.
    longer = find_regimes(np.concatenate([signature, third[None]]), np.arange(24) < 20)
    assert np.array_equal(longer[:20], regime[:20])
    assert (longer[20:] == 2).all()
    mixed = np.random.default_rng(4).uniform(-3, 3, (20, 6))
    assert find_regimes(mixed, np.ones(20, dtype=bool)) is None


def test_a_later_program_near_a_known_one_is_no_part_of_it():
    random = np.random.default_rng(3)
    one, other = np.zeros(6), np.full(6, 1.0)
    baseline = np.arange(48) < 40
    # Windows differ by 0.03 about their program, and its neighbour is 0.22 away.
    signature = np.repeat([one, other, one], [20, 20, 8], axis=0) + 0.03 * random.uniform(-1, 1, (48, 6))
    signature[40:, 2] += 0.22
    regime = find_regimes(signature, baseline)
    assert set(regime[:40]) == {0, 1}
    assert (regime[40:] == 2).all()
    # Three of them may be windows of the known one that hold a part of its cycle, as may more that do not follow each
    # other, or that lie on both sides.
    assert (find_regimes(signature[:43], baseline[:43])[40:] == 0).all()
    apart = signature.copy()
    apart[[42, 45]] = one
    assert (find_regimes(apart, baseline)[40:] == 0).all()
    about = signature.copy()
    about[41::2, 2] -= 0.44
    assert (find_regimes(about, baseline)[40:] == 0).all()


def test_an_axis_without_a_torque_makes_no_new_program():
    speed = np.array([[1.0, 2.0, 0.5], [0.6, 0.7, 2.0]])
    hidden = np.zeros((28, 3), dtype=bool)
    hidden[20:, 1] = True
    which = np.array([0, 1] * 14)

    def told(logs):
        share = logs - np.nan_to_num(logs).mean(axis=1, keepdims=True)
        return np.concatenate([share, np.where(np.isnan(logs), np.nan, 0.2)], axis=1)

    logs = np.where(hidden, np.nan, np.log(speed[which]))
    baseline = np.arange(28) < 20
    regime = find_regimes(told(logs), baseline, hidden)
    assert np.array_equal(regime[20:], regime[:8])
    assert set(regime) == {0, 1}
    # At rest it is another program.
    assert not set(find_regimes(told(logs), baseline)[20:]) & {0, 1}
    # One that never shows a torque is like one that always rests.
    never = np.zeros((28, 3), dtype=bool)
    never[:, 1] = True
    logs = np.where(never, np.nan, np.log(speed[which]))
    assert np.array_equal(find_regimes(told(logs), baseline, never), find_regimes(told(logs), baseline))


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


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_runs_on_which_nothing_happens_alarm_as_often_as_is_allowed(share):
    axis = Axis(0.006, 0.2, 0.003, 0.002, 8).rounded()
    a_window = -np.log1p(-share) / (JUDGED * axis.windows)
    level, step = _maxima(axis)
    of_level, of_step = null_thresholds(axis, a_window)
    assert np.mean((level > of_level) | (step > of_step)) == pytest.approx(share, rel=0.1)


def test_shifts_of_null_runs_scatter_as_is_stated():
    drawn = _draws(8)
    assert np.std(drawn.fresh) == pytest.approx(1.0, rel=0.1)
    assert np.quantile(np.abs(drawn.fresh), 0.999) > 4.0


@pytest.mark.parametrize("memory", [0.0, 0.3, 0.9])
def test_the_mean_of_windows_that_remember_each_other_varies_as_the_sum_of_their_covariances(memory):
    for count in (1, 2, 8, 30):
        place = np.arange(count)
        covariance = memory ** np.abs(place[:, None] - place)
        assert inflated(count, memory) == pytest.approx(covariance.sum() / count)


def test_what_windows_scatter_beyond_their_noise_is_that_of_dersimonian_and_laird_less_what_chance_adds():
    starts, weight = np.arange(9) == 0, np.full(9, 1e4)

    def found(spread):
        error = np.sqrt(spread / 9 / 1e4) * np.array([1.5, -1.5, 1.5, -1.5, 0, 0, 0, 0, 0]) * np.sqrt(9 / (4 * 1.5**2))
        return _unexplained(error, weight, np.arange(1.0, 10.0), starts)[-1]

    # Of nine windows the sum has eight degrees of freedom and scatters by four.
    assert found(11.9) == 0.0
    assert found(20.0) == pytest.approx((20.0 - 8.0 - 4.0) / (9e4 - 9e8 / 9e4))


def test_where_axes_fall_into_two_camps_what_they_share_is_not_sure():
    variance = np.full((1, 5), 1e-4)
    one, two = (_location(np.array([x]), variance) for x in ([0.1] * 5, [0.1, 0.1, 0.1, 0.0, 0.0]))
    assert two[1][0] > 4 * one[1][0]
    assert two[1][0] > (np.mean([0.1, 0.1, 0.1, 0.0, 0.0]) - two[0][0]) ** 2


def test_what_is_taken_off_an_axis_is_as_unsure_as_its_slope_over_what_all_share():
    together = np.repeat(np.where(np.arange(60) < 40, 0.0, 0.1)[:, None], 6, axis=1)
    result = shared_error(together, np.full((60, 6), 1e-8), np.arange(60) < 40, np.arange(60) // 20)
    # Nothing had moved before that would tell the slopes of the axes.
    assert np.sqrt(result.variance[45]) == pytest.approx(SLOPE_SPREAD * 0.1, rel=0.1)
