"""Effects that a robot file names are checked before any job, and cost nothing where there are none."""

import sys

import pytest
import yaml

from jointwear.files.errors import InputError
from jointwear.running.named_effects import check_named_effects, robot_files

SPRING = {"effect": "joint_spring", "axis": 2, "parameters": {"stiffness": 40.0}}


@pytest.fixture
def robot_file(root, tmp_path):
    def write(effects):
        content = yaml.safe_load((root / "config/robots/puma560.yaml").read_text()) | {"effects": effects}
        path = tmp_path / "arm.yaml"
        path.write_text(yaml.safe_dump(content))
        return str(path)

    return write


@pytest.mark.parametrize(
    ("effects", "words"),
    [
        ([SPRING | {"effect": "joint_sprng"}], "did you mean 'joint_spring'"),
        ([SPRING | {"parameters": {"stifness": 40.0}}], "did you mean 'stiffness'"),
        ([SPRING | {"parameters": {"stiffness": 1e9}}], "the nearest valid value is 1000000"),
        ([{"effect": "joint_spring", "parameters": {"stiffness": 40.0}}], "'effects\\[0\\].axis' is missing"),
        ([{"effect": "joint_spring", "axis": 2}], "says no size of 'joint_spring' .allowed: stiffness, quadratic"),
        ([SPRING | {"parameters": {"centre": 0.1}}], "says no size of 'joint_spring'"),
        ([SPRING, SPRING | {"axis": 3}, SPRING], "'effects\\[2\\]' is the same as 'effects\\[0\\]'"),
    ],
)
def test_a_wrong_effect_is_named_with_its_file(robot_file, effects, words):
    path = robot_file(effects)
    with pytest.raises(InputError, match=words) as error:
        check_named_effects([path])
    assert str(error.value).startswith(f"{path}: 'effects[")


def test_sound_effects_pass(robot_file):
    check_named_effects([robot_file([SPRING, SPRING | {"axis": 3}])])


def test_the_library_is_not_loaded_for_a_file_without_effects(root, monkeypatch):
    monkeypatch.setitem(sys.modules, "jointwear.effects", None)  # to import it would fail
    check_named_effects(map(str, (root / "config/robots").glob("*.yaml")))


def test_each_robot_file_that_is_there_is_looked_at_once(root):
    entry, gone = {"robot": str(root / "config/robots/ur10.yaml")}, {"robot": "results/discover/a/robot.yaml"}
    config = {**entry, "monitor": {"robots": {"a": entry, "b": entry}}, "discover": {"datasets": {"b": gone}}}
    assert robot_files(config) == [entry["robot"]]
