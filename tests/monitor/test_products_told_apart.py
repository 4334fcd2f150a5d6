"""Products that the baseline lacks are told by what the regression leaves of several axes; wear of one axis is none."""

import numpy as np
import pytest
from monitor_windows import residuals, statistics_of

from jointwear.monitor.normal.products import product_findings, with_products

#: Windows, and those of a shift; the first four shifts are the baseline.
WINDOWS, SHIFT = 64, 8
SHIFTS = np.arange(WINDOWS) // SHIFT
BASELINE = SHIFTS < 4


def month(axes=(), factor=1.0, since=48):
    """Windows of three axes, of which some are `factor` times as loud from a window on."""
    s = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 3))
    s.residual_square[since:, list(axes)] *= factor**2
    return s


def asked(s, regime=None):
    return with_products(s, regime, SHIFTS, BASELINE)


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


def test_each_program_has_products_of_its_own():
    regime = np.arange(WINDOWS) % 2
    program, products = asked(month((0, 2), 1.5), regime)
    assert [p.program for p in products] == [2, 3]
    np.testing.assert_array_equal(program[:48], regime[:48])
    np.testing.assert_array_equal(program[48:], 2 + regime[48:])


def test_products_that_come_again_are_one_and_others_another():
    s = month()
    for shift, factor in ((4, 1.5), (5, 2.4), (6, 1.5)):
        s.residual_square[shift * SHIFT : (shift + 1) * SHIFT, [0, 2]] *= factor**2
    program, products = asked(s)
    assert [p.program for p in products] == [1, 2]
    assert [int(program[shift * SHIFT]) for shift in range(8)] == [0, 0, 0, 0, 1, 2, 1, 0]
