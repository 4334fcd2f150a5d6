"""When an axis alarms: growth, falls and steps over its last shifts."""

import numpy as np
import pytest

from jointwear.monitor.normal.dispersion import (
    START,
)
from jointwear.monitor.normal.normal_state import Posterior
from jointwear.monitor.normal.recent_shifts import AxisWindows, _unexplained
from jointwear.monitor.normal.shift_scale import shift_scale
from jointwear.monitor.watching.decision import DOUBT, STEP_WINDOWS, TOLERATED, Evidence, shift_evidence
from jointwear.monitor.watching.falls import proposed


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


def test_growth_that_is_over_in_the_newest_shift_is_no_evidence_and_growth_that_lessens_is():
    """Three shifts of 2.4 % before a fourth that read +0.2 % had begun an alarm."""
    before = [0.024] * 3
    over, less = evidence(np.array([*before, 0.002])), evidence(np.array([*before, 0.016]))
    assert evidence(np.array(before)).growth[-1] > 2
    assert (over.growth[24:] == -np.inf).all()
    assert less.growth[-1] > 2


def test_a_fall_that_is_over_by_its_third_shift_proposes_nothing():
    # A product on two of three shifts, as an example: the third lies just below normal by its noise.
    over = np.array([0, 0, -0.27, -0.27, -0.004])
    assert np.isneginf(evidence(over).fall[-1])
    assert np.isneginf(evidence(over[[0, 1, 2, 4, 3]]).fall[-1])
    # One that goes on slowly is a fall all the same.
    assert np.isfinite(evidence(-0.01 * np.arange(7)).fall[-1])


def test_a_fall_waits_for_the_windows_of_its_third_shift():
    fall = evidence(np.array([0, 0, -0.04, -0.04, -0.04])).fall
    assert np.isfinite(fall[-8 + STEP_WINDOWS - 1])
    assert np.isneginf(fall[: -8 + STEP_WINDOWS - 1]).all()


def told_fall(fall, judged=None, shifts=3):
    """Evidence of a fall (w,) in windows that are `judged` (w,), all by default."""
    fall = np.asarray(fall, dtype=float)
    std = np.where(np.ones(len(fall), dtype=bool) if judged is None else judged, 0.01, np.inf)
    same = np.zeros(len(fall))
    return Evidence(same - np.inf, fall, same - np.inf, same, std, np.full(len(fall), shifts))


def test_a_service_is_proposed_by_whole_shifts_and_begins_where_the_first_judged_one_does():
    """Four services that never were came of the first windows of a third shift, which as a whole took the fall back."""
    shift, baseline = np.repeat(np.arange(6), 4), np.arange(24) < 4

    def begins(told, windows=24):
        found = proposed(told, 4.0, 8.0, shift[:windows], baseline[:windows])
        return found and (found[0], found[1].window)

    over = np.zeros(24)
    over[16:18] = 9.0
    assert begins(told_fall(over)) is None
    over[18:20] = 9.0
    assert begins(told_fall(over)) == (19, 8)
    # A shift that goes on tells by its windows so far.
    assert begins(told_fall(over[:19]), 19) == (18, 8)
    # The shifts that it rests on are judged ones.
    judged = (shift != 2) & (shift != 3)
    assert begins(told_fall(over, judged, shifts=2)) == (19, 4)
    assert begins(told_fall(over, np.zeros(24, dtype=bool))) is None


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


def test_what_windows_scatter_beyond_their_noise_is_that_of_dersimonian_and_laird_less_what_chance_adds():
    starts, weight = np.arange(9) == 0, np.full(9, 1e4)

    def found(spread):
        error = np.sqrt(spread / 9 / 1e4) * np.array([1.5, -1.5, 1.5, -1.5, 0, 0, 0, 0, 0]) * np.sqrt(9 / (4 * 1.5**2))
        return _unexplained(error, weight, np.arange(1.0, 10.0), starts)[-1]

    # Of nine windows the sum has eight degrees of freedom and scatters by four.
    assert found(11.9) == 0.0
    assert found(20.0) == pytest.approx((20.0 - 8.0 - 4.0) / (9e4 - 9e8 / 9e4))


def test_friction_that_dipped_and_came_back_is_no_growth():
    """A healthy axis alarmed at +0.4 % of its normal, as it had read -2 % in a cold spell."""
    dipped = np.array([*[-0.03] * 8, 0.004, 0.004, 0.004])
    # How far above normal it is, where what normal is is hardly known, nothing tells.
    assert evidence(dipped, known=1e-4).step[-1] == -np.inf
    assert evidence(dipped + np.where(dipped > 0, 0.02, 0.0), known=1e-4).step[-1] > 2
