"""What came before the baseline is history: it is shown, and neither alarms nor asks nor teaches."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.monitor.events import Event
from jointwear.monitor.findings.thermometers import broken, other_unit, stuck
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.reading.after_baseline import after_baseline, before_baseline

#: Windows before the baseline, and where it ends.
BEFORE, END, COUNT = 48, 168, 300
BASELINE = (np.arange(COUNT) >= BEFORE) & (np.arange(COUNT) < END)


def windows(before: float, axes: int = 1, wear: float = 0.0):
    """Windows whose friction differs before the baseline, of the first `axes`; that of the first grows after it."""
    growth = np.zeros((COUNT, 3))
    growth[:BEFORE, :axes] = before
    growth[END + 20 :, 0] = wear
    return statistics_of(residuals(COUNT, growth, 13))


def test_what_lies_before_within_and_after():
    mask = np.array([False, True, False, True, False, False])
    assert after_baseline(mask).tolist() == [False, False, False, False, True, True]
    # What arrived late for the time of the baseline is not known to be healthy either.
    assert before_baseline(mask).tolist() == [True, False, True, False, False, False]
    assert after_baseline(np.zeros(3, dtype=bool)).all()
    assert not after_baseline(np.ones(3, dtype=bool)).any()
    assert len(after_baseline(np.zeros(0, dtype=bool))) == 0


@pytest.mark.long
@pytest.mark.parametrize("axes", [1, 3])
@pytest.mark.parametrize("before", [-0.3, -0.1, 0.0, 0.25])
def test_friction_before_the_baseline_changes_no_judgement(before, axes):
    statistics = windows(before, axes, wear=0.2)
    whole = judge(statistics, BASELINE, SETTINGS)
    alone = judge(statistics.part(slice(BEFORE, None)), END - BEFORE, SETTINGS)
    assert min(a["time"] for a in whole.alarms) > statistics.end[END]
    told = [[(a["time"], a["axis"], a["quantity"]) for a in one.alarms] for one in (whole, alone)]
    assert told[0] == told[1]
    assert len(told[0])
    assert [f["kind"] for f in whole.findings] == [f["kind"] for f in alone.findings]
    np.testing.assert_array_equal(whole.status[BEFORE:], alone.status)
    assert [limit and limit.quantity for limit in whole.limits] == [limit and limit.quantity for limit in alone.limits]
    hours = [[limit.hours_from(statistics.end[-1]) for limit in one.limits if limit] for one in (whole, alone)]
    np.testing.assert_allclose(*hours, rtol=0.02)
    # It is shown all the same.
    shown = whole.estimates["coulomb_percent"][:BEFORE, 0]
    assert np.nanmedian(shown) == pytest.approx(100 * before, abs=3)


@pytest.mark.long
def test_an_event_at_the_begin_of_the_baseline_is_asked_for_by_nobody():
    statistics = windows(0.25)
    event = Event(time=float(statistics.start[BEFORE]), kind="service", axes=(0,))
    for events in ((), (event,)):
        found = judge(statistics, BASELINE, replace(SETTINGS, events=events))
        assert not found.alarms
        assert [f["kind"] for f in found.findings] == ["backlash"]


def test_thermometers_before_the_baseline_are_no_news():
    statistics = windows(0.0)
    temperature = 30 + 5 * np.random.default_rng(1).random(statistics.temperature.shape)
    temperature[:BEFORE] = 20 + 273.15
    statistics = replace(statistics, temperature=temperature)
    assert not stuck(statistics, BASELINE).any()
    assert not other_unit(statistics, BASELINE)
    assert not broken(statistics, BASELINE)
