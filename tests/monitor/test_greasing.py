"""Viscous friction that stands higher on all axes, while friction as a whole hardly rose: was the arm greased?"""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.findings.greasing import GREASED, LASTS, greasing_findings
from jointwear.monitor.presentation.overnight import greased_since, rose_alike, rose_overnight
from jointwear.monitor.presentation.to_answer import asks_for_answer

#: Twelve shifts of four windows, four of them the baseline, of five axes.
SHIFT = np.repeat(np.arange(12), 4)
BASELINE = SHIFT < 4


def watched(common):
    """What is watched of axes of which nothing is left beside what they have in common (shifts,)."""
    common = np.repeat(np.asarray(common, dtype=float), 4)
    value = np.repeat(common[:, None], 5, axis=1)
    return SimpleNamespace(residual=np.zeros_like(value), shared=SimpleNamespace(common=common, value=value))


def windows(temperature=np.nan):
    """Windows in which all axes have the temperatures (shifts,)."""
    temperature = np.broadcast_to(temperature, 12)
    given = np.repeat(temperature.astype(float), 4)[:, None] * np.ones(5)
    return SimpleNamespace(start=3600.0 * np.arange(len(SHIFT)), temperature=given)


def told(level, viscous, temperature=np.nan):
    statistics = windows(temperature)
    return greasing_findings(statistics, SHIFT, BASELINE, watched(level), watched(viscous), np.ones(5))


def since(shift, size):
    return np.where(np.arange(12) >= shift, size, 0.0)


def test_viscous_friction_of_all_axes_that_rose_and_kept_asks_for_the_service():
    (found,) = told(since(7, 0.06), since(7, 0.3))
    assert (found["kind"], found["axes"], found["time"]) == (GREASED, [1, 2, 3, 4, 5], 28 * 3600.0)
    assert "by about +30 %" in found["words"]
    assert "was the arm greased?" in found["words"]
    assert told(since(7, -0.05), since(7, 0.1))


#: What the weather does to viscous friction, shift by shift, and how much of it the level shows.
WEATHER, SHOWN = 0.03 * np.array([0, 1, -1, 2, 0, 1, -2, 1, 3, -2, 2, 0]), 0.2


def test_new_grease_takes_friction_at_low_speed_down_at_once_and_the_cold_never_does():
    # Worked soft over days, in a hall that warms up: what is left of the rise is no half of it.
    soft = WEATHER + since(7, 1.0) * 0.25 * 0.8 ** np.maximum(np.arange(12) - 7, 0)
    (found,) = told(SHOWN * soft - since(7, 0.06), soft)
    assert (found["time"], found["axes"], "unsure" in found) == (28 * 3600.0, [1, 2, 3, 4, 5], False)
    told_words = "and has kept, while friction at low speed fell with it: was the arm greased? Thicker grease does that"
    assert told_words in found["words"]
    assert asks_for_answer(found)
    cold = WEATHER + since(7, 0.25)
    (found,) = told(SHOWN * cold, cold)
    assert found["unsure"]
    assert "is the arm colder than in the normal period, or was the arm greased?" in found["words"]
    assert not asks_for_answer(found)
    # What sinks bit by bit is running-in, what fell without a rise of viscous friction a gain.
    assert told(SHOWN * WEATHER - 0.015 * np.maximum(np.arange(12) - 6, 0), WEATHER + since(9, 0.06)) == []
    assert told(SHOWN * WEATHER - since(7, 0.06), WEATHER) == []
    # Of two shifts nobody can say how friction goes with the weather.
    few = np.isin(SHIFT, (2, 3))
    statistics = windows()
    both = watched(SHOWN * soft - since(7, 0.06)), watched(soft)
    for watch in both:
        watch.residual[~few & BASELINE] = np.nan
    assert greasing_findings(statistics, SHIFT, BASELINE, *both, np.ones(5)) == []


@pytest.mark.parametrize(
    ("now", "words"),
    [
        (24.0, "show 4 K less than in the normal period, and what is normal allows for that: was the arm greased"),
        (28.0, "show no other temperature than in the normal period"),
        (np.nan, "is the arm colder than in the normal period, or was the arm greased?"),
    ],
)
def test_what_may_be_the_cold_is_asked_by_the_thermometers_that_are_logged(now, words):
    """A page asked to compare temperatures, of which it had those of all axes."""
    temperature = np.where(np.arange(12) >= 7, now, 28.0 + np.array([-1.0, 1.0] * 6))
    cold = WEATHER + since(7, 0.25)
    (found,) = told(SHOWN * cold, cold, temperature)
    assert found["unsure"]
    assert words in found["words"]
    assert ("ompare temperatures" in found["words"]) == np.isnan(now)
    (same,) = told(SHOWN * cold, cold, np.where(np.arange(12) >= 7, 24.0, 28.0))
    assert "ompare temperatures" in same["words"]


@pytest.mark.parametrize(
    ("level", "viscous"),
    [
        (since(7, 0.09), since(7, 0.15)),  # cold oil
        (since(7, 0.0), since(7, 0.03)),  # hardly any
        (since(7, 0.0), since(13 - LASTS, 0.3)),  # not for long
        (since(7, 0.0), since(7, 0.3) - since(11, 0.3)),  # over
        (since(7, 0.0), since(7, 0.0)),
        (since(7, 0.0), since(7, 0.3) - since(9, 0.2)),  # cold oil that goes, beside an axis that wears
    ],
)
def test_cold_oil_and_what_is_over_are_no_grease(level, viscous):
    assert told(level, viscous) == []


def test_nothing_is_told_of_a_robot_that_is_not_judged_yet():
    level, viscous = watched(np.zeros(12)), watched(since(7, 0.3))
    level.residual[:] = np.nan
    statistics = windows()
    assert greasing_findings(statistics, SHIFT, BASELINE, level, viscous, np.ones(5)) == []


def test_a_step_overnight_that_keeps_is_told_from_what_grows():
    day = 86400.0
    end = day * np.repeat(np.arange(12), 3) + 30000.0
    step, ramp = (np.repeat(x, 3) for x in (since(6, 18.0), 4.0 * np.maximum(np.arange(12) - 5, 0)))
    noise = np.random.default_rng(0).standard_normal(36)
    assert rose_overnight(end, step + noise, 8 * day)
    assert rose_overnight(end, np.where(np.arange(36) % 5, step, np.nan), 8 * day)
    assert rose_overnight(end, np.roll(step, 1) * (end > 3 * day) + noise, 8 * day)  # in the middle of a day
    assert not rose_overnight(end, ramp + noise, 8 * day)
    assert not rose_overnight(end, -step, 8 * day)
    assert not rose_overnight(end[:20], step[:20], 6.5 * day)
    assert not rose_overnight(end, np.full(36, np.nan), 8 * day)
    assert not rose_overnight(end[:0], step[:0], 8 * day)


def test_grease_that_is_worked_soft_is_told_by_the_coulomb_friction_that_fell_with_it():
    day = 86400.0
    end = day * np.repeat(np.arange(12), 3) + 30000.0
    soft = np.repeat(since(6, 40.0) * np.maximum(0.8 ** np.arange(-6.0, 6.0), 0.5), 3)
    noise = np.random.default_rng(0).standard_normal(36)
    fell = np.repeat(since(6, -3.0), 3) + noise
    assert rose_overnight(end, soft, 8 * day, fell)
    assert not rose_overnight(end, soft, 8 * day)
    assert not rose_overnight(end, soft, 8 * day, noise)
    assert not rose_overnight(end, soft, 8 * day, np.where(end > 6.5 * day, np.nan, fell))
    grows = np.repeat(4.0 * np.maximum(np.arange(12) - 5, 0), 3)
    assert not rose_overnight(end, grows, 8 * day, fell)


def test_both_kinds_that_rose_by_one_share_at_once_are_told_from_wear_of_both():
    day = 86400.0
    end = day * np.repeat(np.arange(12), 3) + 30000.0
    noise = np.random.default_rng(2).standard_normal((2, 36))
    step, ramp = (np.repeat(x, 3) for x in (since(6, 9.0), 2.0 * np.maximum(np.arange(12) - 5, 0)))
    assert rose_alike(end, step + 0.3 * noise[0], step + noise[1], 7 * day)
    assert not rose_alike(end, step + 0.3 * noise[0], noise[1], 7 * day)
    assert not rose_alike(end, step + 0.3 * noise[0], 2 * step + noise[1], 7 * day)
    assert not rose_alike(end, ramp + 0.3 * noise[0], ramp + noise[1], 9 * day)
    assert not rose_alike(end, step + 0.3 * noise[0], np.full(36, np.nan), 7 * day)
    # What rose over a weekend may have worn, and what went on rising has.
    weekend = end + 2 * day * (end > 6 * day)
    assert not rose_alike(weekend, step + 0.3 * noise[0], step + noise[1], 9 * day)
    later = step + np.repeat(since(8, 8.0), 3)
    assert not rose_alike(end, later + 0.3 * noise[0], later + noise[1], 7 * day)
    # Of one day alone nothing is said to have kept.
    assert not rose_alike(end[:21], step[:21], step[:21], 7 * day)


def test_a_fall_at_once_beside_viscous_friction_that_rose_is_grease_after_an_alarm_alone():
    day = 86400.0
    end = day * np.repeat(np.arange(12), 3) + 30000.0
    noise = 0.2 * np.random.default_rng(3).standard_normal((2, 36))
    grown = np.repeat(np.where(np.arange(12) < 8, 1.5 * np.arange(12), 3.0), 3)
    rose = np.repeat(since(8, 20.0), 3)
    assert greased_since(end, grown + noise[0], rose + noise[1], 4 * day)
    assert not greased_since(end, grown + noise[0], rose + noise[1], 9 * day)
    assert not greased_since(end, grown + noise[0], -rose + noise[1], 4 * day)
    assert not greased_since(end, np.repeat(1.5 * np.arange(12), 3) + noise[0], rose + noise[1], 4 * day)
    assert not greased_since(end[:0], grown[:0], rose[:0], 4 * day)
