"""Thousands of broken configurations, robots, tasks and URDFs: one line, or numbers that arms can have."""

import os
import re

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from isolation import held, outcome_of
from mutations import NUMBERS, WORDS, broken_bytes, broken_documents, finite_numbers, seeds, tree
from scratch_project import ROOT

from jointwear.files.documents import read_yaml
from jointwear.files.provenance import settings_digest
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.trajectory import load_task
from jointwear.running.configuration import check_experiment, prepare
from jointwear.running.datasets import check_datasets

pytestmark = pytest.mark.hostile
CONFIG = yaml.safe_load((ROOT / "config/config.yaml").read_text())
CONFIG["discover"] = {
    "datasets": {
        "mine": {
            "measured": "data/examples/puma560_hidden.nc",
            "robot": "config/robots/puma560.yaml",
            "variables": {"position": "q"},
            "units": {"position": "rad"},
            "train": [0, 1],
            "test": [2],
            "inertial_prior": 0.05,
        }
    }
}
CONFIG["monitor"] = {
    "robots": {
        "arm": {
            "logs": ["logs/*.csv"],
            "robot": "config/robots/puma560.yaml",
            "window": "1h",
            "baseline": {"windows": 10},
            "limits": {"coulomb_increase_percent": 20},
            "false_alarms_per_1000_h": 1,
        }
    }
}
ROBOTS = [yaml.safe_load((ROOT / f"config/robots/{n}.yaml").read_text()) for n in ("puma560", "puma560_paper")]
TASK = {"unit": "rad", "phase": 0.0, **yaml.safe_load((ROOT / "config/tasks/T1.yaml").read_text())}


@pytest.fixture(autouse=True)
def in_the_project(monkeypatch, tmp_path):
    """Paths count from the project; nothing that an input names may appear in it or beside the input."""
    monkeypatch.chdir(ROOT)
    before = set(os.listdir(ROOT))
    yield
    assert set(os.listdir(ROOT)) == before
    assert not (tmp_path / "executed").exists()


def document(path, data, text=None):
    path.write_bytes(yaml.safe_dump(data, allow_unicode=True).encode("utf-8") if text is None else text)
    return path


def accepted_config(data):
    config = prepare(data)
    check_experiment(config)
    check_datasets(config)
    assert finite_numbers(config)
    settings_digest(config)
    return config["wear"]["shape"]


@given(broken_documents(CONFIG))
@seeds(700)
def test_configurations_as_snakemake_hands_them_over(data):
    held(outcome_of(lambda: accepted_config(data)))


@given(broken_bytes((ROOT / "config/config.yaml").read_bytes()))
@seeds(300)
def test_configuration_files(tmp_path_factory, data):
    path = document(tmp_path_factory.getbasetemp() / "config.yaml", None, data)
    held(outcome_of(lambda: accepted_config(read_yaml(path))))


def accepted_robot(path):
    """Load a robot and compute with it: an accepted robot has torques, and mass wherever it moves."""
    dynamics = Dynamics(load_robot(path))
    n = dynamics.robot.joints
    state = np.random.default_rng(1).normal(size=(3, 5, n))
    assert np.isfinite(dynamics.inverse_dynamics(*state)).all()
    assert all(body.mass >= 0 for body in dynamics.model.inertias)
    assert (dynamics.robot.viscous >= 0).all()
    assert (dynamics.robot.armature >= 0).all()
    assert (dynamics.robot.coulomb_positive >= 0).all()
    return n


@given(st.sampled_from(ROBOTS).flatmap(broken_documents))
@seeds(600)
def test_robots(tmp_path_factory, data):
    path = document(tmp_path_factory.getbasetemp() / "arm.yaml", data)
    held(outcome_of(lambda: accepted_robot(path)))


def accepted_task(path):
    task = load_task(path)
    motion = task.samples(10.0, 60)
    assert np.isfinite(motion.acceleration).all()
    read = read_robot_file(ROOT / "config/robots/puma560.yaml")
    assert finite_numbers(read)
    return task.cycle


@given(broken_documents(TASK))
@seeds(300)
def test_tasks(tmp_path_factory, data):
    path = document(tmp_path_factory.getbasetemp() / "T1.yaml", data)
    held(outcome_of(lambda: accepted_task(path)))


def link(name, mass):
    inertia = 'ixx="0.02" iyy="0.02" izz="0.01" ixy="0.001" iyz="0" ixz="0"'
    origin = '<origin xyz="0 0.01 0.1" rpy="0 0 0"/>'
    return f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/><inertia {inertia}/></inertial></link>'


def joint(name, parent, child, kind):
    inside = '<limit lower="-1" upper="1" effort="5" velocity="1"/><dynamics damping="0.1" friction="0.2"/>'
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.3" rpy="0 0 0"/><axis xyz="0 1 0"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


URDF = "\n".join(
    [
        '<?xml version="1.0"?>\n<robot name="arm"><link name="base"/>',
        *(link(name, mass) for name, mass in (("upper", 2.0), ("lower", 1.37), ("hand", 0.7), ("cap", 0.1))),
        joint("shoulder", "base", "upper", "revolute"),
        joint("elbow", "upper", "lower", "revolute"),
        joint("wrist", "lower", "hand", "continuous"),
        joint("weld", "hand", "cap", "fixed"),
        "</robot>",
    ]
)
ATTRIBUTES = [match.span(1) for match in re.finditer(r'"([^"]*)"', URDF)]
ELEMENTS = [
    match.span() for match in re.finditer(r"<(?:mass|inertia|origin|axis|limit|parent|child|dynamics)[^>]*/>", URDF)
]
WHOLE = [match.span() for match in re.finditer(r"<(link|joint) name=.*</\1>", URDF)]
NAMES = ("base", "upper", "lower", "hand", "cap", "shoulder", "fixed", "prismatic", "floating", "revolute")


@st.composite
def broken_urdfs(draw):
    """A URDF with attributes replaced, or elements removed, doubled or moved."""
    what = draw(st.sampled_from(["attribute"] * 4 + ["number", "remove", "double", "mimic", "whole"]))
    text = URDF
    if what in ("attribute", "number"):
        for start, stop in sorted(draw(st.sets(st.sampled_from(ATTRIBUTES), min_size=1, max_size=2)), reverse=True):
            strange = st.sampled_from(NUMBERS).map(lambda x: str(x) if abs(x) < 1e300 or x != x else "1e400")
            words = st.sampled_from([*WORDS, *NAMES]).filter(lambda w: "<" not in w)
            value = draw(strange if what == "number" else st.one_of(strange, words))
            text = text[:start] + value + text[stop:]
        return text
    start, stop = draw(st.sampled_from(WHOLE if what == "whole" else ELEMENTS))
    part = text[start:stop]
    more = {"remove": "", "double": part * 2, "mimic": f'{part}<mimic joint="elbow"/>'}
    return text[:start] + more.get(what, draw(st.sampled_from(["", part * 2, f"<group>{part}</group>"]))) + text[stop:]


def moving(text):
    """The masses that an accepted URDF must keep: those in its text, read as plainly as can be."""
    return sum(float(x) for x in re.findall(r'<mass value="([^"]*)"', text))


@given(st.one_of(broken_urdfs(), broken_bytes(URDF.encode())))
@seeds(600)
def test_urdfs(tmp_path_factory, text):
    folder = tmp_path_factory.getbasetemp()
    (folder / "arm.urdf").write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    path = document(folder / "arm.yaml", {"name": "arm", "urdf": "arm.urdf"})
    found = held(outcome_of(lambda: accepted_urdf(path)))
    if found.kind == "accepted" and isinstance(text, str) and "<!--" not in text:
        joints, mass = found.value
        assert joints >= 1
        assert mass <= moving(text) + 1e-9
        if text.count("<link") == URDF.count("<link") and text.count("<inertial>") == 4 and joints == 3:
            assert mass == pytest.approx(moving(text), rel=1e-9)


def accepted_urdf(path):
    joints = accepted_robot(path)
    return joints, float(sum(body.mass for body in list(Dynamics(load_robot(path)).model.inertias)[1:]))


def test_the_sound_ones_are_accepted(tmp_path):
    """The fuzzer starts from inputs that are right, else it would refuse everything for one reason."""
    assert outcome_of(lambda: accepted_config({**CONFIG, "discover": {}, "monitor": {}})).kind == "accepted"
    assert outcome_of(lambda: accepted_config(CONFIG)).kind == "accepted"
    for data in ROBOTS:
        assert outcome_of(lambda data=data: accepted_robot(document(tmp_path / "arm.yaml", data))).kind == "accepted"
    assert outcome_of(lambda: accepted_task(document(tmp_path / "T1.yaml", TASK))).kind == "accepted"
    (tmp_path / "arm.urdf").write_text(URDF)
    path = document(tmp_path / "arm.yaml", {"name": "arm", "urdf": "arm.urdf"})
    assert outcome_of(lambda: accepted_urdf(path)).value == (3, pytest.approx(4.17))
    assert "arm.urdf" in tree(tmp_path)
