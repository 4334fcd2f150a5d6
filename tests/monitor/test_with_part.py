"""An alarm that soon follows a part asks for the part first."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.measurement.flags import Flag
from jointwear.monitor.events import Event
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.condition import CHANGED, AxisCondition
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.presentation.standing import axis_row
from jointwear.monitor.presentation.with_part import asked_of_part, less_explained_since
from jointwear.monitor.presentation.words import todo
from jointwear.monitor.watching.records import DETECTORS

HOUR = 3600.0
DAY = 24 * HOUR
PART = {"time": 10 * DAY, "axes": [], "kind": "program", "words": "", "moved": [2, 4], "judged": True}


def asked(axis, first, findings=(PART,), events=()):
    """What is asked first of a 1-based axis that alarmed at `first` [s]."""
    episode = Episode(axis, "coulomb friction", DETECTORS[0], ({"time": first, "change": 0.2, "unit": "N m"},), None)
    state = windows(findings)
    return asked_of_part(state, axis - 1, (episode,), events), episode


def windows(findings=(), less=lambda end: np.zeros_like(end, dtype=bool)):
    """Hourly windows of 12 days and four axes; `less`: of which of them the model explains less on axis 4."""
    start = np.arange(12 * 24) * HOUR
    flags = np.zeros((len(start), 4), dtype=int)
    flags[less(start + HOUR), 3] = int(Flag.UNEXPLAINED)
    count = np.full(flags.shape, 100)
    return SimpleNamespace(findings=list(findings), dated=True, start=start, end=start + HOUR, flags=flags, count=count)


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


@pytest.mark.parametrize(
    ("less", "since"),
    [
        (lambda end: end > 9 * DAY, 9 * DAY),
        # A part on every second hour.
        (lambda end: (end > 9 * DAY) & (end // HOUR % 2 == 0), 9 * DAY + HOUR),
        (lambda end: (end > 9 * DAY) & (end // HOUR % 3 == 0), None),
        (lambda end: end > 7 * DAY, None),
        (lambda end: end > 10 * DAY, None),
        (lambda end: end > 10 * DAY - HOUR, None),
        (lambda end: np.zeros_like(end, dtype=bool), None),
    ],
)
def test_an_alarm_with_which_the_model_came_to_explain_less_asks_for_the_load(less, since):
    """Wear leaves as much of the torque as before, whatever size friction has; a load on some moves does not."""
    state = windows(less=less)
    assert less_explained_since(state, 3, 10 * DAY) == since
    assert less_explained_since(state, 2, 10 * DAY) is None
    episode = Episode(4, "viscous friction", DETECTORS[0], ({"time": 10 * DAY, "change": 5.0, "unit": "%"},), None)
    told = asked_of_part(state, 3, (episode,), ())
    assert bool(told) == (since is not None)
    if since:
        assert told.startswith("does it carry another part or tool since about 1970-01-10T0")
        assert asked_of_part(state, 3, (episode,), [Event(9.5 * DAY, (), "program")]) == ""
        assert asked_of_part(state, 3, (episode,), [Event(2.0 * DAY, (), "program")])


def test_an_axis_that_did_not_move_before_says_nothing():
    state = windows(less=lambda end: end > 9 * DAY)
    state.count[: 9 * 24, 3] = 0
    assert less_explained_since(state, 3, 10 * DAY) is None
