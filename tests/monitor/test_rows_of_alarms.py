"""A row of alarms.csv says what was known at its window, whatever later logs show; a limit keeps its date."""

from __future__ import annotations

import csv
from dataclasses import replace
from datetime import UTC

import numpy as np
import pytest
from monitor_windows import SETTINGS, VISCOUS, motion, residuals, statistics_of

from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.state import ALARM_COLUMNS, _limit_variables, _limits, write_alarms
from jointwear.monitor.presentation.condition import CHANGED, AxisCondition
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.presentation.standing import axis_row
from jointwear.monitor.presentation.words import outlook_words
from jointwear.monitor.watching.limits import COULOMB as COULOMB_FRICTION
from jointwear.monitor.watching.limits import VISCOUS as VISCOUS_FRICTION
from jointwear.monitor.watching.limits import LimitDate

BASELINE, COUNT = 120, 320
HOUR = 3600.0


@pytest.fixture(scope="module")
def both_kinds():
    """Windows of three axes: Coulomb friction of the first grows and stops, then its viscous friction does."""
    place = np.arange(COUNT)
    growth, viscous = np.zeros((COUNT, 3)), np.zeros((COUNT, 3))
    growth[:, 0] = np.clip((place - 130) * 8e-4, 0, 0.05)
    viscous[:, 0] = np.clip((place - 190) * 6e-3, 0, None)
    extra = (viscous * VISCOUS)[:, None] * motion()[..., 2]
    return statistics_of(residuals(COUNT, growth, 31, extra))


def rows_until(statistics, stop):
    found = judge(statistics.part(slice(0, stop)), BASELINE, SETTINGS)
    return sorted(found.alarms, key=lambda a: (a["time"], a["axis"], a["detector"]))


@pytest.mark.long
def test_rows_of_the_first_windows_are_the_first_rows(both_kinds):
    """Judged day by day a row went from 339 to 474 and 258 h, and "coulomb friction" of five rows to "viscous"."""
    whole = rows_until(both_kinds, COUNT)
    assert {a["quantity"] for a in whole if a["detector"] == "model"} == {COULOMB_FRICTION, VISCOUS_FRICTION}
    for stop in (170, 205, 230, 261, 290):
        first = rows_until(both_kinds, stop)
        then = [a for a in whole if a["time"] <= both_kinds.end[stop - 1]]
        assert len(first) == len(then)
        for one, other in zip(first, then, strict=True):
            words = [{k: v for k, v in row.items() if isinstance(v, (str, int))} for row in (one, other)]
            assert words[0] == words[1]
            numbers = [[v for v in row.values() if isinstance(v, float)] for row in (one, other)]
            np.testing.assert_allclose(*numbers, rtol=1e-6)


def test_a_row_tells_the_growth_of_the_day_before():
    """A mean over the shifts that alarmed, as the rows told, was half of their growth behind: 22.4 % (21.4 to 23.4) of
    29.5, beside a page with 28.9."""
    grown = np.zeros((COUNT, 3))
    grown[:, 0] = np.clip((np.arange(COUNT) - 130) * 1e-3, 0.0, None)
    statistics = statistics_of(residuals(COUNT, grown, 31))
    rows = [a for a in rows_until(statistics, COUNT) if a["detector"] == "model"]
    assert len(rows) > 3
    for row in rows[1:]:
        k = int(np.searchsorted(statistics.end, row["time"]))
        assert row["growth_percent"] == pytest.approx(100 * grown[k - 23 : k + 1, 0].mean(), abs=0.8)


def test_a_row_says_whose_limit_its_hours_are_to(both_kinds, tmp_path):
    """A row of Coulomb friction said 26 h: those to the limit of viscous friction, which nothing named."""
    rows = [a for a in rows_until(both_kinds, COUNT) if a["detector"] == "model"]
    other = [a for a in rows if a["quantity"] == COULOMB_FRICTION and a["limited_by"] == VISCOUS_FRICTION]
    assert other
    write_alarms(tmp_path / "alarms.csv", rows, dated=False)
    with open(tmp_path / "alarms.csv", newline="") as file:
        table = list(csv.DictReader(file))
    assert tuple(table[0]) == ALARM_COLUMNS
    assert [line["limited_by"] for line in table] == [a["limited_by"] for a in rows]


def test_today_may_know_an_alarm_by_another_name(both_kinds):
    """The row stays; what to check follows what is known by now."""
    alarm = {"time": 0.0, "change": 0.5, "unit": "N m", "probability_axis": 1.0}
    episode = Episode(1, COULOMB_FRICTION, "model", (alarm,), None)
    told = AxisCondition(
        1, "joint_1", CHANGED, 3.0, 1.0, 20.0, None, (episode,), (), {VISCOUS_FRICTION: 0.8}, 25.0, 2.0,
        grown=VISCOUS_FRICTION,
    )  # fmt: skip
    assert (told.quantity, told.change, told.unit) == (VISCOUS_FRICTION, 0.8, "N m s/rad")
    assert "lubricant" in told.check
    assert told.reached
    assert judge(both_kinds, BASELINE, SETTINGS).grown[0] == VISCOUS_FRICTION


def test_the_date_of_a_limit_does_not_move_while_an_axis_rests():
    """An axis that rested was given a limit on 8 February, and a fortnight of logs later one on the 22nd."""
    limit = LimitDate(COULOMB_FRICTION, 100 * HOUR, 40 * HOUR, 300 * HOUR)
    alarm = {"time": 0.0, "change": 0.5, "unit": "N m", "probability_axis": 1.0}
    episode = Episode(1, COULOMB_FRICTION, "model", (alarm,), None)
    told = AxisCondition(1, "joint_1", CHANGED, 9.0, 1.0, 20.0, limit, (episode,), ())
    where = {"dated": True, "last_sample": 0.0}
    words = {outlook_words(where | {"last_sample": h * HOUR}, axis_row(told, h * HOUR), UTC) for h in (0, 30, 60, 99)}
    assert words == {"limit around Mon 1970-01-05 (Fri 1970-01-02 to Tue 1970-01-13)"}
    assert axis_row(told, 60 * HOUR)["hours"] == [40.0, 0.0, 240.0]
    assert outlook_words(where, axis_row(told, 200 * HOUR), UTC) == "limit may be reached by now"
    # A limit that came by the forecast alone is not told as reached.
    viscous = replace(limit, quantity=VISCOUS_FRICTION)
    row = axis_row(AxisCondition(1, "", CHANGED, np.nan, np.nan, 20.0, viscous, (episode,), ()), 400 * HOUR)
    assert outlook_words(where, row, UTC) == "limit of viscous friction (+20 %) may be reached by now"


def test_the_file_of_a_state_keeps_the_date_of_a_limit():
    end = 1_767_225_600.0
    limits = (LimitDate(COULOMB_FRICTION, end - 9 * HOUR, end - 99 * HOUR, np.inf), None)
    kept = {name: variable.values for name, variable in _limit_variables(limits, end).items()}
    assert kept["hours_to_limit"][0] == -9
    read = _limits({**kept, "end": np.array([0.0, end])}.get)
    assert [(limit.quantity, limit.median, limit.low, limit.high) for limit in read[:1]] == [
        (COULOMB_FRICTION, end - 9 * HOUR, end - 99 * HOUR, np.inf)
    ]
    assert read[1] is None
