"""Alarms of a robot that was monitored: whose they are, their file, their episodes, and what may explain them."""

import csv
from dataclasses import replace

import pytest
from monitor_logs import START
from monitor_states import WORN, changed

from jointwear.measurement.timestamps import stamp
from jointwear.monitor.events import Event, events_of
from jointwear.monitor.judging.state import ALARM_COLUMNS, read_state, write_alarms
from jointwear.monitor.presentation.condition import axis_conditions
from jointwear.monitor.presentation.episodes import episodes_of
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import standing
from jointwear.monitor.watching.records import _is_news, _Told


def test_the_worn_axis_alarms_and_nothing_else(monitored):
    folder, _, _ = monitored
    rows = list(csv.DictReader((folder / "alarms.csv").read_text().splitlines()))
    assert rows
    assert tuple(rows[0]) == ALARM_COLUMNS
    ours = [row for row in rows if row["detector"] == "model"]
    assert {row["axis"] for row in ours} == {str(WORN + 1)}
    assert ours[0]["time"].startswith("2026-01-0")
    assert ours[0]["time"].endswith("Z")
    assert float(ours[0]["probability_axis"]) > 0.9


def test_alarms_of_the_papers_detector_decide_nothing_and_are_shown(monitored, tmp_path):
    """Parts and programs change histograms: five healthy robots of 26 were to be looked at for nothing else."""
    folder, _, _ = monitored
    stored = read_state(folder / "state.nc")
    model = replace(stored, alarms=stored.counted)
    both = replace(model, alarms=[*model.alarms, *changed(model, "torque histogram", detector="paper").compared])
    assert len(both.compared) == 1
    assert axis_conditions(both) == axis_conditions(model)
    assert standing(both) == standing(model)
    write_page(both, tmp_path / "index.html", tmp_path / "figures")
    text = (tmp_path / "index.html").read_text()
    assert "1 alarm of the paper's detector, for comparison" in text


@pytest.mark.parametrize(
    ("last", "now", "news"),
    [
        (_Told(0.0, True, 0.03), _Told(23.0, True, 0.200), False),
        (_Told(0.0, True, 0.03), _Told(24.0, True, 0.035), False),
        (_Told(0.0, True, 0.03), _Told(24.0, True, 0.041), True),
        (_Told(0.0, True, 0.03, again=True), _Told(24.0, True, 0.045), False),
        (_Told(0.0, True, 0.03, again=True), _Told(24.0, True, 0.051), True),
        (_Told(0.0, True, 0.03, again=True), _Told(168.0, True, 0.030), True),
        (_Told(0.0, False, 0.03), _Told(24.0, True, 0.010), True),
        (_Told(0.0, True, 0.03), _Told(24.0, False, 0.200), False),
    ],
)
def test_an_alarm_is_told_again_where_its_growth_goes_on(last, now, news):
    assert _is_news(last, now, 0.01) is news


def test_alarms_of_one_story_are_one_episode():
    def alarm(time, axis=1, detector="model"):
        return {"time": time, "axis": axis, "quantity": "coulomb friction", "detector": detector}

    rows = [alarm(1.0), alarm(2.0), alarm(9.0), alarm(3.0, axis=2), alarm(4.0, detector="other")]
    grease = {"time": 5.0, "axes": [1], "kind": "service", "note": "grease"}
    found = episodes_of(rows, events_of({"events": [grease]}), 1.0)
    assert [(e.axis, e.detector, len(e.alarms), e.resolved is None) for e in found] == [
        (1, "model", 1, True),
        (2, "model", 1, True),
        (1, "other", 1, False),
        (1, "model", 2, False),
    ]
    assert found[0].before.note == found[2].resolved.note == "grease"
    assert len({e.key for e in found}) == 4


def test_an_event_that_closes_nothing_changes_no_name_of_an_episode():
    rows = [{"time": time, "axis": 1, "quantity": "coulomb friction", "detector": "model"} for time in (3.0, 9.0)]
    closing = {"time": 5.0, "axes": [1], "kind": "service"}
    for idle in ([], [{**closing, "time": 1.0}], [{**closing, "time": 6.0}], [{**closing, "axes": [2], "time": 8.0}]):
        found = episodes_of(rows, events_of({"events": [closing, *idle]}), 1.0)
        assert [e.key for e in found] == ["1|coulomb friction|model|1", "1|coulomb friction|model|"]
    (whole,) = episodes_of(rows, events_of({"events": [{**closing, "time": 1.0}]}), 1.0)
    assert (whole.key, whole.before) == ("1|coulomb friction|model|", None)


@pytest.mark.parametrize(("time", "closed"), [(6.9, False), (7.0, False), (7.1, True), (8.0, True), (8.1, True)])
def test_an_event_within_the_window_of_an_alarm_closes_it(time, closed):
    """What is new begins with the next window; the page had kept an alarm open that no later event could close."""
    rows = [{"time": 8.0, "axis": 1, "quantity": "coulomb friction", "detector": "model"}]
    (found,) = episodes_of(rows, [Event(time, (0,), "service")], 1.0)
    assert (found.resolved is not None) is closed


def test_another_program_resolves_no_wear():
    rows = [{"time": time, "axis": 1, "quantity": "coulomb friction", "detector": "model"} for time in (1.0, 9.0)]
    gripper = {"time": 5.0, "kind": "program", "note": "another gripper"}
    found = episodes_of(rows, events_of({"events": [gripper]}), 1.0)
    assert [(len(e.alarms), e.resolved is None) for e in found] == [(2, True)]
    assert found[0].before is None


def test_unknown_values_of_an_alarm_stay_empty(tmp_path):
    alarm = dict.fromkeys(ALARM_COLUMNS, float("nan")) | {
        "time": 7200.0,
        "axis": 2,
        "quantity": "x",
        "detector": "paper",
    }
    write_alarms(tmp_path / "a.csv", [alarm | {"unit": ""}], False)
    assert (tmp_path / "a.csv").read_text().splitlines()[1] == "7200,2,x,,,,,,,,,,,,,,paper"


def test_times_as_text():
    assert stamp(START, True) == "2026-01-01T00:00:00Z"
    assert stamp(START + 0.25, True) == "2026-01-01T00:00:00.250Z"
    assert stamp(3600.0, False) == "3600"
