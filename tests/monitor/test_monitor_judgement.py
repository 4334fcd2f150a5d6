"""Judgement of the monitor: which axes have changed, which are healthy, and which it cannot judge."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from monitor_windows import SETTINGS, VISCOUS, motion, residuals, statistics_of

from jointwear.measurement.flags import Flag
from jointwear.monitor.events import Event
from jointwear.monitor.judging import judge as judge_module
from jointwear.monitor.judging.judge import judge
from jointwear.monitor.judging.judge_settings import JudgeSettings
from jointwear.monitor.judging.open_alarms import GROWN_BEFORE, OPEN_ALARM, open_alarm_findings
from jointwear.monitor.presentation.episodes import episodes_of
from jointwear.monitor.watching.another_robot import first_exchange
from jointwear.monitor.watching.limits import VISCOUS as VISCOUS_FRICTION
from jointwear.monitor.watching.records import CHANGED, HEALTHY, UNJUDGED, Reason, Teller
from jointwear.monitor.watching.shared_error import shared_error
from jointwear.monitor.watching.watching import watch


def test_judgement_names_the_worn_axis_and_says_what_it_cannot_judge():
    growth = np.zeros((200, 3))
    growth[120:, 0] = 0.15 * (np.arange(80) / 80) ** 2
    result = judge(statistics_of(residuals(200, growth, 13), still=2), 120, SETTINGS)
    mine = [a for a in result.alarms if a["detector"] == "model"]
    assert mine
    assert {a["axis"] for a in mine} == {1}
    first = mine[0]
    assert first["probability_axis"] > 0.95
    assert first["change_low"] <= first["change"] <= first["change_high"]
    assert first["unit"] == "N m"
    last = mine[-1]
    assert last["growth_percent_low"] < last["growth_percent"] < last["growth_percent_high"]
    # Coulomb friction of the normal period is 8 N m.
    assert last["growth_percent"] == pytest.approx(100 * last["change"] / 8, rel=0.02)
    assert last["limit_percent"] == SETTINGS.limit_percent
    assert first["hours_to_limit_low"] <= first["hours_to_limit"]
    assert set(result.status[:, 2]) == {UNJUDGED}
    assert set(result.status[:, 1]) == {HEALTHY}
    assert result.status[-1, 0] == CHANGED
    assert result.status[100, 0] == HEALTHY
    assert result.estimates["coulomb_percent"][-1, 0] == pytest.approx(15, abs=2)
    assert result.estimates["coulomb"][-1, 0] == pytest.approx(0.15 * 8, abs=0.2)
    for name, values in result.estimates.items():
        assert values.shape == result.std[name].shape == result.status.shape
        assert name in result.units
    # A repeat a day later brings a new forecast; not more often.
    times = [a["time"] for a in mine]
    assert np.all(np.diff(times) >= 24 * 3600)


@pytest.mark.parametrize(("grown", "end"), [(-2.0, 180), (-2.0, 200), (-1.32, 200)])
def test_an_axis_whose_friction_is_gone_or_would_drive_it_is_told(grown, end):
    growth = np.zeros((200, 3))
    # Turned round, Coulomb friction is what it was with the other sign: the growth is -2. A command holds none, so that
    # the Coulomb friction makes up for the viscous one at the usual speed.
    growth[160:end, 1] = grown
    result = judge(statistics_of(residuals(200, growth, 13)), 120, SETTINGS)
    (told,) = [f for f in result.findings if f["kind"] == "drives"]
    assert told["axes"] == [2]
    assert "Friction of axis 2 came out at zero or below" in told["words"]
    assert told["time"] == 160 * 3600
    assert told.get("end") == (None if end == 200 else end * 3600)
    assert set(result.status[160:end, 1]) == {UNJUDGED}
    assert set(result.reason[160:end, 1]) == {Reason.DRIVES}
    assert not [a for a in result.alarms if a["detector"] == "model"]


def test_two_axes_at_once_are_both_named():
    growth = np.zeros((220, 3))
    growth[120:, 0] = 0.1 * (np.arange(100) / 100)
    growth[120:, 2] = 0.2 * (np.arange(100) / 100)
    result = judge(statistics_of(residuals(220, growth, 14)), 120, SETTINGS)
    assert {a["axis"] for a in result.alarms if a["detector"] == "model"} == {1, 3}


@pytest.mark.long
def test_an_axis_too_coarse_for_its_limit_says_so_and_still_alarms_for_a_large_change():
    # Friction of the second axis differs from shift to shift.
    growth = np.zeros((300, 3))
    growth[:, 1] = np.repeat(0.17 * np.random.default_rng(3).uniform(-1, 1, 38), 8)[:300]
    quiet = judge(statistics_of(residuals(300, growth, 15)), 120, SETTINGS)
    (told,) = [f for f in quiet.findings if f["kind"] == "coarse"]
    assert told["axes"] == [2]
    assert told["least"] > 0.2
    assert f"{100 * told['least']:.0f} %" in told["words"]
    assert set(quiet.status[120:, 1]) == {HEALTHY}
    assert not [a for a in quiet.alarms if a["detector"] == "model"]
    growth[200:, 1] += 1.5 * told["least"]
    worn = judge(statistics_of(residuals(300, growth, 15)), 120, SETTINGS)
    assert {a["axis"] for a in worn.alarms if a["detector"] == "model"} == {2}
    assert worn.status[-1, 1] == CHANGED


def test_friction_that_drowns_is_not_called_healthy():
    loud = residuals(150, np.zeros((150, 3)), 15)
    loud[..., 1] *= 400
    result = judge(statistics_of(loud), 120, SETTINGS)
    assert set(result.status[:, 1]) == {UNJUDGED}
    assert set(result.status[:, 0]) == {HEALTHY}


def test_refused_and_empty_windows_are_not_judged():
    s = statistics_of(residuals(150, np.zeros((150, 3)), 16))
    flags = s.flags.copy()
    flags[130:140, 0] = int(Flag.REFUSED)
    result = judge(replace(s, flags=flags), 120, SETTINGS)
    assert set(result.status[130:140, 0]) == {UNJUDGED}
    assert np.isnan(result.estimates["coulomb"][130:140, 0]).all()


@pytest.mark.long
def test_an_axis_that_was_mended_is_healthy_again_once_somebody_says_so():
    growth = np.zeros((260, 3))
    growth[120:180, 1] = 0.1
    statistics = statistics_of(residuals(260, growth, 17))
    unsaid = judge(statistics, 120, SETTINGS)
    assert unsaid.status[170, 1] == CHANGED
    # Friction that fell back alone closes nothing: a service is proposed, the alarm stays open.
    assert unsaid.status[-1, 1] == CHANGED
    assert [f["axes"] for f in unsaid.findings if f["kind"] == "proposed_service"] == [[2]]
    said = judge(statistics, 120, replace(SETTINGS, events=(Event(180 * 3600.0, (1,), "service"),)))
    assert said.status[170, 1] == CHANGED
    assert said.status[-1, 1] == HEALTHY
    assert said.status[181, 1] == UNJUDGED
    assert (said.status[121:, 0] == HEALTHY).all()


def worn_under_another_program(grown: float):
    """Statistics of an axis that wears by 15 %, on which another program from hour 200 on asks `grown` more."""
    growth = np.zeros((320, 3))
    growth[120:, 1] = 0.15 * np.arange(200) / 200
    growth[200:, 1] += grown
    growth[200:, [0, 2]] += 0.1
    return statistics_of(residuals(320, growth, 23))


@pytest.mark.parametrize("axes", [(), (1,)])
def test_another_program_repairs_nothing(axes):
    statistics, at = worn_under_another_program(0.1 if not axes else 0.0), 200 * 3600.0
    result = judge(statistics, 120, replace(SETTINGS, events=(Event(at, axes, "program", "another gripper"),)))
    growth = result.estimates["coulomb_percent"][:, 1]
    assert result.status[199, 1] == CHANGED
    # The alarm stays open while the axis is learnt anew, and growth goes on but for what came meanwhile.
    assert set(result.status[200:, 1]) == {CHANGED}
    assert np.isnan(growth[200:210]).all()
    # From 5.6 % in the last two shifts before on; 6.8 % is what the axis has grown by while it is learnt anew.
    assert np.mean(growth[-8:]) == pytest.approx(5.6 + (14.7 - 6.8) / (1.17 if not axes else 1.07), abs=1)
    assert not result.back[1]
    (told,) = [f for f in result.findings if f["kind"] == OPEN_ALARM]
    assert (told["axes"], told["time"], "answered" in told) == ([2], at, False)
    assert "Coulomb friction +5 % by then" in told["words"]
    alarms = [a["time"] for a in result.alarms if a["detector"] == "model" and a["axis"] == 2]
    _, low, high = result.limits[1].hours_from(statistics.end[-1])
    assert min(alarms) < at
    assert low <= 70 <= high


@pytest.mark.parametrize("kind", ["service", "sensor", "acknowledged"])
def test_other_events_close_an_alarm_also_beside_another_program(kind):
    statistics, at = worn_under_another_program(0.0), 200 * 3600.0
    events = (Event(at, (), "program"), Event(at, (1,), kind))
    result = judge(statistics, 120, replace(SETTINGS, events=events))
    assert result.status[199, 1] == CHANGED
    assert result.status[201, 1] == UNJUDGED
    assert [f for f in result.findings if f["kind"] == OPEN_ALARM] == []


def test_another_program_without_an_open_alarm_starts_anew_as_before():
    growth = np.zeros((260, 3))
    growth[200:] = 0.2
    statistics = statistics_of(residuals(260, growth, 24))
    result = judge(statistics, 120, replace(SETTINGS, events=(Event(200 * 3600.0, (), "program"),)))
    assert not [a for a in result.alarms if a["detector"] == "model"]
    assert set(result.status[-8:, 0]) == {HEALTHY}
    assert [f for f in result.findings if f["kind"] == OPEN_ALARM] == []


@pytest.mark.long
def test_growth_that_another_program_takes_in_before_an_alarm_is_told():
    """An axis that had grown by 15 % the day before was healthy from the new program on, and 30 % worn at the end."""
    growth = np.zeros((260, 3))
    growth[197:, 1] = 0.15
    statistics, at = statistics_of(residuals(260, growth, 24)), 200 * 3600.0

    def told(*events):
        result = judge(statistics, 120, replace(SETTINGS, events=events))
        assert not [a for a in result.alarms if a["detector"] == "model"]
        return [(f["axes"], f["time"], "answered" in f) for f in result.findings if f["kind"] == GROWN_BEFORE]

    assert told(Event(at, (), "program")) == [([2], at, False)]
    assert told(Event(at, (), "program"), Event(at + 20 * 3600.0, (1,), "service")) == [([2], at, True)]


def test_a_service_after_another_program_does_not_deny_the_alarm_that_was_open_then():
    """It answers the finding; one before the change of program had closed the alarm."""
    statistics = statistics_of(residuals(40, np.zeros((40, 3)), 1))
    alarm = {"time": 10 * 3600.0, "axis": 1, "quantity": "coulomb friction", "detector": "model"}
    program, estimates = Event(20 * 3600.0, (), "program"), {"coulomb_percent": np.full((40, 3), 7.0)}

    def told(*hours):
        services = [Event(hour * 3600.0, (0,), "service") for hour in hours]
        events = sorted([program, *services], key=lambda e: e.time)
        return [f.get("answered", False) for f in open_alarm_findings(statistics, events, [alarm], estimates)]

    assert told() == [False]
    assert told(30) == [True]
    assert told(15) == []
    assert told(5) == [False]
    # The alarm is of the window from 9 to 10 h, and what begins anew of the one after a service.
    assert told(9.5) == []
    assert told(9) == [False]


@pytest.mark.long
@pytest.mark.parametrize("late", [-0.5, 0.0, 0.5])
def test_states_and_episodes_say_alike_whether_an_event_closed_an_alarm(late):
    growth = np.zeros((260, 3))
    growth[120:180, 1] = 0.1
    statistics = statistics_of(residuals(260, growth, 17))
    time = judge(statistics, 120, SETTINGS).alarms[0]["time"] + late * 3600.0
    events = (Event(time, (1,), "acknowledged"),)
    result = judge(statistics, 120, replace(SETTINGS, events=events))
    mine = [a for a in result.alarms if a["detector"] == "model" and a["axis"] == 2]
    open_ones = [e for e in episodes_of(mine, events, statistics.length) if e.resolved is None]
    assert mine
    assert (result.status[-1, 1] == CHANGED) is bool(open_ones)
    assert not open_ones


@pytest.mark.parametrize(
    ("change", "axes"), [((0.14, -0.12, 0.2), [1, 2, 3]), ((-0.14, -0.12, 0.2), None), ((0.2, 0.0, 0.0), None)]
)
def test_axes_that_rise_and_fall_within_two_shifts_are_told_as_one_cause(change, axes):
    growth = np.zeros((260, 3))
    growth[192:] = change
    found = judge(statistics_of(residuals(260, growth, 18)), 120, SETTINGS).findings
    told = [f for f in found if f["kind"] == "at_once"]
    assert [f["axes"] for f in told] == ([axes] if axes else [])
    if axes:
        assert "axes 1 and 3 rose and of axis 2 fell" in told[0]["words"]
        assert told[0]["time"] >= 192 * 3600.0


@pytest.mark.parametrize("length", [24, 48, 96])
def test_logs_of_another_robot_are_told_as_that_and_as_no_wear(length):
    growth = np.zeros((360, 3))
    growth[192 : 192 + length] = (0.14, -0.12, 0.2)
    result = judge(statistics_of(residuals(360, growth, 19)), 120, SETTINGS)
    assert [a for a in result.alarms if a["detector"] == "model"] == []
    told = [f for f in result.findings if f["kind"] == "at_once"]
    assert told[0]["time"] == 192 * 3600.0
    assert "logs of another robot" in told[0]["words"]
    assert "these windows are not judged" in told[0]["words"]
    assert (result.status[-8:] == HEALTHY).all()


def six_axes(n=300):
    """A watched level of six axes in `n` windows that nothing happens to, labels of the shifts and the baseline."""
    axis = SimpleNamespace(
        fit=SimpleNamespace(left_out_variance=np.full(4, 1e-5)), dispersion=SimpleNamespace(between=0.005)
    )
    level = SimpleNamespace(axes=[axis] * 6, residual=np.zeros((n, 6)), noise=np.full((n, 6), 1e-4))
    return level, np.arange(n) // 8, np.arange(n) < 96


def test_five_axes_of_which_one_rises_are_another_robot():
    level, shift, baseline = six_axes()
    level.residual[192:, :5] = (-0.1, -0.1, -0.1, -0.1, 0.1)
    # A shift in which nothing can be judged lies between the two that show it.
    level.residual[200:208] = np.nan
    found = first_exchange(level, shift, baseline)
    assert (found.window, found.end, found.rose, found.fell) == (192, None, (4,), (0, 1, 2, 3))
    running = SimpleNamespace(axes=level.axes, residual=level.residual[:196], noise=level.noise[:196])
    assert first_exchange(running, shift[:196], baseline[:196]) == found
    level.residual[192:, 0] = 0.0
    assert first_exchange(level, shift, baseline) is None


def test_wear_that_goes_on_beside_a_fall_of_five_axes_is_no_other_robot():
    level, shift, baseline = six_axes()
    level.residual[192:, :5] = -0.1
    level.residual[:, 5] = 0.06 * np.maximum(shift - 19, 0)
    assert first_exchange(level, shift, baseline) is None
    level.residual[:, 5] = 0.06 * (shift >= 24)
    assert first_exchange(level, shift, baseline) is not None


def test_wear_is_told_over_the_logs_of_another_robot():
    growth = np.zeros((360, 3))
    growth[168:, 1] = 0.15
    growth[216:264] = (0.14, -0.12, 0.2)
    result = judge(statistics_of(residuals(360, growth, 20)), 120, SETTINGS)
    assert {a["axis"] for a in result.alarms if a["detector"] == "model"} == {2}
    assert [f["axes"] for f in result.findings if f["kind"] == "at_once"] == [[1, 2, 3]]
    told = result.estimates["coulomb_percent"]
    assert np.isnan(told[220:260]).all()
    assert np.median(told[-24:, 1]) == pytest.approx(15.0, abs=2.0)


def test_a_service_that_is_told_raises_no_alarm_and_wear_after_it_does():
    growth = np.zeros((420, 3))
    growth[200:, 0] = -0.15
    growth[320:, 0] += 0.15 * np.arange(100) / 100
    statistics = statistics_of(residuals(420, growth, 21))
    told = judge(statistics, 120, replace(SETTINGS, events=(Event(200 * 3600.0, (), "service"),)))
    alarms = [a for a in told.alarms if a["detector"] == "model"]
    assert {a["axis"] for a in alarms} == {1}
    assert alarms[0]["time"] > 320 * 3600


def test_a_fall_of_friction_starts_the_viscous_part_anew_too(monkeypatch):
    watched = []
    monkeypatch.setattr(judge_module, "watch", lambda *a, **k: watched.append(watch(*a, **k)) or watched[-1])
    growth = np.zeros((320, 3))
    growth[200:, 1] = -0.3
    judge(statistics_of(residuals(320, growth, 22)), 120, SETTINGS)
    viscous = watched[-1]
    assert [s.window for s in viscous.starts[1]] == [200]
    assert viscous.learning[200:210, 1].all()
    assert not viscous.learning[:, [0, 2]].any()


def test_all_axes_at_once_are_a_finding_and_no_wear():
    growth = np.zeros((240, 6))
    growth[160:] = 0.08
    result = shared_error(growth, np.full((240, 6), 1e-4), np.arange(240) < 120, np.arange(240) // 24)
    assert np.allclose(result.value[200:], 0.08, atol=0.02)
    assert (np.abs(result.value[:120]) < 1e-6).all()


def test_thicker_oil_adds_to_the_viscous_part_of_each_axis_its_share_of_it(monkeypatch):
    share, variance = np.array([0.6, 0.1, 0.3, 0.05, 0.5, 0.2]), np.full((240, 6), 1e-6)
    part = np.zeros((240, 6))
    part[160:] = 0.1 * share
    baseline, shift = np.arange(240) < 120, np.arange(240) // 24
    found = shared_error(part, variance, baseline, shift, unit=share)
    assert np.allclose(found.value[200:], 0.1 * share, rtol=0.1)
    assert np.allclose(found.common[200:], 0.1, rtol=0.1)
    # Held to one size for all axes, the fastest one would look worn.
    assert part[-1, 0] - shared_error(part, variance, baseline, shift).value[170, 0] > 0.02
    units = []
    monkeypatch.setattr(judge_module, "watch", lambda *a, **k: units.append(a[2].unit) or watch(*a, **k))
    judge(statistics_of(residuals(200, np.zeros((200, 3)), 23)), 120, SETTINGS)
    assert units[-1] == pytest.approx(VISCOUS * 0.6 / (VISCOUS * 0.6 + [8.0, 2.0, 1.25]), rel=0.2)


def test_a_rise_of_viscous_friction_beside_a_fallen_level_is_new_grease():
    level = SimpleNamespace(
        axes=[1, 1, 1], mean=np.array([[-0.03, -0.01, 0.0]]), mean_std=np.array([[0.01, 0.01, np.inf]]),
        shared=SimpleNamespace(common=np.zeros(1)),
    )  # fmt: skip
    viscous = SimpleNamespace(alarm=np.ones((1, 3), dtype=bool))
    told = Teller._viscous_alarm(SimpleNamespace(_level=level, _viscous=viscous))
    assert told.tolist() == [[False, True, True]]


def test_an_alarm_that_stays_as_it_is_is_told_once_a_week():
    growth = np.zeros((200, 3))
    growth[120:, 0] = 0.1
    result = judge(statistics_of(residuals(200, growth, 13)), 120, SETTINGS)
    mine = [a for a in result.alarms if a["detector"] == "model"]
    assert [a["axis"] for a in mine] == [1]
    assert set(result.status[130:, 0]) == {CHANGED}


def test_a_robot_without_friction_parameters_grows_from_its_own_baseline():
    growth = np.ones((200, 3))
    growth[120:, 1] = 1.2
    none = JudgeSettings(coulomb=np.zeros((3, 2)), viscous=np.zeros(3))
    result = judge(statistics_of(residuals(200, growth, 18)), 120, none)
    assert result.estimates["coulomb_percent"][-40:, 1].mean() == pytest.approx(20, abs=3)
    assert {a["axis"] for a in result.alarms if a["detector"] == "model"} == {2}
    assert result.estimates["coulomb"][-40:, 1].mean() == pytest.approx(0.4, abs=0.05)


def test_no_baseline_yet_is_no_judgement():
    statistics = statistics_of(residuals(40, np.zeros((40, 3)), 19))
    result = judge(statistics, np.zeros(40, dtype=bool), SETTINGS)
    assert not result.alarms
    assert (result.status == UNJUDGED).all()


def test_viscous_wear_is_told_as_such_in_estimates_and_alarms():
    growth = np.zeros(220)
    growth[120:] = 0.8 * np.arange(100) / 100
    extra = growth[:, None, None] * VISCOUS * motion()[..., 2] * np.array([1.0, 0.0, 0.0])
    result = judge(statistics_of(residuals(220, np.zeros((220, 3)), 23, extra)), 120, SETTINGS)
    mine = [a for a in result.alarms if a["detector"] == "model"]
    assert {(a["axis"], a["quantity"]) for a in mine} == {(1, VISCOUS_FRICTION)}
    # In percent of the viscous friction of the normal period, though the change has another unit.
    assert mine[-1]["unit"] == "N m s/rad"
    assert mine[-1]["growth_percent"] == pytest.approx(100 * mine[-1]["change"] / VISCOUS[0], rel=0.1)
    # The level leaves viscous friction out as it was: what it takes of this growth is not known.
    assert np.isnan(result.estimates["coulomb_percent"][-24:, 0]).all()
    assert np.isfinite(result.estimates["coulomb_percent"][-24:, 1]).all()
    assert (result.grown[0], result.limits[0].quantity) == (VISCOUS_FRICTION, VISCOUS_FRICTION)
