"""Programs whose baseline shifts miss the prediction by more than their errors tell."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.findings.seen_growth import MISSED, missed_findings
from jointwear.monitor.normal.conditions import Conditions
from jointwear.monitor.normal.dispersion import ShiftMeans
from jointwear.monitor.normal.learning import learn_axes
from jointwear.monitor.normal.missed import missed_variance, with_missed, with_scatter
from jointwear.monitor.normal.series import Series
from jointwear.monitor.presentation.to_answer import ASKING
from jointwear.monitor.watching.asked import Asked, Period
from jointwear.monitor.watching.watched_axis import UNSEEN, WatchedAxis
from jointwear.monitor.watching.watching import watch

SHIFTS, PER, FIRST = 16, 10, 6
SHIFT = np.repeat(np.arange(SHIFTS), PER)
#: A fifth of the windows of each shift run program 1.
PROGRAM = np.tile(np.arange(PER) >= 8, SHIFTS).astype(int)
BASELINE = SHIFT < FIRST


def of_axes(scatter, seed=0):
    """The normal states of three axes; program 1 of the first differs by `scatter` from shift to shift."""
    rng, w = np.random.default_rng(seed), SHIFTS * PER
    value = 0.005 * rng.standard_normal((w, 3))
    signs = np.where(np.arange(SHIFTS) % 2, 1.0, -1.0)
    value[:, 0] += np.where(PROGRAM, scatter * signs[SHIFT], 0.0)
    start, flat = 3600.0 * np.arange(w), np.ones((w, 3))
    conditions = Conditions(start, start + 3600.0, np.nan * flat, np.zeros((w, 3, 5)), flat, np.zeros(w), PROGRAM, True)
    series = Series(value, 0.005**2 * flat, np.ones(3), np.ones(3))
    axes = learn_axes([series], ["viscous"], conditions, np.repeat(BASELINE[:, None], 3, axis=1), SHIFT)
    return axes, conditions


def test_a_program_that_differs_from_shift_to_shift_is_not_judged_and_the_others_are():
    axes, conditions = of_axes(0.3)
    loose = [with_missed(axis, PROGRAM, SHIFT) for axis in axes]
    assert loose[0].missed == pytest.approx(0.36, abs=0.1)
    assert loose[1].missed < 0.02
    later = ~BASELINE
    result = watch(loose, Period(conditions, BASELINE, SHIFT), Asked(1e-3))
    assert result.unseen[later & (PROGRAM == 1), 0].all()
    assert not result.unseen[later & (PROGRAM == 0), 0].any()
    assert not result.unseen[:, 1].any()
    assert not watch(axes, Period(conditions, BASELINE, SHIFT), Asked(1e-3)).unseen.any()


def test_a_program_that_errs_as_expected_stays_as_it_is():
    axis = of_axes(0.0)[0][0]
    same = with_missed(axis, None, SHIFT)
    assert same.missed == 0.0
    assert np.array_equal(same.design.beyond, axis.design.beyond)


def test_what_is_missed_beside_the_errors():
    errors = np.full(4, 0.01**2)
    assert missed_variance(ShiftMeans(np.zeros(0), np.zeros(0)), 0.01) == 0.0
    assert missed_variance(ShiftMeans(np.full(4, 0.01), errors), 0.0) == 0.0
    assert missed_variance(ShiftMeans(np.full(4, 0.3), errors), 0.0) == pytest.approx(0.3**2, rel=0.01)
    assert missed_variance(ShiftMeans(np.full(4, 0.3), errors), 0.3) < 0.1**2


def missing(*sizes):
    """A watch of axes whose shifts miss the prediction by that much, None where no normal is known."""
    return SimpleNamespace(axes=[None if s is None else SimpleNamespace(missed=s) for s in sizes])


def test_axes_whose_viscous_friction_differs_are_told_in_one_sentence():
    hours, first = SimpleNamespace(end=3600.0 * np.arange(1, 9)), np.arange(8) < 4
    (told,) = missed_findings(hours, first, missing(0.0, 0.11, None, 0.5))
    assert (told["axes"], told["time"], told["kind"]) == ([2, 4], 4 * 3600.0, MISSED)
    assert told["words"].startswith(
        "Viscous friction of axes 2 and 4 can only be judged coarsely: in the normal period"
    )
    assert "up to 50 %" in told["words"]
    assert not missed_findings(hours, first, missing(UNSEEN, None))
    assert MISSED not in ASKING


@pytest.mark.parametrize(("proposed", "learnt"), [(True, [4, 5, 6]), (False, [0, 1, 2])])
def test_a_proposed_service_is_learnt_at_temperatures_of_the_baseline(proposed, learnt):
    """A cold spell of four shifts, a little outside the baseline, taught a level that a normal hall lay above."""
    axis = WatchedAxis.__new__(WatchedAxis)
    axis.shift = np.repeat(np.arange(8), 4)
    axis.normal = SimpleNamespace(
        series_value=np.zeros(32), design=SimpleNamespace(beyond=np.where(axis.shift < 4, 0.003**2, 0.0))
    )
    assert np.unique(axis.shift[axis._after(0, 32, proposed)]).tolist() == learnt


def test_windows_of_a_program_that_scatter_more_count_for_less_in_it_alone():
    rng, w = np.random.default_rng(1), SHIFTS * PER
    program = np.tile(np.arange(PER) >= 7, SHIFTS).astype(int)
    value = 0.005 * rng.standard_normal((w, 3))
    value[:, 0] += np.where(program == 1, 0.2 * rng.standard_normal(w), 0.0)
    start, flat = 3600.0 * np.arange(w), np.ones((w, 3))
    conditions = Conditions(start, start + 3600.0, np.nan * flat, np.zeros((w, 3, 5)), flat, np.zeros(w), program, True)
    series = Series(value, 0.005**2 * flat, np.ones(3), np.ones(3))
    axes = learn_axes([series], ["coulomb"], conditions, np.repeat(BASELINE[:, None], 3, axis=1), SHIFT)
    loose, same = (with_scatter(axes[j], program, SHIFT) for j in (0, 1))
    more = loose.series_variance - axes[0].series_variance
    assert (more[program == 1] > 0.05**2).all()
    assert not more[program == 0].any()
    assert np.array_equal(same.series_variance, axes[1].series_variance)
    assert with_scatter(axes[0], None, SHIFT) is axes[0]
