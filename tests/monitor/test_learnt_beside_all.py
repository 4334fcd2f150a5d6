"""An axis that is learnt anew after a service is learnt beside what all axes have in common, no level of its own."""

import numpy as np
import pytest

from jointwear.monitor.normal.conditions import Conditions
from jointwear.monitor.normal.learning import learn_axes
from jointwear.monitor.normal.series import Series
from jointwear.monitor.watching.asked import Anew, Asked, Period
from jointwear.monitor.watching.watching import watch

#: Axes, shifts, windows of each, those of the baseline, and the first one after the service of axis 2.
AXES, SHIFTS, PER, FIRST, SERVICE = 6, 40, 8, 12, 18
SHIFT = np.repeat(np.arange(SHIFTS), PER)
BASELINE = SHIFT < FIRST


def seen(own, common, services, seed=1):
    """What is watched of a robot at one false alarm in 1,000 h.

    Parameters
    ----------
    own : (s, n) growth of each axis by shifts, log level. common : (s,) what all have in common.
    services : for each axis the shifts that begin after a service that was told.
    """
    rng, w = np.random.default_rng(seed), SHIFTS * PER
    level = (own + common[:, None] + 0.003 * rng.standard_normal(own.shape))[SHIFT]
    level += 0.004 * rng.standard_normal(level.shape)
    start, flat = 3600.0 * np.arange(w), np.ones((w, AXES))
    conditions = Conditions(start, start + 3600.0, np.nan * flat, np.zeros((w, AXES, 5)), flat, np.zeros(w), None)
    series = Series(level, 0.004**2 * flat, np.ones(AXES), np.ones(AXES))
    axes = learn_axes([series], ["friction"], conditions, np.repeat(BASELINE[:, None], AXES, axis=1), SHIFT)
    events = [[s * PER for s in one] for one in services]
    return watch(axes, Period(conditions, BASELINE, SHIFT), Asked(1e-3), Anew(events))


def told(axis=1, at=SERVICE):
    return [[at] if j == axis else [] for j in range(AXES)]


def shifts(begin, end, size):
    """`size` in the shifts from `begin` to before `end`, (s,)."""
    return np.where((np.arange(SHIFTS) >= begin) & (np.arange(SHIFTS) < end), size, 0.0)


def served(fall=0.1, at=SERVICE):
    own = np.zeros((SHIFTS, AXES))
    own[at:, 1] -= fall
    return own


@pytest.mark.parametrize("services", [told(), [[]] * AXES])
def test_a_service_in_a_warm_spell_is_no_growth_when_it_ends(services):
    """The level was learnt with the 6 % that all axes lacked, which then looked like growth of 6 %."""
    result = seen(served(), shifts(16, 26, -0.06), services)
    assert result.starts[1][0].window == SERVICE * PER
    assert not result.alarm.any()
    assert abs(np.nanmean(result.residual[SHIFT >= 28, 1])) < 0.01
    # While it lasts, how far an axis follows the others is not sure.
    assert np.isfinite(result.residual[(SHIFT > 21) & (SHIFT < 26), 1]).all()


@pytest.mark.parametrize("spell", [0.0, -0.06])
def test_growth_after_a_service_is_found_and_told_as_it_is(spell):
    own = served()
    own[28:, 1] += 0.15
    result = seen(own, shifts(16, 26, spell), told())
    found = np.flatnonzero(result.alarm[:, 1])
    assert SHIFT[found[0]] in (28, 29)
    assert not np.delete(result.alarm, 1, axis=1).any()
    assert np.nanmean(result.residual[SHIFT >= 28, 1]) == pytest.approx(0.15, abs=0.015)


def test_a_worn_axis_is_no_part_of_what_another_is_learnt_beside():
    own = served()
    own[14:, 4] += 0.15
    result = seen(own, np.zeros(SHIFTS), told())
    assert abs(np.nanmean(result.residual[SHIFT >= 22, 1])) < 0.01


def test_axes_that_are_learnt_anew_together_are_told_no_error_of_what_nobody_tells():
    every = [[SERVICE]] * AXES
    own = np.repeat(served()[:, 1:2], AXES, axis=1)
    own[28:, 1] += 0.15
    result = seen(own, shifts(16, 26, -0.06), every)
    assert SHIFT[np.flatnonzero(result.alarm[:, 1])[0]] in (28, 29)
    assert not np.delete(result.alarm, 1, axis=1).any()


@pytest.mark.long
def test_axes_that_are_learnt_anew_one_after_the_other_do_not_drift():
    """Each is learnt beside the others, which were learnt beside it."""
    rounds = [list(range(13 + 4 * (j % 3), SHIFTS - 4, 12)) for j in range(AXES)]
    means = []
    for seed in range(6):
        result = seen(np.zeros((SHIFTS, AXES)), np.zeros(SHIFTS), rounds, seed)
        means.append(np.nanmean((result.residual + result.shared.value)[SHIFT >= SHIFTS - 3], axis=0))
    assert np.abs(np.mean(means)) < 0.003
    assert np.sqrt(np.mean(np.square(means))) < 0.008
