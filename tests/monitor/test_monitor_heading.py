"""Heading and state of every axis: what has changed, what is refused, what nobody has explained."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_states import HOURS, WORN, changed, with_estimates

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.loud import LOUD
from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.local_time import log_time, zone_of
from jointwear.monitor.presentation.advice import advice
from jointwear.monitor.presentation.condition import UNRESOLVED, axis_conditions
from jointwear.monitor.presentation.drawing import _rests_on
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import NOTHING, standing
from jointwear.monitor.presentation.summaries import axis_summary, headline
from jointwear.monitor.presentation.words import todo
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


def test_an_axis_whose_limit_cannot_be_seen_says_from_where_on(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    found = {"time": 0.0, "axes": [1], "kind": "coarse", "least": 0.34, "words": ""}
    summaries = [axis_summary(replace(state, findings=[found]), j) for j in (0, 1)]
    assert summaries[0]["remark"] == "only changes above 34 % can be seen"
    assert summaries[1]["remark"] == ""
    heading, sentences = headline(summaries)
    assert heading == "No change of friction found where it can be judged"
    assert "Only changes beyond the limit can be seen: axis 1." in sentences


def test_growth_over_the_limit_without_an_alarm_is_not_called_healthy(monitored):
    folder, _, _ = monitored
    state = replace(read_state(folder / "state.nc"), alarms=[])
    calm = replace(state, status=np.full_like(state.status, HEALTHY))
    grown = with_estimates(calm, coulomb_percent=-13.5, viscous_percent=23.5)
    told = axis_summary(grown, 0)
    assert (told["status"], told["label"], told["badge"]) == (HEALTHY, "over the limit, no alarm", "close")
    words = told["remark"].replace("\u00a0", " ")
    assert words.startswith("viscous friction +23.5 % now, Coulomb friction −13.5 %, over the limit of 20 % without an")
    assert "thicker grease does that, wear does not. Enter it under 'events' if it was greased; if not, check" in words
    assert standing(grown)["axes"][0]["over"] == told["remark"]
    summaries = [axis_summary(grown, j) for j in range(grown.axes)]
    over = [s["axis"] for s in summaries if s["label"] != HEALTHY]
    assert 1 in over
    assert headline(summaries)[0].startswith("Over the limit without an alarm: ax")
    # Below the limit, or over it by chance.
    for viscous, std in ((19.0, 1.0), (23.5, 15.0)):
        other = with_estimates(calm, coulomb_percent=-13.5, viscous_percent=viscous)
        other = replace(other, now_error={**other.now_error, "viscous_percent": np.full(other.axes, std)})
        assert axis_summary(other, 0)["label"] == HEALTHY
    # What the heading refers to stands beside whatever else is said of the axis.
    status = np.full_like(state.status, HEALTHY)
    status[-6:, 0] = UNJUDGED
    remark = axis_summary(with_estimates(replace(state, status=status), viscous_percent=23.5), 0)["remark"]
    assert remark.startswith("last judged ")
    assert "; viscous friction +23.5" in remark
    assert axis_summary(with_estimates(calm, coulomb_percent=25.0), 0)["remark"].startswith("Coulomb friction +25.0")


def test_coulomb_friction_that_has_clearly_grown_without_an_alarm_is_not_told_as_no_change(monitored):
    """A worn axis at half of its limit was told as "No change" with +9.3 % in its table, at an error of 2.9 %."""
    folder, _, _ = monitored
    state = replace(read_state(folder / "state.nc"), alarms=[])
    calm = replace(state, status=np.full_like(state.status, HEALTHY))
    calm = with_estimates(calm, coulomb_percent=0.0, viscous_percent=-12.0)
    calm.estimates["coulomb_percent"][0][:, 0] = 9.3
    for std, label in ((2.9, "higher, no alarm"), (3.5, HEALTHY)):
        seen = replace(calm, now_error={"coulomb_percent": np.full(calm.axes, std)})
        summaries = [axis_summary(seen, j) for j in range(calm.axes)]
        assert [s["label"] for s in summaries] == [label, *[HEALTHY] * (calm.axes - 1)]
        assert (summaries[0]["badge"] == "agrees") is (label == HEALTHY)
        heading, sentences = headline(summaries)
        if label == HEALTHY:
            assert heading == "No change of friction found"
            continue
        assert heading == "Friction is higher, without an alarm: axis 1"
        assert "No change: axes 2, 3, 4, 5 and 6." in sentences
        assert summaries[0]["remark"].replace("\u00a0", " ").startswith("Coulomb friction +9.3 % now, with a standard")
        # It asks for nothing.
        assert standing(seen)["axes"][0]["over"] == ""


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


def test_viscous_growth_beyond_its_limit_has_reached_it(monitored):
    folder, _, _ = monitored
    state = changed(read_state(folder / "state.nc"), "viscous friction")
    worn = with_estimates(state, coulomb_percent=0.2, viscous_percent=56.0, viscous=2.1)
    row = standing(worn)
    first = row["axes"][0]
    assert (first["axis"], first["reached"], first["viscous_growth"]) == (1, True, 56.0)
    judged = as_of({**NOTHING, "robot": "x", "result": "judged", **row}, worn.end[-1])
    assert judged["urgency"] == "limit reached"
    assert table_row(judged)["viscous_growth_percent"] == 56.0
    found = todo(row, first, zone_of(None))
    assert found["bar"] == 100.0
    assert found["outlook"] == "limit reached"
    words = found["change"].replace("\u00a0", " ")
    assert words.startswith("Viscous friction +56.0 % now (+2.1 N m s/rad), limit 20 %; Coulomb friction +0.2 % now")
    # Of an axis that alarmed for another quantity its noise says nothing, and what is beyond it is told.
    other = with_estimates(changed(state, "coulomb friction"), coulomb_percent=5.0, viscous_percent=56.0)
    for std, told in ((30.0, None), (2.0, 56.0)):
        seen = replace(other, now_error={**other.now_error, "viscous_percent": np.full(other.axes, std)})
        first = standing(seen)["axes"][0]
        assert (first["reached"], first["viscous_growth"]) == (told is not None, told)
    assert "viscous friction +56.0 % now, limit 20 %" in todo(row, first, zone_of(None))["change"].replace(
        "\u00a0", " "
    )


def test_viscous_growth_of_a_cold_spell_reaches_no_limit(monitored):
    """An axis that alarmed for Coulomb friction was told as at its limit, viscous +55 %, while all axes were cold."""
    folder, _, _ = monitored
    state = changed(read_state(folder / "state.nc"), "coulomb friction")
    worn = with_estimates(state, coulomb_percent=5.0, viscous_percent=56.0)
    worn = replace(worn, now_error={**worn.now_error, "viscous_percent": np.full(worn.axes, 2.0)})
    cold = {"time": float(worn.start[-3]), "axes": [], "kind": "shared", "words": "All axes moved together."}
    others = [f for f in worn.findings if f["kind"] != "shared"]
    for spell, reached in (({}, True), (cold, False), ({**cold, "end": float(worn.end[-2])}, True)):
        seen = replace(worn, findings=[*others, *([spell] if spell else [])])
        assert standing(seen)["axes"][0]["reached"] == reached


@pytest.mark.parametrize(("quantity", "name"), [("viscous friction", "viscous"), ("coulomb friction", "coulomb")])
def test_growth_whose_error_is_as_large_as_the_limit_has_not_reached_it(monitored, quantity, name):
    """Viscous friction of +74 % with an error of 23 %, in the first lots under an untold load, was "limit reached"."""
    folder, _, _ = monitored
    state = changed(read_state(folder / "state.nc"), quantity)
    state = with_estimates(state, coulomb_percent=1.0, viscous_percent=1.0)
    state = with_estimates(state, **{f"{name}_percent": 74.0})
    for std, reached in ((23.0, False), (19.0, True)):
        seen = replace(state, now_error={f"{name}_percent": np.full(state.axes, std)})
        first = standing(seen)["axes"][0]
        assert (first["reached"], first["unsure"]) == (reached, not reached)
        assert ("its growth is hardly known yet" in first["check"]) is not reached
        assert first["level"] == CHANGED


def by_days(state):
    """The state with windows of ten hours, so that there are days before and after."""
    return replace(
        state, **{name: state.start[0] + 10 * (getattr(state, name) - state.start[0]) for name in ("start", "end")}
    )


def with_steps(state, coulomb, viscous):
    """The state after an alarm of Coulomb friction of its first axis, with estimates (w,) of both kinds."""
    state = changed(with_estimates(state, coulomb_percent=0.0, viscous_percent=0.0), "coulomb friction")
    state = replace(state, hours_to_limit=np.full((state.axes, 3), 30.0), limited_by=["coulomb friction"] * state.axes)
    state.estimates["coulomb_percent"][0][:, 0] = coulomb
    state.estimates["viscous_percent"][0][:, 0] = viscous
    return next(c for c in axis_conditions(state) if c.axis == 1)


def test_both_kinds_of_friction_that_rose_by_one_share_at_once_are_a_scale_first_and_have_no_date(monitored):
    """An axis whose torque gained 8 % in one window: check the gear and bearings, 25 h to the limit."""
    folder, _, _ = monitored
    state = by_days(read_state(folder / "state.nc"))
    noise = np.random.default_rng(0).standard_normal((2, len(state.end)))
    step = 9.0 * (np.arange(len(state.end)) >= 48)
    told = with_steps(state, step + 0.5 * noise[0], step + 2 * noise[1])
    assert told.scaled
    assert told.outlook is None
    assert told.check.startswith("Coulomb and viscous friction rose at once")
    assert told.check.endswith("whether a brake drags")
    worn = with_steps(state, step + 0.5 * noise[0], 2 * noise[1])
    assert (worn.scaled, worn.outlook is None) == (False, False)
    assert worn.check.startswith("check the gear")


def test_coulomb_friction_that_fell_at_once_while_viscous_friction_rose_asks_for_a_service(monitored):
    """A worn axis was greased untold, Coulomb 11 to 4 %, viscous -2 to +22 %: its gear was to be checked still."""
    folder, _, _ = monitored
    state = by_days(read_state(folder / "state.nc"))
    noise = np.random.default_rng(1).standard_normal((2, len(state.end)))
    place = np.arange(len(state.end))
    grown = np.where(place < 54, 0.8 * np.maximum(place - 40, 0), 3.0)
    greased = np.where(place < 54, 0.0, 30.0)
    told = with_steps(state, grown + 0.2 * noise[0], greased + noise[1])
    assert told.repaired
    assert not told.reached
    assert told.outlook is None
    assert told.check.startswith("was it serviced or greased? Coulomb friction fell at once after its alarm")
    # Without the rise of viscous friction the level tells it, and growth that goes on is none.
    assert not with_steps(state, grown + 0.2 * noise[0], noise[1]).repaired
    assert not with_steps(state, 0.8 * np.maximum(place - 40, 0), greased + noise[1]).repaired


def test_coulomb_friction_below_normal_beside_viscous_friction_far_above_is_no_friction(monitored):
    """Backlash of 3.5 mrad was "limit reached", Coulomb -10.4 %, viscous more than +100 %, by an alarm of +28 N m."""
    folder, _, _ = monitored
    state = changed(read_state(folder / "state.nc"), "coulomb friction")
    state = replace(state, hours_to_limit=np.zeros((state.axes, 3)), limited_by=["viscous friction"] * state.axes)

    def first(coulomb, viscous, of=state):
        seen = with_estimates(of, coulomb_percent=coulomb, viscous_percent=viscous)
        sure = {"coulomb_percent": np.full(state.axes, 2.0), "viscous_percent": np.full(state.axes, 9.0)}
        seen = replace(seen, now_error={**seen.now_error, **sure})
        return next(axis for axis in standing(seen)["axes"] if axis["axis"] == 1)

    for viscous in (40.0, 124.0):
        play = first(-10.4, viscous)
        assert (play["reached"], play["hours"]) == (False, None)
        assert "friction alone does not explain it" in play["check"]
        assert "play at reversals" in play["check"]
    for coulomb in (-4.5, 3.0):  # hardly below normal
        assert first(coulomb, 124.0)["reached"]
    grease = changed(state, "viscous friction")
    assert first(-10.4, 40.0, grease)["reached"]
    assert (
        "was it greased? Coulomb friction fell meanwhile, as with thicker grease" in first(-10.4, 40.0, grease)["check"]
    )
    assert not first(-10.4, 124.0, grease)["reached"]


def test_the_table_says_of_which_axes_play_cannot_be_judged(monitored):
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    state.estimates["backlash"][0][:, 1] = 0.0
    found = {"time": float(state.start[0]), "axes": [1], "kind": "backlash", "words": "Backlash cannot be judged."}
    state = replace(state, findings=[found])
    told = [e["hidden"] for j in (0, 1) for e in axis_summary(state, j)["estimates"]]
    assert told == ["", "", "cannot be judged", "", "", "", "", ""]


def test_viscous_friction_that_rose_overnight_asks_whether_it_was_greased():
    assert advice("viscous friction", 0.1, "It rose overnight").startswith("was it greased? It rose overnight, as")
    assert advice("viscous friction", 0.1).startswith("check level")
    assert not advice("coulomb friction", 0.1, "It rose overnight").startswith("was it greased?")


@pytest.mark.parametrize(("coulomb", "asked"), [(0.2, True), (5.0, False)])
def test_an_axis_is_asked_for_grease_where_viscous_friction_alone_rose_overnight(monitored, coulomb, asked):
    folder, _, _ = monitored
    state = by_days(read_state(folder / "state.nc"))
    state = changed(with_estimates(state, coulomb_percent=coulomb, viscous_percent=0.0), "viscous friction")
    state.estimates["viscous_percent"][0][48:, 0] = 18.0
    (first,) = [c for c in axis_conditions(state) if c.axis == 1]
    assert first.overnight == first.check.startswith("was it greased?") == asked


def test_an_axis_that_is_back_to_normal_heads_no_red_card(monitored):
    folder, _, _ = monitored
    state = with_estimates(changed(read_state(folder / "state.nc"), "coulomb friction"), coulomb_percent=0.1)
    assert axis_conditions(state)[0].level == CHANGED
    back = replace(state, back=np.arange(state.axes) == 0)
    found = axis_conditions(back)[0]
    assert (found.level, found.outlook) == (UNRESOLVED, None)
    assert found.check.startswith("friction is back to normal, and nobody has said why")
    play = axis_conditions(replace(changed(state, "backlash"), back=back.back))[0]
    assert play.check.startswith("play is back to normal")
    # Neither status nor alarms are touched.
    assert (back.status[-1, 0], len(back.alarms)) == (CHANGED, 1)


def greased(state, entry_of):
    """The state after the friction came back, with what the config says of it."""
    status = state.status.copy()
    status[-1, WORN] = "healthy"
    return replace(state, status=status, entry=state.entry | entry_of)


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
    assert (found.reached, found.outlook, found.anew) == (False, None, None)
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
