"""Axes after an alarm or an event: what explains an alarm, and what is known of growth from then on."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_states import WORN, changed, with_estimates

from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.local_time import log_time, zone_of
from jointwear.monitor.presentation.condition import UNRESOLVED, axis_conditions
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import NOTHING, standing
from jointwear.monitor.presentation.summaries import axis_summary, headline
from jointwear.monitor.presentation.words import todo
from jointwear.monitor.watching.records import CHANGED, UNJUDGED, Reason


def greased(state, entry_of):
    """The state after the friction came back, with what the config says of it."""
    status = state.status.copy()
    status[-1, WORN] = "healthy"
    return replace(state, status=status, entry=state.entry | entry_of)


def test_an_axis_that_is_back_to_normal_heads_no_red_card(monitored):
    folder, _, _ = monitored
    state = with_estimates(changed(read_state(folder / "state.nc"), "coulomb friction"), coulomb_percent=0.1)
    assert axis_conditions(state)[0].level == CHANGED
    back = replace(state, back=np.arange(state.axes) == 0)
    found = axis_conditions(back)[0]
    assert (found.level, found.limited) == (UNRESOLVED, None)
    assert found.check.startswith("friction is back to normal, and nobody has said why")
    play = axis_conditions(replace(changed(state, "backlash"), back=back.back))[0]
    assert play.check.startswith("play is back to normal")
    # Neither status nor alarms are touched.
    assert (back.status[-1, 0], len(back.alarms)) == (CHANGED, 1)


def test_an_axis_with_alarms_that_nobody_explained_is_never_green(monitored):
    folder, _, _ = monitored
    state = greased(read_state(folder / "state.nc"), {})
    found = axis_conditions(state)[WORN]
    assert found.level == UNRESOLVED
    assert "nobody has said why" in found.check
    assert axis_summary(state, WORN)["badge"] == "close"
    heading, sentences = headline([axis_summary(state, j) for j in range(state.axes)])
    assert heading == "Alarms that nobody has explained: axis 3"
    assert "No change: axes 1, 2, 4 and 5." in sentences


@pytest.mark.parametrize(
    ("event", "level"),
    [
        ({"time": "2027-01-01T00:00:00Z", "axes": [3], "kind": "service"}, "healthy"),
        ({"time": "2027-01-01T00:00:00+01:00", "kind": "acknowledged"}, "healthy"),
        ({"time": "2027-01-01T00:00:00Z", "axes": [2], "kind": "service"}, UNRESOLVED),
        ({"time": "2026-01-01T00:00:00Z", "axes": [3], "kind": "service"}, UNRESOLVED),
    ],
)
def test_an_event_of_the_axis_after_its_alarms_explains_them(monitored, event, level):
    folder, _, _ = monitored
    state = greased(read_state(folder / "state.nc"), {"events": [event]})
    found = axis_conditions(state)[WORN]
    assert found.level == level
    assert bool(found.past) == (level == "healthy")


def test_an_axis_is_not_green_because_another_program_was_entered(monitored):
    folder, _, _ = monitored
    event = {"time": "2027-01-01T00:00:00Z", "kind": "program", "note": "another gripper"}
    found = axis_conditions(greased(read_state(folder / "state.nc"), {"events": [event]}))[WORN]
    assert found.level == UNRESOLVED
    assert [e.detector for e in found.episodes] == ["model"]
    assert "nobody has said why" in found.check


@pytest.mark.parametrize(("kind", "level"), [("service", UNJUDGED), ("sensor", UNJUDGED), ("acknowledged", CHANGED)])
def test_an_axis_that_was_mended_is_not_known_before_it_has_run(monitored, kind, level):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    assert axis_conditions(state)[WORN].level == CHANGED
    event = {"time": "2027-01-01T00:00:00Z", "axes": [WORN + 1], "kind": kind}
    found = axis_conditions(replace(state, entry=state.entry | {"events": [event]}))[WORN]
    assert (found.level, len(found.episodes)) == (level, 0)
    summary = axis_summary(state, WORN, condition=found)
    assert ("no shift since" in summary["remark"]) == (level == UNJUDGED)


@pytest.mark.parametrize("kind", ["service", "acknowledged"])
def test_growth_of_before_an_event_is_told_as_such_until_the_axis_is_judged_again(monitored, kind):
    folder, _, _ = monitored
    state = with_estimates(changed(read_state(folder / "state.nc"), "coulomb friction", WORN), coulomb_percent=25.8)
    (first,) = [c for c in axis_conditions(state) if c.reached]
    assert axis_summary(state, WORN, condition=first)["label"] == "limit reached"
    status, reason = state.status.copy(), np.zeros_like(state.reason)
    status[57:, WORN], reason[57:, WORN] = UNJUDGED, Reason.LEARNING
    event = {"time": float(state.start[56]) + 1800.0, "axes": [WORN + 1], "kind": kind, "note": "Ms Müller"}
    after = replace(state, status=status, reason=reason, entry=state.entry | {"events": [event]})
    found = axis_conditions(after)[WORN]
    assert (found.reached, found.limited, found.anew) == (False, None, None)
    until, at = (log_time(t, zone_of(None), state.dated) for t in (state.end[56], event["time"]))
    words = f"Coulomb friction +25.8 % until {until}, before the event ({kind} {at}), limit 20 %; being learnt anew"
    summary = axis_summary(after, WORN, condition=found)
    assert summary["remark"].replace("\u00a0", " ").startswith(words)
    assert {e["name"]: e["value"] for e in summary["estimates"]}["change of Coulomb friction"] is None
    row = {**NOTHING, "robot": "x", "folder": "x", "result": "judged", **standing(after)}
    (axis,) = [a for a in row["axes"] if a["axis"] == WORN + 1]
    told = todo(row, axis, zone_of(None))
    assert (told["change"].replace("\u00a0", " "), told["bar"], told["outlook"]) == (words, None, "")
    cells = table_row(as_of(row, row["last_sample"]))
    if kind == "acknowledged":
        assert cells["urgency"] == CHANGED
        assert cells["growth_percent"] == ""
        assert cells["what_to_check"].startswith(words)
    assert [(e["key"], e["event"]["note"]) for e in row["closed"]] == [
        (f"{WORN + 1}|coulomb friction|model|", "Ms Müller")
    ]


@pytest.mark.parametrize(("kind", "anew"), [("service", True), ("acknowledged", True), ("program", False)])
def test_growth_that_counts_from_an_event_says_so(monitored, kind, anew):
    """Another 17 % were there before an alarm was acknowledged, and the page said 3 % of a limit of 20 %."""
    folder, _, _ = monitored
    state = changed(read_state(folder / "state.nc"), "coulomb friction", WORN)
    event = {"time": float(state.start[30]), "axes": [WORN + 1], "kind": kind}
    others = [
        {**event, "time": float(state.start[20])},
        {**event, "axes": [1], "time": float(state.start[40])},
        {**event, "time": float(state.end[-1]) + 1.0},
    ]
    row = standing(replace(state, entry=state.entry | {"events": [event, *others]}))
    told = {axis["axis"]: todo(row, axis, zone_of(None))["anew"] for axis in row["axes"]}
    since = log_time(event["time"], zone_of(None), state.dated)
    assert told[WORN + 1] == (f"growth counts from {since} ({kind})" if anew else "")
    assert not any(told[axis] for axis in (2, 4, 5))
    page = folder / "anew.html"
    write_page(replace(state, entry=state.entry | {"events": [event]}), page, folder / "anew")
    assert ("Growth counts from" in page.read_text()) == anew
