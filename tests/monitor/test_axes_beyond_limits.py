"""Growth of an axis beside its limit: what has reached it, what may have, and what no growth of friction is."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_states import changed, with_estimates

from jointwear.monitor.fleet.ranking import as_of
from jointwear.monitor.fleet.table import table_row
from jointwear.monitor.judging.state import read_state
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.presentation.advice import advice
from jointwear.monitor.presentation.condition import axis_conditions
from jointwear.monitor.presentation.page import write_page
from jointwear.monitor.presentation.standing import NOTHING, standing
from jointwear.monitor.presentation.summaries import axis_summary, headline
from jointwear.monitor.presentation.words import todo
from jointwear.monitor.watching.limits import LimitDate
from jointwear.monitor.watching.records import CHANGED, HEALTHY, UNJUDGED


def by_days(state):
    """The state with windows of ten hours, so that there are days before and after."""
    return replace(
        state, **{name: state.start[0] + 10 * (getattr(state, name) - state.start[0]) for name in ("start", "end")}
    )


def with_steps(state, coulomb, viscous):
    """The state after an alarm of Coulomb friction of its first axis, with estimates (w,) of both kinds."""
    state = changed(with_estimates(state, coulomb_percent=0.0, viscous_percent=0.0), "coulomb friction")
    soon = state.end[-1] + 30 * 3600.0
    state = replace(state, limits=(LimitDate("coulomb friction", soon, soon, soon),) * state.axes)
    state.estimates["coulomb_percent"][0][:, 0] = coulomb
    state.estimates["viscous_percent"][0][:, 0] = viscous
    return next(c for c in axis_conditions(state) if c.axis == 1)


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
    assert (
        "thicker grease does that, wear does not. Enter it under 'events' if it was greased; if not, ask whether"
        in words
    )
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
        told = standing(seen)["axes"][0]
        assert (told["over"], told["rising"]) == ("", summaries[0]["remark"])


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


def test_both_kinds_of_friction_that_rose_by_one_share_at_once_are_a_scale_first_and_have_no_date(monitored):
    """An axis whose torque gained 8 % in one window: check the gear and bearings, 25 h to the limit."""
    folder, _, _ = monitored
    state = by_days(read_state(folder / "state.nc"))
    noise = np.random.default_rng(0).standard_normal((2, len(state.end)))
    step = 9.0 * (np.arange(len(state.end)) >= 48)
    told = with_steps(state, step + 0.5 * noise[0], step + 2 * noise[1])
    assert told.scaled
    assert told.limited is None
    assert told.check.startswith("Coulomb and viscous friction rose at once")
    assert told.check.endswith("whether a brake drags")
    worn = with_steps(state, step + 0.5 * noise[0], 2 * noise[1])
    assert (worn.scaled, worn.limited is None) == (False, False)
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
    assert told.limited is None
    assert told.check.startswith("was it serviced or greased? Coulomb friction fell at once after its alarm")
    # Without the rise of viscous friction the level tells it, and growth that goes on is none.
    assert not with_steps(state, grown + 0.2 * noise[0], noise[1]).repaired
    assert not with_steps(state, 0.8 * np.maximum(place - 40, 0), greased + noise[1]).repaired


def test_coulomb_friction_below_normal_beside_viscous_friction_far_above_is_no_friction(monitored):
    """Backlash of 3.5 mrad was "limit reached", Coulomb -10.4 %, viscous more than +100 %, by an alarm of +28 N m."""
    folder, _, _ = monitored
    state = changed(read_state(folder / "state.nc"), "coulomb friction")
    state = replace(state, limits=(LimitDate("viscous friction", *[state.end[-1]] * 3),) * state.axes)

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


def test_a_column_of_pulses_is_not_called_play(monitored, tmp_path):
    """A gap six times as large stood as "change of play +2.3 %", as noise hides most of its pulses."""
    folder, _, _ = monitored
    state = read_state(folder / "state.nc")
    size = state.status.shape
    for value, told in ((2.3, True), (np.nan, False)):
        pulses = {"backlash": (np.full(size, value), np.full(size, 3.2), "%")}
        seen = replace(state, estimates=state.estimates | pulses)
        write_page(seen, tmp_path / "monitor.html", tmp_path / "figures")
        text = (tmp_path / "monitor.html").read_text(encoding="utf-8")
        assert ("change of pulses at reversals" in text) is told
        assert ("play whose pulses are small beside that" in text) is told
        assert "change of play" not in text
