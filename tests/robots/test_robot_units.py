"""Numbers of a robot file that no arm has are refused with the unit that they look like."""

from pathlib import Path

import pytest
import yaml

from jointwear.files.errors import InputError
from jointwear.robots.robot_file import read_robot_file

PUMA = Path("config/robots/puma560.yaml")


def grams(data):
    for link in data["links"]:
        link["mass"] *= 1000


def length(data):
    data["dh"][1]["a"] = 431.8


def centre(data):
    data["links"][5]["com"] = [0.0, 0.0, 32.0]


def inertia(data):
    data["links"][4]["inertia"] = [300, 300, 300, 0, 0, 0]


def limits(data):
    data["joints"][0]["limits"] = [-90, 90]


def gravity_in_millimetres(data):
    data["gravity"] = [0, 0, -9810]


def gravity_in_g(data):
    data["gravity"] = [0, 0, -1]


def gravity_as_a_number(data):
    data["gravity"] = -9810


WRONG = {
    gravity_in_millimetres: r"'gravity' is \[0, 0, -9810\], in m/s2; this looks like mm/s2: \[0, 0, -9.81\]",
    gravity_in_g: r"'gravity' is \[0, 0, -1\], in m/s2; this looks like g: \[0, 0, -9.81\]",
    gravity_as_a_number: r"'gravity' is -9810, must be a list of three numbers, in m/s2 .* \[0, 0, -9.81\]",
    grams: r"'links\[1\].mass' is 17400, in kg; this looks like g",
    length: r"'dh\[1\].a' is 431.8, in m; this looks like mm: 0.4318",
    centre: r"'links\[5\].com' lies 32 m .* looks like mm",
    inertia: r"'links\[4\].inertia' reaches 300 kg m2 on 0.34 kg",
    limits: r"'joints\[0\].limits' is .* looks like degrees",
}


@pytest.mark.parametrize("change", WRONG)
def test_numbers_in_another_unit_are_named(tmp_path, change):
    data = yaml.safe_load(PUMA.read_text())
    change(data)
    path = tmp_path / "arm.yaml"
    path.write_text(yaml.safe_dump(data))
    with pytest.raises(InputError, match=WRONG[change]):
        read_robot_file(path)


@pytest.mark.parametrize("gravity", [[0, 0, 0], [0, -0.2, 0], [0, 0, -1.62], [0, 9.81, 0]])
def test_gravity_of_flat_tilted_and_hanging_arms_is_taken(tmp_path, gravity):
    path = tmp_path / "arm.yaml"
    path.write_text(yaml.safe_dump(yaml.safe_load(PUMA.read_text()) | {"gravity": gravity}))
    assert read_robot_file(path)["gravity"] == gravity


@pytest.mark.parametrize("path", ["puma560.yaml", "puma560_paper.yaml"])
def test_the_arm_of_the_paper_is_taken(path):
    assert read_robot_file(PUMA.with_name(path))["joints"]
