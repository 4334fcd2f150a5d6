"""How discovery decides: gates in N m, groups of recordings, models put back, what a failed search leaves."""

import json
from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery import Settings, discover, pipeline
from jointwear.discovery.crossval import positive
from jointwear.discovery.fallback import left_out_ratio
from jointwear.discovery.leftovers import lasting, unexplained
from jointwear.discovery.page import body_in_words, lead, write_page
from jointwear.discovery.preflight import check_data, write_check
from jointwear.discovery.settings import settings_of
from jointwear.discovery.stages import discover_dataset
from jointwear.files.errors import InputError
from jointwear.measurement.checks import Refused
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import write_recording
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


def wave(q, v, *_):
    """Friction that varies over the travel of joint 3."""
    full = np.zeros_like(q)
    full[:, 2] = 0.8 * np.sin(3 * q[:, 2] + 1) * np.sign(v[:, 2])
    return full


@pytest.fixture(scope="module")
def case(robot):
    return make_case(robot, 21, wave)


@pytest.fixture(scope="module")
def found(case, robot):
    groups = (("monday", (0,)), ("tuesday", (1, 2)))
    return discover(case, robot, Settings(groups=groups))


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=40))
def test_signed_ranks_are_symmetric_and_free_of_scale(values):
    values = np.array(values) + 1e-3 * np.arange(1, len(values) + 1)
    values = values[values != 0]
    if not len(values) or len(np.unique(np.abs(values))) < len(values):
        return
    assert positive(values) == pytest.approx(1 - positive(-values))
    assert positive(3.0 * values) == pytest.approx(positive(values))


def test_signed_ranks_see_what_is_strong_in_few_blocks():
    rng = np.random.default_rng(3)
    blocks = rng.normal(0.05, 0.05, 40)
    blocks[:3] = 50.0
    assert positive(blocks) > 0.99
    assert positive(rng.normal(0.0, 1.0, 40)) < 0.99


def test_a_name_says_how_sure_it_is(found):
    (effect,) = found.effects
    assert (effect["effect"], effect["axis"]) == ("position_dependent_friction", 3)
    assert effect["lowers_error"] > 0.99
    assert effect["gain_share"] > 1.0
    assert 0.5 < effect["probability"] <= 1.0
    # Monday and Tuesday each show it alone.
    assert effect["repeated"] == 1.0
    assert found.data["to_the_noise"]
    assert "nothing beyond the noise is left" in " ".join(lead(found.data))


def test_the_page_does_not_claim_the_noise_where_it_is_not_reached(found):
    content = {**found.data, "to_the_noise": False}
    content["gap"] = {**content["gap"], "augmented": [2.0 * f for f in content["gap"]["noise_floor"]]}
    text = " ".join(lead(content))
    assert "nothing beyond the noise" not in text
    assert "2 times on joint 1" in text


def test_the_augmented_robot_is_better_on_records_left_out(found):
    final = found.final
    ratio = left_out_ratio(final.outcome.white, final.fit.terms)
    assert np.all(ratio <= found.problem.settings.not_worse)
    assert ratio[2] < 0.5
    assert left_out_ratio(final.outcome.white, []) == pytest.approx(1.0)


def test_groups_name_trajectories_of_the_data(case, robot):
    with pytest.raises(InputError, match=r"'group\.b' holds trajectory 9"):
        discover(case, robot, settings_of({"group": {"a": [0], "b": [9]}}))
    with pytest.raises(InputError, match="which is in 'a' too"):
        discover(case, robot, settings_of({"group": {"a": [0], "b": [0]}}))


def test_a_failed_search_leaves_a_verdict_and_a_page(case, tmp_path, monkeypatch):
    def fails(problem):
        raise np.linalg.LinAlgError("not positive definite")

    monkeypatch.setattr(pipeline, "search", fails)
    write_recording(split(case), tmp_path / "case.nc", {"dataset": "case"})
    entry = {"measured": str(tmp_path / "case.nc"), "robot": "config/robots/puma560.yaml"}
    discover_dataset("case", entry, entry["robot"], tmp_path, tmp_path / "log")
    written = json.loads((tmp_path / "verdict.json").read_text())
    assert written["verdict"] == "unknown"
    assert "not positive definite" in written["misfits"][0]
    assert "not positive definite" in (tmp_path / "log").read_text()
    assert written["gap"]["augmented"] == pytest.approx(written["gap"]["nominal"], rel=1e-4)
    pages = [tmp_path / name for name in ("verdict.json", "where.nc", "models.nc", "page.html")]
    write_page(*pages, tmp_path / "figures")
    assert "The search ended in an error".lower() in pages[-1].read_text().lower()


def test_the_check_says_what_the_motion_shows(case, robot, tmp_path):
    check = check_data(replace(case, temperature=None), robot)
    assert check.rate_hz == pytest.approx(100.0)
    assert [t.role for t in check.trajectories] == ["train"] * 3 + ["test"]
    assert check.joints[0].encoder_step == pytest.approx(2e-6, rel=0.01)
    assert ("position_dependent_friction", 3) in {(s.effect, s.axis) for s in check.shown}
    reasons = {(s.effect, s.axis): s.reason for s in check.not_shown}
    assert "temperature" in reasons["torque_constant_temperature", None]
    assert any("temperature" in line for line in check.advice)
    still = case.position.copy()
    still[:, 5] = still[0, 5]
    assert any("Move joints 6" in line for line in check_data(replace(case, position=still), robot).advice)


def test_the_check_of_a_wrong_recording_says_so_and_stops_nothing(case, robot, tmp_path):
    wrong = replace(split(case), position=np.degrees(case.position))
    with pytest.raises(Refused):
        check_data(wrong, robot)
    write_recording(wrong, tmp_path / "case.nc", {"dataset": "case"})
    entry = {"measured": str(tmp_path / "case.nc")}
    outputs = tmp_path / "check.json", tmp_path / "check.html"
    write_check("case", entry, "config/robots/puma560.yaml", Settings(), *outputs)
    assert "look like degrees" in json.loads(outputs[0].read_text())["refused"]
    assert "look like degrees" in outputs[1].read_text()


def test_a_load_is_given_as_a_body():
    mass, x, z = 2.0, 0.1, 0.2
    value = {"mass": mass, "moment_x": mass * x, "moment_y": 0.0, "moment_z": mass * z}
    value |= {"xx": 0.01 + mass * z**2, "yy": 0.02 + mass * (x**2 + z**2), "zz": 0.03 + mass * x**2}
    words = body_in_words({"parameters": {name: {"value": v} for name, v in value.items()}})
    assert words.startswith("2 kg with its centre of mass at (100, 0, 200) mm in the frame of the last link")
    assert "0.01, 0.02, 0.03 kg m2" in words
    assert body_in_words({"parameters": {"level": {"value": 1.0}}}) == ""


def test_one_sample_that_jumps_is_no_structure(found):
    outcome = found.final.outcome
    white, axis = outcome.white, 4
    rows = white.whiteners[axis].rows
    before = unexplained(outcome)[0]
    targets = [y.copy() for y in white.targets]
    targets[axis][np.argmax(white.axis_state(axis).torque[rows, axis])] += 100.0
    jumped = replace(outcome, white=replace(white, targets=targets))
    jumped.unexplained = unexplained(jumped)[0]
    assert {u.axis for u in jumped.unexplained} == {axis} | {u.axis for u in before}
    assert [(u.axis, u.argument) for u in lasting(jumped)] == [(u.axis, u.argument) for u in before]
