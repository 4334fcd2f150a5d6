"""Payloads, gears, motors and friction that no arm has are refused with what they look like."""

from pathlib import Path

import pytest
import yaml

from jointwear.files.errors import InputError
from jointwear.robots.plausible_drives import check_payload, check_ratio
from jointwear.robots.robot_file import read_robot_file, robot_sources

PUMA = Path("config/robots/puma560.yaml")


def read(tmp_path, change):
    data = yaml.safe_load(PUMA.read_text())
    change(data)
    path = tmp_path / "arm.yaml"
    path.write_text(yaml.safe_dump(data))
    return read_robot_file(path)


def friction_without_its_sign(data):
    data["joints"][0]["coulomb"] = {"positive": 0.06, "negative": 0.06}


def friction_with_another_sign(data):
    data["joints"][0]["coulomb"] = {"positive": -0.06, "negative": -0.06}


def friction_as_one_number(data):
    data["joints"][0]["coulomb"] = 0.06


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (friction_without_its_sign, r"coulomb\.negative' is 0.06, .*; with the sign of the velocity it is -0.06"),
        (friction_with_another_sign, r"coulomb\.positive' is -0.06, .*; without its sign it is 0.06"),
        (friction_as_one_number, r"must be a mapping, as \{positive: 0.06, negative: -0.06\}"),
    ],
)
def test_friction_is_told_with_its_signs(tmp_path, change, words):
    with pytest.raises(InputError, match=words):
        read(tmp_path, change)


def test_a_description_of_links_is_told_from_a_robot_file(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text("<robot name='arm'/>")
    for looked_at in (read_robot_file, lambda p: robot_sources(str(p))):
        with pytest.raises(InputError, match=r"a robot file is YAML that names it, as 'urdf: arm\.urdf'"):
            looked_at(path)


def payload_in_grams(data):
    data["payload"] = {"mass": 2000, "com": [0, 0, 0.1]}


def rotor_of_neither_side(data):
    data["joints"][1]["motor_inertia"] = 3000.0


def inverse_gear(data):
    data["joints"][0]["gear_ratio"] = -1 / 62.5


def rotor_at_the_joint(data):
    data["joints"][1]["motor_inertia"] = 40.0


def friction_at_the_joint(data):
    data["joints"][0]["coulomb"] = {"positive": 24.0, "negative": -20.0}


WRONG = {
    payload_in_grams: r"'payload.mass' is 2000, in kg, on links of 23.45 kg together; this looks like g: 2 \(allowed",
    inverse_gear: r"'joints\[0\].gear_ratio' is -0.016, .* this looks like its inverse: -62.5 \(allowed",
    rotor_at_the_joint: r"'joints\[1\].motor_inertia' is 40, in kg m2 at the motor; .* whole arm has .*joint, at the",
    rotor_of_neither_side: r"'joints\[1\].motor_inertia' is 3000, .* the whole arm has [\d.]+ \(allowed",
    friction_at_the_joint: r"'joints\[0\].coulomb.negative' is -20, .* like that of the joint, at the motor -0.319",
}


@pytest.mark.parametrize("change", WRONG)
def test_what_no_arm_has_is_refused_with_what_it_looks_like(tmp_path, change):
    with pytest.raises(InputError, match=WRONG[change]) as told:
        read(tmp_path, change)
    assert "allowed: " in str(told.value)


def heavy_load(data):
    data["payload"] = {"mass": 25.0, "com": [0, 0, 0.1]}


def direct_drives(data):
    for joint in data["joints"]:
        gear = abs(joint["gear_ratio"])
        joint["gear_ratio"] = 1.0
        joint["motor_inertia"] *= gear**2
        joint["coulomb"] = {way: value * gear for way, value in joint["coulomb"].items()}


def belt(data):
    data["joints"][5]["gear_ratio"] = -0.5


@pytest.mark.parametrize("change", [heavy_load, direct_drives, belt])
def test_what_is_unusual_and_legal_is_taken(tmp_path, change):
    assert read(tmp_path, change)["joints"]


def test_an_arm_for_a_thousand_kilograms_is_taken():
    check_payload("arm.yaml", {"payload": {"mass": 1000.0}}, 300.0)
    check_payload("arm.yaml", {"payload": {"mass": 1000.0}}, 0.0)
    check_ratio("arm.yaml", 0, 1.0)


def test_the_links_of_a_urdf_hold_its_payload_too(tmp_path):
    body = (
        '<inertial><origin xyz="0.2 0 0"/><mass value="4"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" iyz="0" '
        'ixz="0"/></inertial>'
    )
    joint = (
        '<joint name="j{0}" type="revolute"><parent link="l{0}"/><child link="l{1}"/><origin xyz="0.4 0 0"/>'
        '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="3"/></joint>'
    )
    links = "".join(f'<link name="l{k}">{body if k else ""}</link>' for k in range(4))
    text = f'<robot name="arm">{links}{"".join(joint.format(k, k + 1) for k in range(3))}</robot>'
    (tmp_path / "arm.urdf").write_text(text)
    path = tmp_path / "arm.yaml"
    path.write_text(yaml.safe_dump({"name": "arm", "urdf": "arm.urdf", "payload": {"mass": 5.0, "com": [0, 0, 0]}}))
    read_robot_file(path)
    path.write_text(yaml.safe_dump({"name": "arm", "urdf": "arm.urdf", "payload": {"mass": 5000.0, "com": [0, 0, 0]}}))
    with pytest.raises(InputError, match=r"'payload.mass' is 5000, in kg, on links of .* this looks like g: 5"):
        read_robot_file(path)
