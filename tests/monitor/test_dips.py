"""Friction that falls as far as it wanders, and what follows: it comes back, it wears, or somebody tells a service."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.findings.findings import DIP, _dips
from jointwear.monitor.normal.conditions import Conditions
from jointwear.monitor.normal.learning import learn_axes
from jointwear.monitor.normal.series import Series
from jointwear.monitor.watching.asked import Anew, Asked, Period
from jointwear.monitor.watching.falls import Dip, proposed
from jointwear.monitor.watching.watched_axis import Start
from jointwear.monitor.watching.watching import watch

#: Axes, days of a shift each, windows of each, days of the baseline, and that on which the first axis falls.
AXES, DAYS, PER, BASELINE, FALL = 4, 34, 6, 12, 16
#: A fall that is found, and which wander may be.
DIP_SIZE = 0.018


def seen(change: np.ndarray, services: tuple[int, ...] = ()):
    """What becomes of axes of which the first changes by `change` (DAYS - FALL,) from the fall on, `services` told."""
    rng = np.random.default_rng(1)
    shift = np.repeat(np.arange(DAYS), PER)
    w, flat = len(shift), np.ones((DAYS * PER, AXES))
    level = rng.normal(0, 0.003, (DAYS, AXES))[shift] + 0.006 * rng.standard_normal((w, AXES))
    level[shift >= FALL, 0] += np.repeat(change, PER)
    start = 86400.0 * shift + 3600.0 * (np.arange(w) % PER)
    conditions = Conditions(start, start + 3600.0, np.nan * flat, np.zeros((w, AXES, 5)), flat, np.zeros(w), None)
    baseline = shift < BASELINE
    series = Series(level, 4e-5 * flat, np.ones(AXES), np.ones(AXES))
    normal = learn_axes([series], ["friction"], conditions, np.repeat(baseline[:, None], AXES, axis=1), shift)
    events = [[s * PER for s in services], *[[]] * (AXES - 1)]
    return watch(normal, Period(conditions, baseline, shift), Asked(1e-3), Anew(events, [[]] * AXES, [[]] * AXES))


def course(*parts: tuple[float, float, int]) -> np.ndarray:
    """Return changes from the fall on, each part from one to another over so many days; the last one goes on."""
    days = np.concatenate([np.linspace(a, b, n) for a, b, n in parts])
    return np.concatenate([days, np.full(DAYS - FALL - len(days), days[-1])])


def first_alarm(found) -> int:
    """The day after the fall on which the first axis begins to alarm."""
    return int(np.flatnonzero(found.alarm[:, 0])[0]) // PER - FALL


@pytest.mark.parametrize("days", [4, 8])
def test_friction_that_dips_and_comes_back_is_no_wear(days):
    """What was learnt within the dip was normal, and the way back out of it an alarm of 3 % at more than 99 %."""
    found = seen(course((-DIP_SIZE, -DIP_SIZE, days), (-0.5 * DIP_SIZE, 0.0, 3)))
    assert not found.alarm.any()
    assert not found.starts[0]
    (dip,) = found.dips[0]
    assert dip.window // PER == FALL
    assert days < dip.back // PER - FALL <= days + 5
    # It is held against what was normal all along.
    assert np.nanmean(found.residual[-5 * PER :, 0]) == pytest.approx(0.0, abs=0.005)
    assert np.nanmean(found.residual[FALL * PER : dip.window + 3 * PER, 0]) == pytest.approx(-DIP_SIZE, abs=0.006)


def test_a_dip_that_lasts_is_asked_for_and_a_part_of_the_way_back_is_no_wear():
    found = seen(course((-DIP_SIZE, -DIP_SIZE, 8), (-0.5 * DIP_SIZE, -0.5 * DIP_SIZE, 1)))
    (start,) = found.starts[0]
    assert (start.window // PER, start.proposed, start.doubtful) == (FALL, True, True)
    assert not found.alarm.any()


def test_wear_after_a_fall_alarms_beyond_what_was_normal_before_or_once_the_service_is_told():
    worn = course((-DIP_SIZE, -DIP_SIZE, 6), (-DIP_SIZE, 0.1, 12))
    told, untold = seen(worn, (FALL,)), seen(worn)
    # Friction is back where it was nine days after the fall; of a service it has grown by three days more than that.
    assert 7 <= first_alarm(told) <= 9
    assert 9 <= first_alarm(untold) <= 12
    assert not told.dips[0]


def test_a_fall_that_is_rather_a_service_than_wander_is_learnt_from_whether_it_is_told_or_not():
    worn = course((-0.16, -0.16, 6), (-0.16, -0.04, 12))
    told, untold = seen(worn, (FALL,)), seen(worn)
    (start,) = untold.starts[0]
    assert (start.window // PER, start.doubtful) == (FALL, False)
    assert abs(first_alarm(untold) - first_alarm(told)) <= 1
    assert first_alarm(untold) <= 9


def test_a_fall_is_doubtful_unless_the_shifts_that_show_it_exceed_more_than_wander_does():
    evidence = SimpleNamespace(std=np.ones(40), shifts=np.full(40, 3), fall=np.where(np.arange(40) < 15, 0.0, 5.0))
    shift, baseline = np.repeat(np.arange(10), 4), np.arange(40) < 4
    assert proposed(evidence, 4.0, 6.0, shift, baseline) == (15, Start(4, True, doubtful=True))
    assert proposed(evidence, 4.0, 4.5, shift, baseline) == (15, Start(4, True))
    # What has gone again proposes nothing, and what falls later begins after it.
    assert proposed(evidence, 4.0, 6.0, shift, baseline, [Dip(4, 17)]) == (19, Start(18, True, doubtful=True))


def test_a_dip_is_told_with_its_end_and_asks_for_nothing():
    statistics = SimpleNamespace(start=3600.0 * np.arange(40), end=3600.0 * np.arange(1, 41), dated=False)
    level = SimpleNamespace(starts=[[]], dips=[[Dip(8, 19)]])
    (found,) = _dips(statistics, level)
    assert (found["time"], found["axes"], found["kind"]) == (8 * 3600.0, [1], DIP)
    assert found["words"].startswith("Friction of axis 1 fell and was back at what was normal before by 20 h: friction")
    level.starts = [[Start(30, False)]]
    assert _dips(statistics, level)[0]["answered"]
