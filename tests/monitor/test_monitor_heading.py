"""Heading and state of every axis: what has changed, what is refused, what nobody has explained."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_states import HOURS

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.loud import LOUD
from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.presentation.condition import axis_conditions
from jointwear.monitor.presentation.drawing import _rests_on
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import NOTHING, standing
from jointwear.monitor.presentation.summaries import axis_summary, headline
from jointwear.monitor.watching.records import CHANGED, HEALTHY, UNJUDGED, Reason


def test_an_axis_that_stops_moving_is_no_longer_called_healthy(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    status = state.status.copy()
    status[50:, 0] = UNJUDGED
    found = axis_summary(replace(state, status=status), 0)
    assert "last judged" in found["remark"]
    status[state.after, 0] = UNJUDGED
    assert axis_summary(replace(state, status=status), 0)["status"] == UNJUDGED


def test_an_axis_whose_torque_grew_uneven_is_not_called_healthy_until_an_event_answers(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    found = {"time": float(state.start[40]), "axes": [1], "kind": LOUD, "words": "uneven"}
    told = axis_summary(replace(state, findings=[found]), 0)
    assert told["status"] == UNJUDGED
    assert "uneven" in told["remark"]
    healthy = [told if k == 0 else {**axis_summary(state, k), "status": HEALTHY, "label": HEALTHY} for k in range(6)]
    assert headline(healthy)[0] == "Torque has grown uneven: axis 1"
    assert axis_summary(replace(state, findings=[{**found, "answered": True}]), 0)["status"] == HEALTHY
    over = {**found, "end": float(state.end[43])}
    assert axis_summary(replace(state, findings=[over]), 0)["status"] == HEALTHY


def test_a_page_that_tells_another_zero_does_not_say_beside_it_that_nothing_has_changed(monitored, tmp_path):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    healthy = replace(state, alarms=[], status=np.where(state.status == CHANGED, HEALTHY, state.status))
    found = {"time": float(state.start[40]), "axes": [3], "kind": "zero", "words": "Joint 3 counts otherwise."}
    for more, told in (({}, "Friction is not known before"), ({"answered": True}, "No change of friction")):
        write_page(replace(healthy, findings=[{**found, **more}]), tmp_path / "page.html", tmp_path / "figures")
        page = (tmp_path / "page.html").read_text(encoding="utf-8")
        assert f"<h1>{told}" in page
        assert ("unless the zero of a joint hides it" in page) == (not more)


@pytest.mark.parametrize(
    ("why", "level"), [(Reason.NONE, HEALTHY), (Reason.CONDITIONS, UNJUDGED), (Reason.LEARNING, UNJUDGED)]
)
def test_days_in_which_an_axis_waited_for_its_normal_are_no_pause_of_it(monitored, why, level):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    # Four hours from window to window: of the last week two spells of 80 h are not judged.
    first, reason = float(state.start[0]), np.zeros_like(state.reason)
    stretched = {name: first + 4.0 * (getattr(state, name) - first) for name in ("start", "end")}
    status = np.full_like(state.status, HEALTHY)
    for part in (slice(-42, -22), slice(-20, None)):
        status[part, 0], reason[part, 0] = UNJUDGED, why
    found = axis_conditions(replace(state, alarms=[], status=status, reason=reason, **stretched))
    assert found[0].level == level


def test_play_alone_is_no_change_of_friction_and_is_told_as_it_is_now(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    alarm = {
        **state.alarms[-1], "axis": 1, "quantity": "backlash", "detector": "model", "unit": "%",
        "change": 26.0, "change_low": 20.0, "change_high": 30.0, "time": float(state.end[50]),
    }  # fmt: skip
    status = np.full_like(state.status, "healthy")
    status[50:, 0] = CHANGED
    shape = state.status.shape
    estimates = {**state.estimates, "backlash": (np.full(shape, 70.0), np.ones(shape), "%")}
    other = replace(state, alarms=[alarm], status=status, estimates=estimates)
    summaries = [axis_summary(other, j) for j in range(state.axes)]
    assert headline(summaries)[0] == "Backlash has grown: axis 1"
    (found,) = [c for c in axis_conditions(other) if c.level == CHANGED]
    assert found.change == pytest.approx(70.0)
    said = {"time": float(other.end[55]), "axes": [1], "kind": "acknowledged"}
    known = axis_summary(replace(other, entry=other.entry | {"events": [said]}), 0)
    assert headline([known])[0] == "Backlash has grown: axis 1"
    summaries[2]["status"] = CHANGED
    assert headline(summaries)[0] == "Friction has changed: axis 3; backlash has grown: axis 1"
    write_page(other, folder / "play.html", folder / "play")
    assert (folder / "play" / "timeline_backlash.svg").is_file()
    assert not (folder / "play" / "timeline_viscous.svg").exists()
    assert _rests_on(alarm, "backlash")
    assert not _rests_on(alarm, "coulomb")


def test_newest_logs_that_are_refused_are_not_healthy(monitored):
    """The samples of days 4 on contradict the model: what an axis was like before is no verdict on now."""
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    log = {"logs": ["a.csv", "b.csv"], "refused": ["", "b.csv: the sign looks flipped"], "copy_of": ["", ""]}

    def judged(until, hours):
        rest = np.arange(HOURS) >= until
        end = np.where(rest, state.end + (hours - (HOURS - until)) * 3600, state.end)
        found = np.where(rest[:, None] | np.zeros_like(state.status, dtype=bool), UNJUDGED, "healthy").astype(object)
        marked = np.where(found == UNJUDGED, int(Flag.REFUSED | Flag.AT_REST), 0)
        first, last = np.array([state.start[0], state.start[until]]), np.array([state.end[until - 1], end[-1]])
        return replace(state, status=found, flags=marked, end=end, first=first, last=last, alarms=[], **log)

    lately, long_ago = judged(50, 10.0), judged(50, 100.0)
    for other, level in ((lately, "healthy"), (long_ago, UNJUDGED)):
        row = standing(other)
        assert row["refused_newest"] == 1
        assert as_of({**NOTHING, "robot": "x", "result": "judged", **row}, other.end[-1])["urgency"] == "refused"
        summary = axis_summary(other, 0)
        assert summary["status"] == level
        assert "since then: the log contradicts the model" in summary["remark"]
        heading, sentences = headline([summary], refused=row["refused_newest"])
        assert heading == "The newest logs are refused"
        assert "as of then" in sentences[0]
        assert "since any axis was judged last" in sentences[0]
        learnt = headline([summary], refused=row["refused_newest"], learnt=True)[1]
        assert "since the normal period, after which no axis was judged" in learnt[0]
    silent = replace(long_ago, refused=["", ""])
    assert standing(silent)["refused_newest"] == 0
    # A torn row that is told refuses no sample, though no axis could be judged since.
    resting = np.where(lately.flags > 0, int(Flag.AT_REST), 0)
    torn = replace(lately, flags=resting, refused=["", "b.csv: row 7 has 1 cell"])
    assert standing(torn)["refused_newest"] == 0


def test_a_log_of_which_rows_alone_were_left_out_is_not_refused(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    begin, end = float(state.start[0]), float(state.end[-1])
    middle = (begin + end) / 2

    def told(words, last=end, flags=0):
        flags = np.where(state.start[:, None] >= middle, flags, 0) | np.zeros_like(state.flags)
        times = {"first": np.array([begin, middle]), "last": np.array([middle, last])}
        logs = {"logs": ["a.csv", "b.csv"], "refused": ["", words], "copy_of": ["", ""]}
        row = standing(replace(state, flags=flags, **times, **logs))
        assert bool(row["refusals"]) == bool(row["refused_logs"])
        return row["refused_logs"], row["left_out_logs"]

    torn = "b.csv: row 1202 has 1 cell, the header names 25 columns; it and 1 more row were left out"
    assert told(torn) == (0, 1)
    assert told(torn, flags=int(Flag.REFUSED)) == (1, 0)
    assert told(torn, last=np.nan) == (1, 0)
    assert told("b.csv: the sign looks flipped") == (1, 0)
    assert told(f"{torn}; b.csv: is truncated or not a Parquet file") == (1, 0)


def test_an_axis_whose_last_window_is_not_judged_stays_changed(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    worn = np.array(state.status, dtype=object)
    after = state.after
    worn[after, 0] = "changed"
    named = standing(replace(state, status=worn))
    worn = worn.copy()
    worn[-1, 0] = UNJUDGED
    blind = standing(replace(state, status=worn))
    assert "1" in named["axes_changed"].split()
    assert named["axes_changed"] == blind["axes_changed"]


def test_the_dates_of_refused_logs_are_neither_the_newest_sample_nor_a_rhythm(monitored):
    """A log that is ten years ahead had kept its robot from ever being stale."""
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    half, years = len(state.start) // 2, 10 * 365 * 86400.0
    first = np.array([state.start[0], state.start[0] + years, state.start[0] - years, state.start[half]])
    last = np.array([state.end[half - 1], state.end[0] + years, state.end[0] - years, state.end[-1]]) - 1.0
    log = {
        "logs": ["a.csv", "ahead.csv", "behind.csv", "b.csv"], "refused": ["", "dated off", "dated off", ""],
        "copy_of": [""] * 4, "first": first, "last": last,
    }  # fmt: skip
    state = replace(state, **log, flags=np.zeros_like(state.flags))
    row = standing(state)
    assert row["last_sample"] == last[3]
    assert row["rhythm_hours"] == pytest.approx((first[3] - first[0]) / 3600)
    assert as_of({**NOTHING, "robot": "x", "result": "judged", **row}, last[3] + 73 * 3600)["stale"]
    # Nor does a log of which all samples contradict the model tell when the newest one was measured.
    begun = (state.start >= first[3])[:, None] & np.ones(state.axes, dtype=bool)
    refused = replace(
        state,
        flags=np.where(begun, int(Flag.REFUSED), 0),
        count=np.where(begun, 0, state.count),
        refused=["", "", "", "turned"],
    )
    assert standing(refused)["last_sample"] == last[0]
    assert standing(replace(refused, count=state.count))["last_sample"] == last[3]


def test_newest_logs_without_any_sample_are_not_healthy(monitored):
    """They have no time of their own; where they stand in the list tells that they are the newest."""
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    # The log of the fixture that is cut short comes after the one that was read: it may be one that is being written.
    assert state.refused[1]
    row = {**NOTHING, "robot": "x", "result": "judged", **standing(state), "rhythm_hours": 4.0, "dated": True}
    assert (row["refused_newest"], row["unfinished"]) == (0, True)
    for hours, rhythm, refused_newest in ((7.0, 4.0, 0), (9.0, 4.0, 1), (0.5, None, 1)):
        later = as_of({**row, "rhythm_hours": rhythm}, row["last_sample"] + 3600 * hours)
        assert later["refused_newest"] == refused_newest
    assert as_of({**row, "dated": False}, row["last_sample"])["refused_newest"] == 1
    empty, nan = "b.csv: holds no samples", np.nan
    begin, end = float(state.start[0]), float(state.end[-1])

    def refused(told, first, last):
        names = [f"{k}.csv" for k in range(len(told))]
        times = {"first": np.array(first), "last": np.array(last)}
        return standing(replace(state, logs=names, refused=told, copy_of=[""] * len(told), **times))["refused_newest"]

    assert refused(["", "b.csv: has no column 'time'"], [begin, nan], [end, nan]) == 1
    for words in (empty, "b.csv: is empty", "b.parquet: is truncated or not a Parquet file (magic bytes)"):
        assert refused(["", words], [begin, nan], [end, nan]) == 0
        assert refused(["", words, words], [begin, nan, nan], [end, nan, nan]) == 1
    # An old one, before logs that could be read, is no news.
    assert refused(["", empty, ""], [begin, nan, end - 60], [begin + 60, nan, end]) == 0
    assert refused([empty, ""], [nan, begin], [nan, end]) == 0


def test_an_axis_that_is_no_longer_judged_is_not_told_as_unchanged(monitored):
    folder, _, _ = monitored
    state = replace(read_state(folder / "state.nc"), alarms=[])
    status = np.full_like(state.status, HEALTHY)
    status[-6:, 0] = UNJUDGED
    state = replace(state, status=status)
    sentences = headline([axis_summary(state, j) for j in (0, 1)])[1]
    assert sentences == [
        "No change: axis 2.",
        "No change when last judged, but not judged of late: axis 1; the reasons are in the table.",
    ]


def test_an_axis_that_was_healthy_when_last_judged_is_told_as_of_then(monitored, tmp_path):
    """Healthy with a tick stood beside a torque that was frozen for the last hours."""
    folder, _, _ = monitored
    state = replace(read_state(folder / "state.nc"), alarms=[], findings=[])
    status = np.full_like(state.status, HEALTHY)
    status[-6:, 0] = status[-1:, 1] = UNJUDGED
    state = replace(state, status=status)
    told = [axis_summary(state, j) for j in range(3)]
    assert [s["status"] for s in told] == 3 * [HEALTHY]
    assert [s["badge"] for s in told] == ["other", "agrees", "agrees"]
    assert [s["held"].partition(",")[0] for s in told] == ["when last judged", "when last judged", ""]
    assert [bool(s["remark"]) for s in told] == [True, True, False]
    write_page(state, tmp_path / "page.html", tmp_path / "figures")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.count(told[0]["held"]) == 2  # on its card and in the table


def test_what_makes_a_robot_urgent_stands_under_what_to_check_first_on_its_page_too(monitored, tmp_path):
    folder, _, _ = monitored
    state = replace(read_state(folder / "state.nc"), alarms=[])
    status = np.full_like(state.status, HEALTHY)
    frozen = {"time": float(state.start[-6]), "end": float(state.end[-1]), "axes": [1], "kind": "frozen"}
    over = {**frozen, "end": float(state.end[-4]), "words": "It kept one value."}
    found = [{**frozen, "words": "The torque of axis 1 keeps one value."}, {**over, "kind": "shared"}]
    for findings, urgent in ((found, True), ([over], False), (found[1:], False)):
        robot = replace(state, status=status, findings=findings)
        write_page(robot, tmp_path / "page.html", tmp_path / "figures")
        page = (tmp_path / "page.html").read_text(encoding="utf-8")
        # As the fleet has it.
        row = {**NOTHING, **standing(robot), "robot": "a", "folder": "a", "result": "judged", "rhythm_hours": 1.0}
        asks = as_of(row, float(state.end[-1]))["urgency"] == "needs an entry under events"
        assert asks == urgent
        assert ("<h1>The logs show something that has to be explained" in page) == urgent
        assert ("<h1>No change of friction found" in page) != urgent
        first = page.partition("What to check first")[2].partition("</ol>")[0]
        assert ("The torque of axis 1 keeps one value." in first) == urgent
        assert "What else was found" not in first


def test_the_table_says_of_which_axes_play_cannot_be_judged(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    state.estimates["backlash"][0][:, 1] = 0.0
    found = {"time": float(state.start[0]), "axes": [1], "kind": "backlash", "words": "Backlash cannot be judged."}
    state = replace(state, findings=[found])
    told = [e["hidden"] for j in (0, 1) for e in axis_summary(state, j)["estimates"]]
    assert told == ["", "", "cannot be judged", "", "", "", "", ""]
