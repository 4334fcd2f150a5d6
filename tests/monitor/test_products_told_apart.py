"""Products that the baseline lacks are told by what the regression leaves of several axes; wear of one axis is none."""

import numpy as np
import pytest
from monitor_windows import residuals, statistics_of

from jointwear.monitor.normal.products import _other_load, product_findings, with_products
from jointwear.monitor.normal.series import Series

#: Windows, and those of a shift; the first four shifts are the baseline.
WINDOWS, SHIFT = 64, 8
SHIFTS = np.arange(WINDOWS) // SHIFT
BASELINE = SHIFTS < 4


def month(axes=(), factor=1.0, since=48):
    """Windows of three axes, of which some are `factor` times as loud from a window on."""
    s = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 3))
    s.residual_square[since:, list(axes)] *= factor**2
    return s


def bodies(*steps, error=0.02):
    """Log of the size of the bodies of three axes, window by window; `steps` as (shifts, what they are there)."""
    value = np.random.default_rng(5).normal(0.0, error, (WINDOWS, 3))
    for shifts, step in steps:
        value[np.isin(SHIFTS, shifts)] += step
    return Series(value, np.full(value.shape, error**2), np.ones(3), np.ones(3))


def asked(s, regime=None, scale=None):
    return with_products(s, bodies() if scale is None else scale, regime, SHIFTS, BASELINE)


@pytest.mark.parametrize("factor", [0.6, 1.5])
def test_two_axes_that_change_at_once_tell_a_product(factor):
    s = month((0, 2), factor)
    program, (product,) = asked(s)
    np.testing.assert_array_equal(program == product.program, np.arange(WINDOWS) >= 48)
    assert product.axes == (1, 3)
    (found,) = product_findings(s, program, (product,), np.arange(WINDOWS) >= 56)
    assert (found["time"], found["kind"]) == (48 * 3600.0, "program")
    assert "axes 1 and 3" in found["words"]
    assert "after 8 h" in found["words"]


@pytest.mark.parametrize(("axes", "factor"), [((1,), 1.6), ((0, 2), 1.1), ((), 1.0)])
def test_one_axis_or_a_small_change_is_no_product(axes, factor):
    assert asked(month(axes, factor)) == (None, ())


@pytest.mark.parametrize(("windows", "told"), [(1, 0), (3, 1)])
def test_an_hour_or_two_of_a_new_program_say_not_what_is_usual_in_it(windows, told):
    """One hour in which a load was found stood for the program, and a shift in which it was not for another part."""
    s, place = month(), np.arange(WINDOWS)
    regime = (place >= 40 - windows).astype(int)
    # Loud in six hours of eight, in another order each shift.
    loud = (place >= 40) & ((place + SHIFTS) % 4 > 0)
    s.residual_square[loud] *= 2.0**2
    assert len(asked(s, regime)[1]) == told


@pytest.mark.parametrize(("windows", "told"), [(1, 0), (2, 0), (3, 1)])
def test_one_or_two_windows_tell_no_product(windows, told):
    """Of two, one in which a load was not found makes half of the median."""
    s = month((0, 2), 1.5, WINDOWS - windows)
    shift = np.where(np.arange(WINDOWS) >= WINDOWS - windows, SHIFTS.max() + 1, SHIFTS)
    _, products = with_products(s, bodies(), None, shift, BASELINE)
    assert len(products) == told


def test_two_windows_of_a_product_that_came_before_are_of_it():
    s = month()
    s.residual_square[32:40, [0, 2]] *= 1.5**2
    s.residual_square[-2:, [0, 2]] *= 1.5**2
    shift = np.where(np.arange(WINDOWS) >= WINDOWS - 2, SHIFTS.max() + 1, SHIFTS)
    program, (product,) = with_products(s, bodies(), None, shift, BASELINE)
    np.testing.assert_array_equal(program == product.program, (SHIFTS == 4) | (shift == SHIFTS.max() + 1))


def test_windows_at_a_speed_that_the_baseline_lacks_tell_no_product():
    """What changes with the speed has a column of its own in the normal state."""
    s, late = month((0, 2), 1.5), np.arange(WINDOWS) >= 48
    assert with_products(s, bodies(), None, SHIFTS, BASELINE, late) == (None, ())
    assert len(with_products(s, bodies(), None, SHIFTS, BASELINE, late & (SHIFTS == 6))[1]) == 1


def test_a_shift_with_two_known_products_in_turn_is_no_third_one():
    """Its medians lie between both, farther from each than what tells a product."""
    s, turn = month(), np.isin(np.arange(WINDOWS), [48, 50, 52, 54])
    s.residual_square[(SHIFTS == 4) | turn] *= np.array([2.0, 1.0, 2.0]) ** 2
    program, (product,) = asked(s)
    np.testing.assert_array_equal(program == product.program, (SHIFTS == 4) | turn)


def test_axes_within_a_wide_range_are_not_beyond_it():
    s = month((1,), 1.6)
    for shift, factor in ((0, 0.5), (1, 2.0), (2, 0.5), (3, 2.0)):  # products of the baseline, by axes 1 and 3
        s.residual_square[shift * SHIFT : (shift + 1) * SHIFT, [0, 2]] *= factor**2
    _, products = asked(s)
    assert products == ()


def test_a_product_of_the_baseline_is_known_again():
    s = month((0, 2), 1.5)
    for shift in (1, 2):
        s.residual_square[shift * SHIFT : (shift + 1) * SHIFT, [0, 2]] *= 1.5**2
    program, products = asked(s)
    assert products == ()
    assert [int(program[shift * SHIFT]) for shift in range(8)] == [0, 1, 1, 0, 0, 0, 1, 1]


def test_one_loud_shift_of_the_baseline_is_scatter():
    s = month((0, 2), 1.5)
    s.residual_square[8:16, [0, 2]] *= 1.5**2
    assert asked(s) == (None, ())


def test_parts_that_take_turns_within_a_shift_are_none_that_the_baseline_lacks():
    s = month()
    s.residual_square[::3, [0, 2]] *= 2.0**2  # one window in three with a heavy part, then a shift with it in most
    s.residual_square[49:55:2, [0, 2]] *= 2.0**2
    assert asked(s) == (None, ())


def test_one_loud_window_of_the_baseline_hides_no_product():
    s = month((0, 2), 1.5)
    s.residual_square[11, [0, 2]] *= 3.0**2
    _, products = asked(s)
    assert len(products) == 1


def test_each_program_has_products_of_its_own():
    regime = np.arange(WINDOWS) % 2
    program, products = asked(month((0, 2), 1.5), regime)
    assert [p.program for p in products] == [2, 3]
    np.testing.assert_array_equal(program[:48], regime[:48])
    np.testing.assert_array_equal(program[48:], 2 + regime[48:])


@pytest.mark.parametrize(("factor", "told"), [(0.4, 1), (2.2, 1), (1.4, 0)])
def test_a_program_that_the_baseline_lacks_gets_a_part_that_its_first_shift_did_not_have(factor, told):
    """Bodies below what tells another load, noise of twice as much: it became viscous friction of one axis."""
    program, products = asked(month((0, 2), factor, since=56), np.where(SHIFTS < 6, 0, 1))
    assert len(products) == told
    assert {int(p) for p in program[48:56]} == {1}
    assert ({int(p) for p in program[56:]} == {1}) == (told == 0)


def test_products_that_come_again_are_one_and_others_another():
    s = month()
    for shift, factor in ((4, 1.5), (5, 2.4), (6, 1.5)):
        s.residual_square[shift * SHIFT : (shift + 1) * SHIFT, [0, 2]] *= factor**2
    program, products = asked(s)
    assert [p.program for p in products] == [1, 2]
    assert [int(program[shift * SHIFT]) for shift in range(8)] == [0, 0, 0, 0, 1, 2, 1, 0]


def test_bodies_of_two_axes_that_differ_tell_a_product():
    program, (product,) = asked(month(), scale=bodies(([6, 7], (0.05, 0.2, 0.4))))
    np.testing.assert_array_equal(program == product.program, SHIFTS >= 6)
    assert product.axes == (2, 3)


@pytest.mark.parametrize("step", [(0.0, 0.0, 0.4), (0.3, 0.3, 0.3), (0.3, 0.3, 0.0), (0.1, 0.16, 0.2)])
def test_a_gain_of_one_axis_or_of_most_is_no_product(step):
    """Nor is what no axis shows by a quarter."""
    assert asked(month(), scale=bodies(([6, 7], step))) == (None, ())


@pytest.mark.parametrize(
    ("step", "load"),
    [
        ((0.3, 0.3, np.nan, np.nan, np.nan), False),
        ((0.3, 0.3, 0.0, 0.0, 0.0), True),
        ((0.3, np.nan, np.nan, np.nan, np.nan), False),
        ((np.nan,) * 5, False),
    ],
)
def test_bodies_that_are_not_known_do_not_count_as_ones_that_stayed(step, load):
    assert _other_load(np.array(step)) == load


def test_products_of_which_nothing_is_known_alike_are_two():
    """Of one shift the noise alone is known, of the next one the bodies alone."""
    s, scale = month((0, 2), 1.5), bodies(([7], (0.05, 0.2, 0.4)))
    s.residual_square[56:] = 0.0
    scale.value[48:56] = np.nan
    program, products = asked(s, scale=scale)
    assert [p.program for p in products] == [int(program[48]), int(program[56])] == [1, 2]


def test_bodies_that_are_hardly_known_tell_nothing():
    assert asked(month(), scale=bodies(([6, 7], (0.05, 0.2, 0.4)), error=0.3)) == (None, ())


def test_a_single_day_of_the_baseline_with_another_load_is_known_again():
    """As of a robot whose first day of ten had a light part (fleet 25): its friction was that of the heavy one."""
    program, products = asked(month(), scale=bodies(([0, 5], (0.05, 0.2, 0.4))))
    assert products == ()
    assert [int(program[shift * SHIFT]) for shift in range(8)] == [1, 0, 0, 0, 0, 1, 0, 0]


def test_a_program_that_the_baseline_lacks_has_products_of_its_own():
    """By the load alone: what is usual of its noise one shift does not tell."""
    regime = np.where(SHIFTS >= 5, 1, 0)
    program, (product,) = asked(month((0, 2), 1.5, 56), regime, bodies(([6], (0.05, 0.2, 0.4))))
    assert [int(program[shift * SHIFT]) for shift in range(8)] == [0] * 5 + [1, product.program, 1]
