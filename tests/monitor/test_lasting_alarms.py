"""Alarms that last are told once in a while, those after a repair at once."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.watching.backlash import REPEAT_HOURS, backlash_records, raised_status
from jointwear.monitor.watching.lasting_alarms import is_open, told_windows
from jointwear.monitor.watching.watched_axis import Start

HOURS = 240
SERVICE, PROGRAM = Start(70, proposed=False), Start(70, proposed=False, kept=True)
FALL = Start(70, proposed=True)


def play(start):
    """What is watched of one axis whose play alarms in hours 20 to 59, and 120 to 169, after `start`."""
    alarm = np.zeros((HOURS, 1), dtype=bool)
    alarm[20:60] = alarm[120:170] = True
    mean = np.where(alarm, np.log(1.6), 0.0)
    return SimpleNamespace(alarm=alarm, mean=mean, mean_std=np.full((HOURS, 1), 0.05), starts=[[start]])


@pytest.mark.parametrize(("start", "told"), [(SERVICE, [20, 120]), (FALL, [20, 120]), (PROGRAM, [20])])
def test_play_that_comes_back_after_a_repair_is_told_at_once(start, told):
    """It was swallowed until a week after the alarm before the repair."""
    statistics = SimpleNamespace(axes=1, end=3600.0 * np.arange(HOURS))
    rows = backlash_records(statistics, play(start))
    assert [row["time"] / 3600 for row in rows] == told


@pytest.mark.parametrize(("start", "status"), [(SERVICE, "healthy"), (FALL, "changed"), (PROGRAM, "changed")])
def test_what_repairs_closes_and_nothing_else_does(start, status):
    found = raised_status(np.full((HOURS, 1), "healthy", dtype=object), play(start), "changed")
    assert (found[30, 0], found[80, 0], found[-1, 0]) == ("changed", status, "changed")


def test_an_alarm_that_lasts_is_told_again_where_it_is_news():
    alarm = np.ones(400, dtype=bool)
    seen = []

    def news(last, now, again):
        seen.append(again)
        return now - last >= REPEAT_HOURS

    assert np.flatnonzero(told_windows(alarm, [], news)).tolist() == [0, 168, 336]
    assert (seen[0], seen[-1]) == (False, True)
    assert is_open(np.array([False, True, False, False]), [Start(3, proposed=False)]).tolist() == [0, 1, 1, 0]
