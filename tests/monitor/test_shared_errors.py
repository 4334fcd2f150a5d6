"""What all axes of a shift have in common, and how far off a shift is by the others."""

import numpy as np
import pytest

from jointwear.monitor.normal.conditions import COMMON_OF_TEMPERATURE
from jointwear.monitor.normal.shift_scale import own_scale, shift_scale
from jointwear.monitor.watching.shared_error import SLOPE_SPREAD, _location, shared_error, units_of_levels
from jointwear.monitor.watching.watching import outside_baseline


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


def test_growth_is_held_to_no_scale_below_that_of_the_axis_in_its_baseline():
    """Scatters of the others that are estimated too wide made sound axes alarm."""
    shift = np.repeat(np.arange(20), 8)
    noise, variance = np.full((160, 6), 1e-4), np.full((160, 6), 2e-4)
    memory, baseline = np.full(6, 0.3), shift < 10
    lively = np.zeros((160, 6))
    lively[:, 2] = 0.014 * (-1.0) ** shift
    scale = own_scale(lively, variance, noise, memory, shift, baseline)
    assert scale[2] == 1.0
    assert (np.delete(scale, 2) < 0.4).all()
    # What comes after the baseline counts for nothing.
    lively[80:] = 0.5
    assert np.allclose(own_scale(lively, variance, noise, memory, shift, baseline), scale)
    assert np.allclose(own_scale(lively, variance, noise, memory, shift, shift < 0), 1.0)


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
    alike = COMMON_OF_TEMPERATURE * beyond
    told = shared_error(cold + quiet, 1e-6 + beyond, first, shift, alike)
    assert np.abs(told.value[60:] - 0.02).max() < 0.008
    # What is left may differ from axis to axis, and one that wears in the cold stands out.
    worn = cold + quiet
    worn[70:, 2] += 0.08
    alone = shared_error(worn, 1e-6 + beyond, first, shift, alike)
    assert (worn - alone.value)[70:, 2].min() > 0.06
    assert np.abs((worn - alone.value)[70:, [0, 1, 3, 4, 5]]).max() < 0.02
    # Two axes cannot tell what they share: all of it stays unsure.
    two = shared_error(cold[:, :2], 1e-6 + beyond[:, :2], first, shift, alike[:, :2])
    assert (two.value == 0).all()
    assert (two.variance[60:] > 0.5 * beyond[60:, :2]).all()


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
