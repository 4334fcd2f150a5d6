"""Measured data of real robots: the wrist of the Staubli TX40 in both directions, and what the Kinova allows."""

import json

import numpy as np
import pytest
import yaml

from jointwear.discovery import Settings, discover, load_recording
from jointwear.discovery.model.written_robot import simulate_robot
from jointwear.discovery.presentation.page import compare_published, joint_table, write_page
from jointwear.discovery.stages import discover_dataset
from jointwear.files.documents import read_yaml
from jointwear.files.errors import InputError
from jointwear.files.storage import read_variables
from jointwear.robots.robot import load_robot
from jointwear.running.shipped import shipped

pytestmark = pytest.mark.real


def entry_of(file, name):
    with open(f"config/examples/{file}", encoding="utf-8") as stream:
        entry = yaml.safe_load(stream)["discover"]["datasets"][name]
    return {**entry, "measured": shipped(entry["measured"])}


@pytest.mark.parametrize("name", ["staubli_tx40", "staubli_tx40_backward"])
def test_staubli_wrist_is_coupled(name):
    entry = entry_of("discover_staubli.yaml", name)
    verdict = discover(load_recording(entry, name), load_robot(entry["robot"]), Settings(entry["inertial_prior"]))
    found = {(e["effect"], e["axis"], e["source_axis"]) for e in verdict.effects}
    assert {("drive_coupling", 5, 6), ("drive_coupling", 6, 5)} <= found
    gap = verdict.data["gap"]
    assert gap["retuned"][4] > 3.0 * gap["augmented"][4]
    # Retuned alone leaves what the given robot leaves.
    assert gap["retuned"][5] <= 1.05 * gap["nominal"][5]
    assert gap["retuned"][5] > 1.9 * gap["augmented"][5]


def test_kinova_says_that_temperature_and_recordings_coincide():
    entry = entry_of("discover_kinova.yaml", "kinova_gen3")
    verdict = discover(
        load_recording(entry, "kinova_gen3"), load_robot(entry["robot"]), Settings(entry["inertial_prior"])
    )
    assert "temperature of joints" in " ".join(verdict.data["restrictions"])


def test_the_stage_writes_the_verdict_of_the_library(tmp_path):
    entry = entry_of("discover_staubli.yaml", "staubli_tx40")
    robot = entry["robot"]
    d = tmp_path
    found = discover_dataset("staubli_tx40", entry, robot, d)
    direct = found.data
    written = json.loads((d / "verdict.json").read_text())
    assert written["verdict"] == direct["verdict"]
    assert [e["effect"] for e in written["effects"]] == [e["effect"] for e in direct["effects"]]
    # The gap is that of the robot files as they were written.
    measured = found.problem.measured
    for kind, path in (("retuned", "retuned.yaml"), ("augmented", "robot.yaml")):
        np.testing.assert_allclose(simulate_robot(load_robot(d / path), measured)[0], found.torques[kind], atol=1e-6)
        np.testing.assert_allclose(read_variables(d / "models.nc", kind)[0], found.torques[kind])
    # A fit without effects misses the coupled wrist however free its parameters are.
    assert written["free_identification"][4] > 2.0 * written["gap"]["augmented"][4]
    published = "data/published/staubli_tx40.yaml"
    write_page(d / "verdict.json", d / "where.nc", d / "models.nc", d / "page.html", d / "figures", published)
    page = (d / "page.html").read_text(encoding="utf-8")
    assert "fvm6" in page
    rows = {(r["axis"], r["parameter"]): r for r in compare_published(written, read_yaml(published))}
    assert rows[5, "viscous"]["found"] == pytest.approx(rows[5, "viscous"]["value"], rel=0.3)
    joints = {row["axis"]: row for row in joint_table(written)}
    assert joints[5]["better"] > 3.0
    assert joints[5]["named"] == ["drive coupling from joint 6"]


def test_a_refused_data_set_leaves_its_reason(tmp_path):
    entry = entry_of("discover_staubli.yaml", "staubli_tx40") | {"units": {"position": "deg"}}
    kinova = entry_of("discover_kinova.yaml", "kinova_gen3")
    with pytest.raises(InputError, match="has 7 joints"):
        discover_dataset("wrong", kinova, entry["robot"], tmp_path)
    content = json.loads((tmp_path / "refused.json").read_text())
    assert set(content) == {"dataset", "reason", "suggestion"}
    assert not (tmp_path / "recording.nc").exists()


def test_a_bag_of_a_real_arm_is_read_with_the_arm_of_a_package():
    recording = load_recording(entry_of("discover_ur10.yaml", "ur10"), "ur10")
    assert recording.position.shape == (3441, 6)
    assert recording.time[-1] == pytest.approx(27.52)


def test_friction_of_the_ur10_has_another_shape_on_its_first_joint():
    entry = entry_of("discover_ur10.yaml", "ur10")
    verdict = discover(load_recording(entry, "ur10"), load_robot(entry["robot"]), Settings(entry["inertial_prior"]))
    shapes = {"nonlinear_viscous_friction", "stribeck_friction"}
    named = {(e["effect"], e["axis"]) for e in verdict.effects}
    assert {effect for effect, axis in named if axis == 1} & shapes
    assert not any(axis in (2, 6) for _, axis in named)
    # The robot file knows no friction: retuning alone has to find that of the wrist.
    gap = verdict.data["gap"]
    assert all(r < 0.15 * n for r, n in zip(gap["retuned"][3:], gap["nominal"][3:], strict=True))
