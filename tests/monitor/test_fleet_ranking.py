"""How urgent a robot is, and which one comes first: nothing refused or silent looks healthy."""

import numpy as np
import pytest
from fleet_rows import DAY, FLEET, NOW, axis, began, findings_on_card, robot
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.fleet.page import robot_item
from jointwear.monitor.fleet.ranking import ASKS, ORDER, REFUSED, as_of, ranked
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, UNJUDGED, UNRESOLVED
from jointwear.monitor.presentation.standing import rhythm_hours
from jointwear.monitor.watching.backlash import BACKLASH


def test_of_robots_without_a_forecast_the_one_that_has_grown_most_comes_first():
    scale = {"time": NOW - DAY, "axes": [2], "kind": "scale", "words": "The scale changed."}
    rows = [robot(name, axis(1, CHANGED, growth=grown)) for name, grown in (("a", 3.0), ("b", 11.0), ("c", None))]
    rows += [robot("silent", last_sample=NOW - 5 * DAY), robot("asks", findings=[scale])]
    order = [row["robot"] for row in ranked([as_of(row, NOW) for row in rows])]
    assert order == ["b", "a", "c", "asks", "silent"]


def test_growth_of_before_an_event_puts_no_robot_first():
    served = {"event": {"time": NOW - 3600, "kind": "service", "note": ""}, "until": NOW - 7200}
    rows = [robot(name, axis(1, UNRESOLVED, growth=g, **e)) for name, g, e in (("old", 25.0, served), ("new", 3.0, {}))]
    assert [row["robot"] for row in ranked([as_of(row, NOW) for row in rows])] == ["new", "old"]


def test_what_cannot_be_judged_of_backlash_is_nothing_to_check():
    found = [
        {"time": NOW, "axes": [1], "kind": BACKLASH, "words": "Backlash of axis 1 cannot be judged."},
        {"time": NOW - DAY, "axes": [2], "kind": "scale", "words": "The scale changed."},
    ]
    row = as_of(robot("arm", findings=found), NOW)
    item = robot_item(row, zone_of(None), "robots")
    assert findings_on_card(row) == ["Wed 2025-12-31: The scale changed."]
    # Somebody has to say what was done to it.
    assert (row["urgency"], item["check"]) == (
        "needs an entry under events",
        "Enter what was done to it, or look for the cause",
    )
    assert as_of(robot("arm", findings=found[:1]), NOW)["urgency"] == "healthy"


@pytest.mark.parametrize("kind", ["contradicted", "outside", "frozen", "missing", "drives", "uneven"])
def test_a_torque_or_position_that_is_none_asks_for_its_cause_while_it_lasts(kind):
    found = {"time": NOW - DAY, "axes": [3], "kind": kind, "words": "The torque of axis 3 is none."}
    assert (
        as_of({**robot("arm", findings=[found]), "last_sample": NOW - 60.0}, NOW)["urgency"]
        == "needs an entry under events"
    )
    for end, urgency in ((NOW + 60.0, "needs an entry under events"), (NOW - DAY / 2, "healthy")):
        row = robot("arm", findings=[{**found, "end": end}])
        assert as_of({**row, "last_sample": NOW - 60.0}, NOW)["urgency"] == urgency


def test_a_service_that_is_proposed_asks_for_its_event_until_one_is_entered():
    found = {"time": NOW, "axes": [2], "kind": "proposed_service", "words": "Friction of axis 2 fell."}
    assert as_of(robot("arm", findings=[found]), NOW)["urgency"] == "needs an entry under events"
    assert as_of(robot("arm", findings=[{**found, "answered": True}]), NOW)["urgency"] == "healthy"


def test_an_axis_over_its_limit_without_an_alarm_is_not_called_healthy():
    told = "viscous friction +23.5 % now, Coulomb friction −13.5 %: over the limit of 20 % without an alarm."
    row = as_of(robot("arm", axis(5, over=told), findings=[began(1)]), NOW)
    item = robot_item(row, zone_of(None), "robots")
    assert item["urgency"] == "needs an entry under events"
    assert findings_on_card(row)[0] == f"Axis 5: {told}"
    assert as_of(robot("arm", axis(5, over="")), NOW)["urgency"] == "healthy"


@given(
    st.lists(st.sampled_from([HEALTHY, CHANGED, UNRESOLVED, UNJUDGED]), min_size=1, max_size=6),
    st.floats(0, 2000),
    st.integers(0, 3),
    st.booleans(),
)
def test_healthy_means_that_nothing_is_known_against_it(levels, silence, refused, judged):
    axes = [axis(k + 1, level) for k, level in enumerate(levels)]
    more = {} if judged else {"result": "refused", "axes": []}
    row = robot("x", *axes, logs=3, refused_newest=refused, last_sample=NOW - 3600 * silence, **more)
    found = as_of(row, NOW)
    fine = judged and silence <= 72 and not refused and HEALTHY in levels and not {CHANGED, UNRESOLVED} & set(levels)
    assert (found["urgency"] == HEALTHY) == fine
    assert (found["stale_windows"] > 0) == (found["stale_logs"] > 0) == (silence > 72)
    assert found["urgency"] in ORDER


def test_a_robot_whose_every_log_lacks_a_torn_row_is_judged_all_the_same():
    assert as_of(robot("x", logs=3, refused_logs=3), NOW)["urgency"] == HEALTHY
    assert as_of(robot("x", axis(1, UNJUDGED), logs=3, refused_logs=3), NOW)["urgency"] == UNJUDGED
    assert as_of(robot("x", axis(1, UNJUDGED), logs=3, refused_logs=3, refused_newest=3), NOW)["urgency"] == REFUSED


def test_a_log_counts_as_overdue_once_the_next_one_would_be_due_too():
    found = as_of(robot("x", logs=10, windows=240, rhythm_hours=24.0, last_sample=NOW - 100 * 3600), NOW)
    assert (found["stale_logs"], found["stale_windows"]) == (4, 96)


@pytest.mark.parametrize(
    ("dated", "last", "ahead"),
    [(True, NOW + 400 * DAY, "400 days"), (True, NOW + 14 * 3600, ""), (False, NOW + 400 * DAY, ""), (True, None, "")],
    ids=["a wrong clock", "a wrong time zone", "no dates", "no sample"],
)
def test_a_robot_whose_newest_log_is_dated_ahead_of_now_is_not_healthy(dated, last, ahead):
    found = as_of(robot("x", dated=dated, last_sample=last), NOW)
    assert found["urgency"] == (ASKS if ahead else HEALTHY)
    assert [f["words"].partition(" ahead")[0] for f in found["findings"]] == (
        [f"The newest sample is dated {ahead}"] if ahead else []
    )


def test_nights_and_weekends_count_into_the_rhythm_of_logs():
    shifts = [day * 86400 + hour * 3600.0 for day in range(40) if day % 7 < 5 for hour in range(6, 22)]
    rhythm = rhythm_hours(np.array([np.nan, *shifts]))
    # 16 logs on five of seven days.
    assert 18 * 24 / rhythm == pytest.approx(18 * 16 * 5 / 7, rel=0.1)
    assert rhythm_hours(np.array([0.0, 40 * 86400.0])) == 960
    assert rhythm_hours(np.array([5.0])) is None


@given(st.permutations(FLEET))
def test_the_order_of_the_config_does_not_matter(rows):
    assert ranked([as_of(r, NOW) for r in rows]) == ranked([as_of(r, NOW) for r in FLEET])
