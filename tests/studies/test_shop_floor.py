"""The shop floor: its physics, what it draws, the short way to window statistics against files, and its scores."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.files.json_documents import read_json, write_json
from jointwear.measurement.formats import layout_of
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.windows import merge
from jointwear.publishing.report.study_page import write_study_page
from jointwear.studies.shop_floor import aims, figures, gap_sample, sample, stages
from jointwear.studies.shop_floor.arms import ARM_TYPES, HEAVY, LIGHT, robot_data
from jointwear.studies.shop_floor.cell import draw_cell
from jointwear.studies.shop_floor.closed_loop import SAMPLES, Runs, at_phase, draw_controller, drive
from jointwear.studies.shop_floor.confounders import CONFOUNDERS, SCENARIOS, scenario_of
from jointwear.studies.shop_floor.fast_path import nominal_robot, statistics_of, survey_of
from jointwear.studies.shop_floor.gear import SHAPES, Wear, draw_gear
from jointwear.studies.shop_floor.heat import draw_body, warm
from jointwear.studies.shop_floor.judging import outcome
from jointwear.studies.shop_floor.log_files import write_fleet, write_robot_logs
from jointwear.studies.shop_floor.month import DAY, HOURS
from jointwear.studies.shop_floor.plan import FIRST, REPORTED, batch_of, batches, robots_of
from jointwear.studies.shop_floor.plant_entry import entry_of
from jointwear.studies.shop_floor.programs import Jobs, draw_program
from jointwear.studies.shop_floor.scores import (
    detection,
    false_alarms,
    forecasts,
    poisson_rate,
    rate_over_robots,
    summary,
)
from jointwear.studies.shop_floor.sensing import START

HOUR = 3600.0
BEFORE = Path(__file__).resolve().parents[2] / "data/studies/shop_floor/before.json"


def few_hours(cell, count):
    """The first windows of a robot alone."""
    part = slice(0, count)
    return replace(
        cell, logged=cell.logged[part], samples=cell.samples[part], still=cell.still[part], missing=cell.missing[part]
    )


@pytest.fixture(scope="module")
def quiet_cell():
    return few_hours(draw_cell("choose", 1, "none"), 10)


@given(shape=st.sampled_from(SHAPES), onset=st.floats(0, 500), duration=st.floats(168, 504), hour=st.floats(0, 720))
def test_wear_never_shrinks_and_is_full_at_its_end(shape, onset, duration, hour):
    wear = Wear(2, "coulomb", onset, duration, shape)
    assert wear.growth(np.array(onset + duration)) == pytest.approx(0.2)
    assert wear.growth(np.array(onset)) == 0.0
    assert wear.growth(np.array(hour)) <= wear.growth(np.array(hour + 1.0)) <= 0.2 * np.exp(3)


@given(seed=st.integers(0, 10_000), low=st.floats(0, 50), step=st.floats(0.5, 30))
def test_oil_thins_as_it_warms(seed, low, step):
    gear = draw_gear(LIGHT, np.random.default_rng(seed))
    cold, warm_ = gear.viscosity(np.full(6, low)), gear.viscosity(np.full(6, low + step))
    assert np.all(warm_ < cold)
    assert gear.viscosity(np.full(6, 25.0)) == pytest.approx(np.ones(6))


def test_gears_warm_up_in_a_shift_and_cool_in_the_night():
    random = np.random.default_rng(3)
    body, gear = draw_body(6, random), draw_gear(HEAVY, random)
    power = np.zeros((72, 6))
    power[(np.arange(72) % 24 >= 6) & (np.arange(72) % 24 < 22)] = 1.0
    oil, housing = warm(body, gear, power, np.full(72, 20.0))
    assert np.all(np.diff(oil[48 + 6 : 48 + 20], axis=0) > 0)
    assert np.all(oil[48 + 20] > 24.0)
    assert np.all(oil[71] < oil[70])
    assert np.all(oil[48 + 20] > housing[48 + 20])
    assert np.all(oil >= 20.0 - 1e-9)


@pytest.mark.parametrize("arm", ARM_TYPES.values(), ids=lambda a: a.name)
def test_the_motor_delivers_what_bodies_and_friction_take(arm):
    """Over a slow closed loop the mean torque times direction is friction; away from reversals it is exact."""
    random = np.random.default_rng(5)
    program = draw_program(arm, random)
    data = robot_data(arm, random)
    job = Jobs(arm, [program], data)(0, 0.0)
    gear, controller = draw_gear(arm, random), draw_controller(arm, random)
    n, warmth = 6, np.full((2, 6), 30.0)
    worn = np.ones((2, n))
    worn[1] = 1.25
    runs = Runs(np.zeros(2), np.ones(2), warmth, worn, np.ones((2, n)))
    driven = drive([job], np.array([0, 0]), gear, controller, runs)
    phase = np.arange(SAMPLES) / 50.0
    velocity = at_phase(program.velocity, phase)
    fast = np.abs(velocity) > 0.3 * np.abs(velocity).max(axis=0)
    assert np.abs(driven.deviation).max() < 0.05
    grown = (driven.torque[1] - driven.torque[0]) * np.sign(velocity)
    usual = 0.25 * gear.level(warmth[0]) * gear.coulomb.mean(axis=1)
    for j in range(n):
        # A quarter more boundary friction, a little raised by load and thin films.
        assert 0.95 < np.median(grown[fast[:, j], j]) / usual[j] < 1.7


def test_programs_close_and_their_derivatives_agree():
    program = draw_program(HEAVY, np.random.default_rng(8))
    assert np.allclose(program.position[0], program.position[-1], atol=1e-9)
    slope = np.gradient(program.position, 0.005, axis=0)
    assert np.abs(slope - program.velocity)[2:-2].max() < 0.02
    slope = np.gradient(program.velocity, 0.005, axis=0)
    assert np.abs(slope - program.acceleration)[2:-2].max() < 0.05 * np.abs(program.acceleration).max()
    assert program.carrying.min() >= 0.0
    assert program.carrying.max() == pytest.approx(1.0)


def test_a_robot_depends_on_its_seed_and_index_alone():
    once, again, other = draw_cell("choose", 7), draw_cell("choose", 7), draw_cell("report", 7)
    assert np.array_equal(once.oil, again.oil)
    assert once.wear == again.wear
    assert not np.array_equal(once.oil, other.oil)


def test_every_second_robot_has_all_confounders_and_the_others_take_turns():
    named = [scenario_of(k) for k in range(44)]
    assert named[::2] == ["all"] * 22
    assert set(named[1::2]) == set(SCENARIOS) - {"all"}
    assert len(CONFOUNDERS) == 10


@pytest.mark.parametrize("scenario", ["service", "sensor_gain", "running_in", "none"])
def test_factors_are_what_the_scenario_says(scenario):
    cell = draw_cell("choose", 3, scenario)
    cell = replace(cell, wear=None)
    coulomb, viscous, gain = cell.factors(np.array([1.0, HOURS - 1.0]))
    assert (coulomb[1] < 1).any() == (scenario == "service")
    assert (gain[1] != 1).any() == (scenario == "sensor_gain")
    assert (coulomb[0] > 1.04).any() == (scenario == "running_in")
    if scenario == "none":
        assert np.all(coulomb == 1)
        assert np.all(viscous == 1)


@pytest.mark.long
def test_service_never_touches_an_axis_that_has_begun_to_wear():
    for index in range(14):
        cell = draw_cell("choose", index, "all")
        for event in cell.events:
            assert cell.wear is None or event.hour < cell.wear.onset or cell.wear.axis not in event.axes


@pytest.mark.long
def test_the_short_way_gives_what_files_give(quiet_cell, tmp_path):
    survey = survey_of(quiet_cell)
    short = statistics_of(quiet_cell, survey)
    model = TorqueModel(nominal_robot(quiet_cell))
    layout = layout_of({}, model.robot.joint_names)
    paths = write_robot_logs(quiet_cell, tmp_path, range(1))
    read = merge([log_statistics(str(p), layout, model, survey, HOUR).statistics for p in paths])
    assert np.array_equal(short.start, read.start)
    assert np.array_equal(short.samples, read.samples)

    def level(s):
        """Both Coulomb levels of a plain regression, over the nominal one."""
        fit = np.einsum("wjpq,wjq->wjp", np.linalg.pinv(s.gram), s.moment)
        return fit[..., :2].mean(axis=-1) / np.array(quiet_cell.arm.coulomb)

    assert np.abs(level(short) - level(read)).max() < 0.015
    assert np.allclose(np.nan_to_num(short.temperature), np.nan_to_num(read.temperature), atol=1e-3)


@pytest.mark.long
def test_a_fleet_is_written_with_what_a_user_needs(tmp_path):
    config = write_fleet(tmp_path, "choose", [2, 3], days=range(2))
    entries = config["monitor"]["robots"]
    assert yaml.safe_load((tmp_path / "fleet.yaml").read_text()) == config
    for name, entry in entries.items():
        assert list((tmp_path / "logs" / name).glob("day_01*"))
        assert (tmp_path / entry["robot"]).exists()
        assert entry["baseline"]["until"] == "2026-03-09T00:00:00Z"


def test_only_events_that_were_told_are_in_the_config():
    for index in range(6):
        cell = draw_cell("choose", index, "all")
        told = entry_of(cell, 1.0).get("events", [])
        assert len(told) == sum(event.told for event in cell.events)


# ---------------------------------------------------------------------------------------------------------- scores


def record(hour, axis, low=None, middle=None, high=None, quantity="coulomb friction", detector="model", sure=0.9):
    return {
        "time": START + HOUR * hour, "axis": axis, "quantity": quantity, "detector": detector, "probability_axis": sure,
        "hours_to_limit_low": low, "hours_to_limit": middle, "hours_to_limit_high": high,
    }  # fmt: skip


@pytest.fixture(scope="module")
def worn():
    cell = replace(draw_cell("choose", 1, "none"), wear=Wear(3, "coulomb", 300.0, 240.0, "straight"))
    return few_hours(cell, HOURS)


class Windows:
    """What scoring needs of statistics."""

    def __init__(self, cell):
        self.end = START + HOUR * (cell.logged + 1.0)


def outcome_of(cell, records):
    windows = Windows(cell)
    status = np.full((len(windows.end), 6), "healthy", dtype=object)
    return outcome(cell, windows, 1.0, lambda s, entry, c: (records, status))


def test_alarms_before_the_onset_are_false_and_others_are_told_apart(worn):
    records = [
        record(200, 2),
        record(210, 2, detector="paper"),
        record(220, 0, quantity="scale of axis torques"),
        record(350, 5),
        record(400, 4, low=100, middle=140, high=None),
        record(430, 4, low=300, middle=310, high=320),
    ]
    facts = outcome_of(worn, records)
    assert [f[:2] for f in facts["false"]] == [[200.0, 2]]
    assert facts["quiet_hours"] == 300 - 7 * DAY
    assert facts["delay"] == 100.0
    assert facts["first_axis"] == 5
    assert facts["growth"] == pytest.approx(0.2 * 100 / 240)
    at_alarm, later = facts["forecasts"]
    assert at_alarm["held"]
    assert at_alarm["high"] is None
    assert not later["held"]
    assert later["true"] == pytest.approx(110.0)


@pytest.mark.parametrize(("others", "own", "named"), [(0.8, 0.9, True), (0.99, 0.9, False), (float("nan"), 0.4, True)])
def test_the_axis_is_named_if_it_is_the_likeliest_when_it_is_found(worn, others, own, named):
    records = [
        record(350, 5, sure=1.0),
        record(380, 5, sure=others),
        record(400, 4, sure=own),
        record(430, 5, sure=1.0),
    ]
    facts = outcome_of(worn, records)
    assert facts["likeliest"] is named
    assert detection([facts])["named"]["count"] == named
    assert detection([facts])["right"]["count"] == 0


def test_an_axis_that_is_not_found_counts_as_missed(worn):
    facts = outcome_of(worn, [record(700, 4)])
    assert detection([facts])["found"]["count"] == 0
    assert detection([facts])["right"]["count"] == 1
    none = outcome_of(worn, [])
    assert none["delay"] is None
    assert forecasts([none], 0)["held"]["of"] == 0


@given(count=st.integers(0, 200), hours=st.floats(10, 1e5))
@settings(max_examples=50)
def test_poisson_interval_holds_its_estimate(count, hours):
    rate = poisson_rate(count, hours)
    assert rate["low"] <= rate["per_1000_h"] <= rate["high"]
    assert (rate["low"] == 0) == (count == 0)


def test_poisson_interval_is_garwoods():
    rate = poisson_rate(3, 1000)
    assert rate["low"] == pytest.approx(0.6187, abs=1e-3)
    assert rate["high"] == pytest.approx(8.7673, abs=1e-3)


def test_alarms_that_come_together_widen_the_interval_over_robots():
    hours = np.full(100, 200.0)
    apart, together = np.r_[np.ones(20), np.zeros(80)], np.r_[np.full(4, 5.0), np.zeros(96)]
    rate = poisson_rate(20, hours.sum())
    alone, crowded = rate_over_robots(apart, hours), rate_over_robots(together, hours)
    for spread in (alone, crowded):
        assert spread["robots_low"] < rate["per_1000_h"] < spread["robots_high"]
    widths = [x["robots_high"] - x["robots_low"] for x in (alone, crowded)]
    assert widths[0] < 1.2 * (rate["high"] - rate["low"]) < widths[1]
    assert rate_over_robots(together, hours) == crowded


def test_one_robot_with_alarms_tells_no_scatter():
    assert rate_over_robots([3, 0, 0], [100.0, 100.0, 100.0]) == {"robots_low": None, "robots_high": None}


def test_false_alarms_count_robots_and_axes(worn):
    one, two = outcome_of(worn, [record(200, 2), record(230, 2), record(231, 3)]), outcome_of(worn, [])
    found = false_alarms([one, two])
    assert (found["count"], found["alarmed"], found["axes"], found["robots"]) == (3, 1, 2, 2)


def test_chapter_and_figures_are_made_of_outcomes(worn, tmp_path):
    facts = [outcome_of(worn, [record(200, 2), record(400, 4, 100, 140, 200)]) | {"refused": ""}]
    scores = summary(facts)
    assert "found 1 of 1" in sample.table(scores)
    cell = {"axis": 1, "increase": 10.0, "moves": True, "runs": 2, "detected": 1, "named": 1, "hour": 60.0}
    grid = stages.paper_grid({"T1": {"cells": [cell, {**cell, "moves": False}], "false": 1, "hours": 500, "rate": 0.3}})
    assert (grid["cells"], grid["whole"], grid["missed"]) == (1, 0, ["T1 axis 1, 10 %"])
    curve = {"days": [0.0, 14.0], "found": [0.0, 1.0]}
    chapter = {
        "rates": [scores | {"rate": r} for r in (0.3, 1.0, 3.0)], "curves": [{"rate": 1.0, **curve}], "refused": 1,
        "before": [scores], "grid": grid,
        "aims": aims.aims([scores]),
    }  # fmt: skip
    path = tmp_path / "chapter.json"
    path.write_text(json.dumps(chapter))
    pictures = []
    for name, draw in figures.DRAWINGS.items():
        draw(path, tmp_path / f"{name}.svg")
        pictures.append(tmp_path / f"{name}.svg")
    write_study_page("shop_floor", path, pictures, tmp_path / "index.html")
    page = (tmp_path / "index.html").read_text()
    assert page.count("<svg") == 2
    assert "None" not in page


def test_outcomes_of_batches_and_the_shipped_scores_of_before_make_a_chapter(worn, tmp_path):
    facts = [
        outcome_of(worn, [record(200, 2), record(400, 4, 100, 140, 200)]) | {"refused": "", "rate": rate}
        for rate in (0.3, 1.0, 3.0)
    ]
    batch, grid, output = tmp_path / "003.json", tmp_path / "T1.json", tmp_path / "chapter.json"
    write_json(batch, {"facts": facts})
    cell = {"axis": 1, "increase": 10.0, "moves": True, "runs": 2, "detected": 1, "named": 1, "hour": 60.0}
    write_json(grid, {"cells": [cell], "false": 1, "hours": 500, "rate": 0.3, "replicates": 1})
    stages.summarise([batch], BEFORE, {"T1": grid}, output)
    chapter = read_json(output)
    assert [r["rate"] for r in chapter["rates"]] == [0.3, 1.0, 3.0]
    assert chapter["before"][0]["false"]["count"] > 0


def test_aims_are_held_to_the_intervals(worn):
    good = summary([outcome_of(worn, [record(340, 4, 100, 200, 300)])])
    rows = {row["words"]: row for row in aims.aims([good])}
    assert [row["reached"] for row in rows.values()] == [True, True, True, True, False, None]
    late = summary([outcome_of(worn, [record(200 + k, 2) for k in range(9)] + [record(400, 4)])])
    assert [row["reached"] for row in aims.aims([late])][:3] == [False, True, False]


def test_batches_cover_every_robot_once():
    covered = [k for batch in batches() for k in robots_of(batch)]
    assert covered == list(range(FIRST, FIRST + REPORTED))
    assert all(k in robots_of(batch_of(k)) for k in covered)


def test_the_simulator_is_apart_from_the_effects_and_the_reproduction():
    folder = Path(draw_cell.__code__.co_filename).parent
    for path in folder.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert "jointwear.effects" not in text
        assert "jointwear.reproduction" not in text


def test_backlash_is_printed_with_when_and_at_which_gap_or_why_it_cannot_be_judged(monkeypatch, capsys):
    rows = iter(
        [
            {"robot": "a", "arm": "x", "delay": 12.0, "at": 0.06, "others": [], "pulses": 40.0, "reason": ""},
            {"robot": "b", "arm": "y", "delay": None, "at": None, "others": [2], "pulses": np.nan, "reason": "light"},
        ]
    )
    asked = []
    monkeypatch.setattr(gap_sample, "gap_outcome", lambda *given: asked.append(given) or next(rows))
    gap_sample.main(["--robots", "1", "3", "--axis", "2", "--gap", "1.5"])
    told, silent = capsys.readouterr().out.splitlines()
    assert asked == [("choose", 1, 1, 0.0015), ("choose", 3, 1, 0.0015)]
    assert told == "a (x): told after 12 h, at 0.06 mrad; pulses +40 %; others []"
    assert "not told" in silent
    assert "light" in silent
