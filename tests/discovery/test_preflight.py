"""The check of a recording before discovery: what its motion shows, and what is wrong with it."""

import json
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from discovery_cases import make_case, wave
from monitor_logs import columns, make_log, write_csv

from jointwear.discovery import Settings, posing
from jointwear.discovery.pipeline import discover
from jointwear.discovery.preflight import check_data, write_check
from jointwear.discovery.stages import discover_dataset
from jointwear.files.errors import InputError
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording, write_recording
from jointwear.measurement.refused import Refused
from jointwear.measurement.shortened import shortened


@pytest.fixture(scope="module")
def case(robot):
    return make_case(robot, 21, wave)


def test_the_check_says_what_the_motion_shows(case, robot, tmp_path):
    check = check_data(replace(case, temperature=None), robot)
    assert check.rate_hz == pytest.approx(100.0)
    assert [t.role for t in check.trajectories] == ["train"] * 3 + ["test"]
    assert check.joints[0].encoder_step == pytest.approx(2e-6, rel=0.01)
    assert ("position_dependent_friction", 3) in {(s.effect, s.axis) for s in check.shown}
    assert {(s.axis is None, s.unit) for s in check.shown} == {
        (True, "kg"),
        (True, "rad"),
        (False, "share of the friction of the joint"),
    }
    reasons = {(s.effect, s.axis): s.reason for s in check.not_shown}
    assert "temperature" in reasons["torque_constant_temperature", None]
    assert any("temperature" in line for line in check.advice)
    still = case.position.copy()
    still[:, 5] = still[0, 5]
    assert any("Move joint 6" in line for line in check_data(replace(case, position=still), robot).advice)


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


@pytest.mark.parametrize("units", [{"position": "deg"}, {"position": "furlong"}])
def test_the_check_and_discovery_refuse_in_the_same_words(case, tmp_path, units):
    write_recording(split(case), tmp_path / "case.nc", {"dataset": "case"})
    entry, robot = {"measured": str(tmp_path / "case.nc"), "units": units}, "config/robots/puma560.yaml"
    with pytest.raises(InputError):
        discover_dataset("case", entry, robot, tmp_path)
    write_check("case", entry, robot, Settings(), tmp_path / "check.json", tmp_path / "check.html")
    refused, check = (json.loads((tmp_path / name).read_text()) for name in ("refused.json", "check.json"))
    assert refused["reason"] == check["refused"] != ""
    assert refused["suggestion"] == check["suggestion"] != ""


def test_a_refusal_tells_what_was_left_out_of_the_file(robot, tmp_path):
    """A quotation mark that is not closed took nearly all lines with it, and only the few that were left were told."""
    log = make_log(20.0, rate=20.0)
    lines = write_csv(tmp_path / "a.csv", columns(log)).read_text().splitlines()
    torn = ",".join(['"', *lines[30].split(",")[1:-1]])
    (tmp_path / "a.csv").write_text("\n".join([*lines[:30], torn, *lines[31:]]) + "\n")
    with pytest.raises(Refused) as refused:
        check_data(load_recording({"measured": str(tmp_path / "a.csv")}, "a"), robot)
    assert str(refused.value).startswith("data set 'a': has 29 samples; at least 40 are needed (as it was read, row 31")
    assert "more lines with it" in refused.value.reason
    assert refused.value.suggestion == "record longer"


def test_motion_that_is_too_little_names_its_data_set(case, robot):
    still = replace(case, position=np.tile(case.position[:1], (len(case.time), 1)), name="arm 7")
    with pytest.raises(Refused, match=r"^data set 'arm 7': no axis moves"):
        check_data(still, robot)


def test_the_page_has_shares_in_percent_and_other_sizes_in_their_unit(case, robot, tmp_path):
    write_recording(split(case), tmp_path / "case.nc", {"dataset": "case"})
    page = tmp_path / "check.html"
    entry = {"measured": str(tmp_path / "case.nc")}
    found = write_check("case", entry, "config/robots/puma560.yaml", Settings(), tmp_path / "check.json", page)
    shown = {(s.effect, s.axis): s.smallest_size for s in found.shown}
    text = page.read_text()
    assert f"whole arm: {shown['payload', None]:.2g} kg" in text
    assert f"<td>{100 * shown['position_dependent_friction', 3]:.2g}&nbsp;%</td>" in text


def test_it_is_told_of_which_motors_the_file_has_no_inertia(case, robot):
    def told(robot, **other):
        found = posing.pose_problem(replace(split(case), **other), robot, Settings()).restrictions
        return [line for line in found if "no motor inertia of" in line]

    assert (
        "no motor inertia of joints 1, 2, 3, 4, 5 and 6, as a URDF has none" in told(robot.without_motor_inertia())[0]
    )
    some = np.where(np.arange(robot.joints) == 2, 0.0, robot.armature)
    assert "no motor inertia of joint 3, as" in told(replace(robot, armature=some))[0]
    assert not told(robot)
    assert not told(robot.without_motor_inertia(), torque_kind="link_sensor")


def test_the_page_has_one_row_an_effect_and_one_column_a_joint(case, robot, tmp_path):
    write_recording(split(case), tmp_path / "case.nc", {"dataset": "case"})
    outputs = tmp_path / "check.json", tmp_path / "check.html"
    write_check("case", {"measured": str(tmp_path / "case.nc")}, "config/robots/puma560.yaml", Settings(), *outputs)
    shown = json.loads(outputs[0].read_text())["shown"]
    page = outputs[1].read_text()
    table = page[page.index("Effects that this motion can show") :]
    rows = re.findall(r'<tr><th scope="row" class="left">(.*?)</th>(.*?)</tr>', table)
    assert len(rows) == len({s["effect"] for s in shown}) > 5
    columns = {effect: cells.count("<td>") for effect, cells in rows}
    assert columns["position-dependent friction"] == 6
    assert "whole arm" in dict(rows)["payload"]
    assert columns["payload"] == 0
    assert "Discovery accepts these data" in page
    assert f"This motion shows {len(rows)} effects of the library" in page


@pytest.mark.long
def test_the_check_of_a_long_recording_reads_a_part_of_it_and_lists_all(case, robot, monkeypatch):
    short = partial(shortened, most=len(case.time) // 2)
    monkeypatch.setattr(posing, "shortened", short)
    check = check_data(case, robot)
    assert any("are read, which is as much as a search takes in" in line for line in check.restrictions)
    assert sum(t.samples for t in check.trajectories) == len(case.time)
    found = discover(case, robot)
    assert len(found.recording.time) <= len(case.time) // 2
    assert any("as much as a search takes in" in line for line in found.content.restrictions)
