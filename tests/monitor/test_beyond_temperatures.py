"""Axes that have left the temperatures of the baseline for good are judged once shifts have taught what that does."""

import numpy as np
import pytest

from jointwear.monitor.normal.conditions import BEYOND, COMMON_OF_TEMPERATURE, LASTING, Conditions, design_of
from jointwear.monitor.normal.learning import learn_axes
from jointwear.monitor.normal.normal_state import Posterior
from jointwear.monitor.normal.series import Series
from jointwear.monitor.watching.asked import Anew, Asked, Period
from jointwear.monitor.watching.watching import watch

#: Axes, shifts, windows of each, those of the baseline, and the first shift in the heat.
AXES, DAYS, PER, FIRST, HOT = 5, 36, 8, 10, 13
SHIFT = np.repeat(np.arange(DAYS), PER)
HOUR = np.tile(np.arange(PER) + 0.5, DAYS)
BASELINE = SHIFT < FIRST


def conditions_of(warmer, seed=1):
    """Conditions of axes that warm up by 9 K a day in a hall that is `warmer` (s,) [K]."""
    rng, flat = np.random.default_rng(seed), np.ones((len(SHIFT), AXES))
    hall = 24 + warmer + rng.normal(0, 1.5, DAYS)
    temperature = (hall[SHIFT] + 9 * (1 - np.exp(-HOUR / 2.5)))[:, None] + 0.15 * rng.standard_normal(flat.shape)
    start = 86400.0 * SHIFT + 3600.0 * HOUR
    return Conditions(start, start + 3600.0, temperature, np.zeros((*flat.shape, 5)), flat, np.zeros(len(SHIFT)), None)


def watched(size, worn=None, events=(), seed=1):
    """What is watched of a robot whose hall is `size` [K] warmer from the shift `HOT` on.

    Parameters
    ----------
    worn : shift from which axis 2 wears, by 18 % in ten shifts. events : shifts that begin after one of all axes.
    """
    rng = np.random.default_rng(seed)
    conditions = conditions_of(np.where(np.arange(DAYS) < HOT, 0.0, size))
    # Two fifths of the friction are viscous, and fall by 2.5 % per K.
    level = np.log(0.6 + 0.4 * np.exp(-0.025 * (conditions.temperature - 30)))
    level += rng.normal(0, 0.003, (DAYS, AXES))[SHIFT] + 0.006 * rng.standard_normal(level.shape)
    if worn is not None:
        level[:, 1] += 0.18 * np.clip((SHIFT - worn) / 10, 0, 1)
    flat = np.ones(level.shape)
    series = Series(level, 4e-5 * flat, flat[0], flat[0])
    normal = learn_axes([series], ["friction"], conditions, np.repeat(BASELINE[:, None], AXES, axis=1), SHIFT)
    return watch(normal, Period(conditions, BASELINE, SHIFT), Asked(1e-3), Anew([[s * PER for s in events]] * AXES))


@pytest.mark.parametrize("events", [(), (HOT,)])
def test_axes_in_a_heat_that_stays_are_judged_and_healthy(events):
    """A fifth of their windows was, for good, also after an event that began a new normal."""
    found = watched(20.0, events=events)
    assert np.isfinite(found.residual[SHIFT >= DAYS - 10]).mean() > 0.95
    assert not found.alarm.any()
    assert not found.unseen[SHIFT < HOT].any()


def test_wear_in_the_heat_is_found_and_told_as_it_is():
    found = watched(20.0, worn=18)
    hits = np.flatnonzero(found.alarm[:, 1])
    assert len(hits)
    assert 18 <= SHIFT[hits[0]] <= 30
    assert not np.delete(found.alarm, 1, axis=1).any()
    assert np.nanmean(found.residual[SHIFT >= 30, 1]) == pytest.approx(0.18, abs=0.05)


def test_a_design_has_bends_on_the_sides_that_later_windows_reach():
    usual, hot = (
        design_of(conditions_of(np.where(np.arange(DAYS) < HOT, 0.0, t)), 0, BASELINE, None) for t in (0.0, 20.0)
    )
    above = hot.matrix[:, hot.alike[-1]]
    assert not above[BASELINE].any()
    assert (above[SHIFT >= HOT] > 5).all()
    # A priori nothing more and nothing less is known than before any shift has taught anything.
    scale = np.diag(hot.prior.covariance)[[hot.alike[-1], hot.alike[-1] + 1]]
    assert scale.sum() == pytest.approx((1 - LASTING) * BEYOND**2)
    assert scale[0] == pytest.approx(COMMON_OF_TEMPERATURE * scale.sum())
    late = SHIFT >= HOT + 2
    assert (hot.besides[late] < hot.beyond[late]).all()
    assert (len(usual.alike), len(hot.alike)) == (2, 1)
    assert set(hot.alike) <= set(hot.thermal)


def test_what_is_not_known_once_some_coefficients_are():
    root = np.random.default_rng(0).normal(size=(5, 5))
    posterior = Posterior(np.arange(5.0), root @ root.T)
    rest = posterior.given([1, 3])
    assert np.allclose(rest.covariance[[1, 3]], 0)
    own = np.linalg.inv(np.linalg.inv(posterior.covariance)[np.ix_([0, 2, 4], [0, 2, 4])])
    assert np.allclose(rest.covariance[np.ix_([0, 2, 4], [0, 2, 4])], own)
    assert posterior.given(()) is posterior
