"""An alarm that soon follows a part asks for the part first."""

from types import SimpleNamespace

import pytest

from jointwear.monitor.events import Event
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.condition import CHANGED, AxisCondition
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.presentation.standing import axis_row
from jointwear.monitor.presentation.with_part import asked_of_part
from jointwear.monitor.presentation.words import todo
from jointwear.monitor.watching.records import DETECTORS

HOUR = 3600.0
DAY = 24 * HOUR
PART = {"time": 10 * DAY, "axes": [], "kind": "program", "words": "", "moved": [2, 4], "judged": True}


def asked(axis, first, findings=(PART,), events=()):
    """What is asked first of a 1-based axis that alarmed at `first` [s]."""
    episode = Episode(axis, "coulomb friction", DETECTORS[0], ({"time": first, "change": 0.2, "unit": "N m"},), None)
    state = SimpleNamespace(findings=list(findings), dated=True)
    return asked_of_part(state, axis - 1, (episode,), events), episode


def test_an_alarm_after_a_part_names_the_part_first():
    part, episode = asked(4, 10 * DAY + 5 * HOUR)
    told = AxisCondition(4, "joint4", CHANGED, 8.5, 1.0, 20.0, None, (episode,), (), part=part)
    assert told.check.startswith("was a part or tool put on at about 1970-01-11T00:00Z? The torque of axes 2 and 4")
    assert "label" in told.check
    assert told.check.endswith("whether a brake drags")
    row = {"dated": True, "last_sample": 12 * DAY}
    assert "at about 1970-01-11 01:00 CET?" in todo(row, axis_row(told, 12 * DAY), zone_of("Europe/Berlin"))["check"]


@pytest.mark.parametrize(
    ("axis", "first", "findings", "events"),
    [
        (3, 10 * DAY + HOUR, [PART], []),
        (4, 10 * DAY - HOUR, [PART], []),
        (4, 13 * DAY, [PART], []),
        (4, 10 * DAY + HOUR, [{**PART, "moved": [1]}, {"time": 10 * DAY, "axes": [], "kind": "program"}], []),
        (4, 10 * DAY + HOUR, [PART], [Event(9.5 * DAY, (), "program")]),
    ],
)
def test_other_axes_other_times_and_a_program_that_was_entered_ask_for_none(axis, first, findings, events):
    assert asked(axis, first, findings, events)[0] == ""


def test_a_program_long_before_is_not_that_of_the_part():
    assert asked(4, 10 * DAY + HOUR, events=[Event(3 * DAY, (), "program")])[0]
