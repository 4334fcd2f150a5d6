"""A URDF that is wrong is refused in one line: numbers, inertia, joints, tree. Nothing of it is left out silently."""

import os

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.rigid_body import fault_of_inertia
from jointwear.robots.robot import load_robot
from jointwear.robots.robot_file import read_robot_file
from jointwear.robots.rocking_base import RockingBase
from jointwear.robots.urdf_links import urdf_with_links


def link(name, mass="2.0", inertia='ixx="0.02" iyy="0.02" izz="0.01" ixy="0" iyz="0" ixz="0"', com="0 0 0.1"):
    body = f'<origin xyz="{com}"/><mass value="{mass}"/><inertia {inertia}/>'
    return f'<link name="{name}"><inertial>{body}</inertial></link>'


def joint(name, parent, child, kind="revolute", inside='<limit lower="-1" upper="1" effort="5" velocity="1"/>'):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/>'
        f"{inside}</joint>"
    )


ARM = [
    '<link name="base"/>',
    link("upper"),
    link("lower", mass="1.37"),
    joint("shoulder", "base", "upper"),
    joint("elbow", "upper", "lower"),
]


def write(folder, parts, extra=""):
    text = '<?xml version="1.0"?>\n<robot name="arm">' + "".join(parts) + "</robot>"
    (folder / "arm.urdf").write_text(text, encoding="utf-8")  # what a URDF is in that declares nothing
    (folder / "arm.yaml").write_text(f"name: arm\nurdf: arm.urdf\n{extra}")
    return folder / "arm.yaml"


def changed(old, new):
    text = "\n".join(ARM)
    assert old in text
    return [text.replace(old, new)]


def test_a_sound_arm_is_read_and_built(tmp_path):
    arm = Dynamics(load_robot(write(tmp_path, ARM)))
    assert arm.robot.joint_names == ("shoulder", "elbow")
    assert sum(body.mass for body in arm.model.inertias) == pytest.approx(3.37)


def test_a_fixed_joint_may_have_the_name_of_a_link(tmp_path):
    """As in a gripper of example-robot-data; names of links and of joints are apart."""
    found = []
    for name in ("tool", "flange_to_tool"):
        fixed = joint(name, "lower", "tool", "fixed", "").replace('<axis xyz="0 1 0"/>', '<origin xyz="0 0 0.3"/>')
        arm = Dynamics(load_robot(write(tmp_path, [*ARM, link("tool"), fixed])))
        motion = np.random.default_rng(4).normal(size=(3, 20, 2))
        found.append((arm.rigid_body_torque(*motion), RockingBase(arm).moments(*motion), arm.torque_slopes(*motion)))
        written = urdf_with_links(arm.robot, np.zeros(20))
        assert written.count('name="tool"') == 1 + (name == "tool")
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other)


@pytest.mark.parametrize("axis", ["1 0 0", "0 1 0", "0 0 1", "0 0 -1", "0 -1 0", "0 0 2", "1 -2 0.5", "-3e-6 0 0"])
def test_a_continuous_joint_turns_as_a_revolute_one_about_any_axis(tmp_path, axis):
    rng = np.random.default_rng(3)
    motion = rng.normal(size=(3, 50, 2))
    torque, tip = [], []
    for kind in ("revolute", "continuous"):
        first = joint("shoulder", "base", "upper", kind).replace("0 1 0", axis)
        last = (
            joint("elbow", "upper", "lower", kind).replace("0 1 0", axis).replace("<axis", '<origin xyz="0 0 1"/><axis')
        )
        arm = Dynamics(load_robot(write(tmp_path, [*ARM[:3], first, last])))
        torque.append(arm.rigid_body_torque(*motion))
        tip.append(arm.forward_kinematics(motion[0])[0])
        assert np.isfinite(arm.torque_slopes(*motion)).all()
    np.testing.assert_allclose(torque[1], torque[0], rtol=0, atol=1e-12 * np.abs(torque[0]).max())
    np.testing.assert_allclose(tip[1], tip[0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["prismatic", "floating", "planar", "spherical", "ball", ""])
def test_other_kinds_of_joints_are_refused_with_those_that_are_known(tmp_path, kind):
    parts = [*ARM[:4], joint("elbow", "upper", "lower", kind)]
    with pytest.raises(InputError, match=r"arm\.urdf: joint 'elbow' \(.+\); only revolute and continuous") as refused:
        load_robot(write(tmp_path, parts))
    assert "\n" not in str(refused.value)


def test_a_joint_that_has_no_angle_in_the_model_is_refused(tmp_path, monkeypatch):
    """Whatever Pinocchio makes of a file that passed: one message, and no error deep in the mechanics."""
    robot = load_robot(write(tmp_path, ARM))
    changed_since = (
        (tmp_path / "arm.urdf").read_text().replace('name="elbow" type="revolute"', 'name="elbow" type="planar"')
    )
    monkeypatch.setattr("jointwear.robots.dynamics.text_of", lambda path: changed_since)
    with pytest.raises(InputError, match=r"no single angle for joint 'elbow' .*allowed: revolute and continuous"):
        Dynamics(robot)


@pytest.mark.parametrize("encoding", ["utf-8", "iso-8859-1"])
def test_names_of_joints_are_read_in_the_encoding_of_the_file(tmp_path, encoding):
    """And a folder has any name: Pinocchio, which takes a path as UTF-8 in every locale, is given the text."""
    folder = tmp_path / "Zelle 3 für Türen"
    folder.mkdir()
    write(folder, ARM)
    text = (folder / "arm.urdf").read_text().replace("elbow", "Türgelenk").replace("?>", f' encoding="{encoding}"?>')
    (folder / "arm.urdf").write_bytes(text.encode(encoding))
    assert Dynamics(load_robot(folder / "arm.yaml")).robot.joint_names == ("shoulder", "Türgelenk")


def test_friction_of_a_urdf_is_that_of_the_joint_whatever_the_gear(tmp_path):
    parts = changed("<limit lower", '<dynamics damping="2" friction="5"/><limit lower')
    drives = "joints:\n  - {name: shoulder, gear_ratio: -100}\n  - {name: elbow, gear_ratio: 50, viscous: 0.01}\n"
    arm = load_robot(write(tmp_path, parts, drives))
    assert arm.coulomb_positive.tolist() == [5, 5]
    assert arm.coulomb_negative.tolist() == [-5, -5]
    assert arm.viscous.tolist() == pytest.approx([2, 25])


MANY = " ".join(f'a{i}="1"' for i in range(200))
NUMBERS = ["1,37", "1.37kg", "nan", "", "inf", "1e999", "0x10", "1_0", "१", "1.37 ", "1.37\n", "1e30", "-1.37"]


@pytest.mark.parametrize("text", NUMBERS)
def test_a_mass_that_is_no_number_is_refused_not_left_out(tmp_path, text):
    with pytest.raises(InputError, match=r"arm\.urdf: link 'lower'.*mass"):
        read_robot_file(write(tmp_path, changed('"1.37"', f'"{text}"')))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('ixx="0.02"', 'ixx="-0.02"', ["link 'upper'", "negative", "inertia_check: none"]),
        ('ixx="0.02"', 'ixx="0.2"', ["link 'upper'", "larger than the sum of the other two"]),
        ('ixy="0"', 'ixy="0,1"', ["'ixy' of <inertia>", "decimal point"]),
        ('izz="0.01" ', "", ["<inertia> has no 'izz'"]),
        ('ixx="0.02"', 'ixx="0.02 "', ["'ixx' of <inertia>", "'0.02 '"]),
        ('<mass value="1.37"/>', "", ["link 'lower'", "0 <mass>"]),
        ('value="1.37"', 'value="0"', ["link 'lower'", "no mass"]),
        ('xyz="0 0 0.1"', 'xyz="0 0"', ["'xyz' of <origin>", "3 numbers"]),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', ["joint 'shoulder'", "axis 0 0 0"]),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 one 0"/>', ["joint 'shoulder'", "'one'"]),
        ('effort="5"', 'effort="strong"', ["joint 'shoulder'", "'effort' of <limit>", "'strong'"]),
        ('effort="5"', 'effort="-5"', ["joint 'shoulder'", "effort of -5"]),
        ('lower="-1"', 'lower="-1rad"', ["'lower' of <limit>", "'-1rad'"]),
        ("<limit", '<dynamics damping="-1"/><limit', ["joint 'shoulder'", "damping of -1"]),
        ("<limit", '<mimic joint="elbow"/><limit', ["joint 'shoulder' follows joint 'elbow'", "make it fixed"]),
        ('<parent link="upper"/>', "", ["joint 'elbow' has no parent"]),
        ('<parent link="upper"/>', '<parent link="uper"/>', ["joint 'elbow' names the parent 'uper'", "no link"]),
        (
            '<child link="lower"/>',
            '<child link="upper"/>',
            ["link 'upper' hangs on two joints, 'shoulder' and 'elbow'"],
        ),
        ('type="revolute"', 'type="fixed"', ["no moving joint"]),
        ('type="revolute"', 'type="revolut"', ["'shoulder' (revolut)", "revolute and continuous"]),
        ('name="elbow"', 'name="shoulder"', ["two joints have the name 'shoulder'"]),
        ('name="lower"', 'name="upper"', ["two links have the name 'upper'"]),
        ('effort="5" ', "", ["joint 'shoulder'", "<limit> has no 'effort'"]),
        ('velocity="1"', 'velocity="-1"', ["joint 'shoulder'", "velocity of -1"]),
        ('effort="5"', 'effort="5\u00a0"', ["'effort' of <limit>", "decimal point"]),
        ("<axis", '<axis xyz="1 0 0"/><axis', ["joint 'shoulder' has 2 <axis>"]),
        ("<limit", '<child link="lower"/><limit', ["joint 'shoulder' has 2 <child>"]),
        ("<mass", '<origin xyz="5 5 5"/><mass', ["link 'upper' has 2 <origin>"]),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 1e-300 0"/>', ["joint 'shoulder'", "1e-06 to 1e+06", "nearest 1"]),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 1e18 0"/>', ["joint 'shoulder'", "1e-06 to 1e+06"]),
        ('<?xml version="1.0"?>', '<?xml version="1.0" encoding="cp037"?>', ["declares the encoding 'cp037'", "utf-8"]),
        ('<robot name="arm">', f'<robot name="arm" {MANY}>', ["201 attributes"]),
        ('<robot name="arm">', "", ["not valid XML"]),
    ],
)
def test_what_is_wrong_with_a_urdf_is_said_in_one_line(tmp_path, old, new, words):
    path = write(tmp_path, ARM)
    urdf = tmp_path / "arm.urdf"
    assert old in urdf.read_text()
    urdf.write_text(urdf.read_text().replace(old, new))
    with pytest.raises(InputError) as error:
        read_robot_file(path)
    message = str(error.value)
    assert "\n" not in message
    for word in ["arm.urdf", *words]:
        assert word in message


def test_a_robot_without_mass_is_refused(tmp_path):
    empty = ['<link name="upper"/>', '<link name="lower"/>']
    parts = [part for part in ARM if "<inertial>" not in part] + empty
    with pytest.raises(InputError, match="no link that moves has a mass"):
        read_robot_file(write(tmp_path, parts))
    assert read_robot_file(write(tmp_path, parts, "inertia_check: none\n"))


def test_a_chain_that_would_end_the_process_is_refused(tmp_path):
    count = 10_000
    welded = [f'<link name="l{i}"/>' for i in range(count)]
    welds = [joint(f"w{i}", f"l{i - 1}" if i else "lower", f"l{i}", "fixed", "") for i in range(count)]
    with pytest.raises(InputError, match=r"10003 links .*at most 1000"):
        read_robot_file(write(tmp_path, [*ARM, *welded, *welds]))


def test_more_joints_than_a_configuration_can_name_are_refused(tmp_path):
    links = [link(f"l{i}") for i in range(70)]
    joints = [joint(f"j{i}", f"l{i - 1}" if i else "base", f"l{i}") for i in range(70)]
    with pytest.raises(InputError, match=r"70 moving joints .*at most 64"):
        read_robot_file(write(tmp_path, [ARM[0], *links, *joints]))


def test_a_circle_behind_the_base_ends(tmp_path):
    circle = [link("a"), link("b"), joint("one", "a", "b"), joint("two", "b", "a")]
    with pytest.raises(InputError, match="joint 'one' is not reached from the base 'base'"):
        read_robot_file(write(tmp_path, [*ARM, *circle]))
    with pytest.raises(InputError, match="the joints run in a circle"):
        read_robot_file(write(tmp_path, circle))


def test_a_branch_says_which_joint_to_fix(tmp_path):
    finger = [link("finger"), joint("grip", "upper", "finger")]
    more = [link("hand"), joint("wrist", "lower", "hand")]
    with pytest.raises(InputError, match="make 'grip' fixed to keep the branch of 'elbow'"):
        read_robot_file(write(tmp_path, [*ARM, *finger, *more]))


def test_branches_behind_welded_bodies_are_seen(tmp_path):
    parts = [
        *ARM,
        link("flange"),
        link("finger"),
        link("thumb"),
        joint("weld", "lower", "flange", "fixed"),
        joint("left", "flange", "finger", "prismatic"),
        joint("right", "lower", "thumb"),
    ]
    with pytest.raises(InputError, match=r"'left' \(prismatic\)"):
        read_robot_file(write(tmp_path, parts))


def test_unphysical_inertia_is_taken_where_the_robot_file_says_so(tmp_path):
    parts = changed('ixx="0.02"', 'ixx="0.2"')
    assert Dynamics(load_robot(write(tmp_path, parts, "inertia_check: none\n"))).robot.joints == 2
    with pytest.raises(InputError, match=r"mass of -1\.37 kg"):
        read_robot_file(write(tmp_path, changed('"1.37"', '"-1.37"'), "inertia_check: none\n"))


def test_what_does_not_move_may_have_any_inertia(tmp_path):
    base = link("base", inertia='ixx="9" iyy="1" izz="1" ixy="0" iyz="0" ixz="0"')
    assert len(read_robot_file(write(tmp_path, [base, *ARM[1:]]))["joints"]) == 2


@pytest.mark.parametrize(
    ("six", "sound"),
    [
        ([1, 1, 1, 0, 0, 0], True),
        ([1, 1, 2, 0, 0, 0], True),  # a plate
        ([1, 1, 2.1, 0, 0, 0], False),
        ([0, 1, 1, 0, 0, 0], True),  # a rod
        ([0, 0, 0, 0, 0, 0], True),  # a point
        ([1, 1, 1, 0.9, 0, 0], False),  # moments 0.1, 1, 1.9
        ([1e-12, 1e-12, 1.5e-12, 0, 0, 0], True),
        ([1e-12, 1e-12, 3e-12, 0, 0, 0], False),
        ([1, 1, -1e-3, 0, 0, 0], False),
    ],
)
def test_which_inertia_a_body_can_have(six, sound):
    assert (fault_of_inertia(six) == "") == sound


def test_entities_pipes_and_deep_nesting_are_refused(tmp_path):
    path = write(tmp_path, ARM)
    urdf = tmp_path / "arm.urdf"
    urdf.write_text('<!DOCTYPE robot [<!ENTITY a "1.37">]><robot name="arm"><link name="&a;"/></robot>')
    with pytest.raises(InputError, match="document type"):
        read_robot_file(path)
    urdf.write_text("<robot>" + "<a>" * 60 + "</a>" * 60 + "</robot>")
    with pytest.raises(InputError, match="nested more than"):
        read_robot_file(path)
    urdf.unlink()
    os.mkfifo(urdf)
    with pytest.raises(InputError, match="is a named pipe"):
        read_robot_file(path)


def test_the_model_is_held_to_the_mass_in_the_file(tmp_path, monkeypatch):
    """Should another reader of the XML see other numbers, nothing is computed."""
    robot = load_robot(write(tmp_path, ARM))
    urdf = tmp_path / "arm.urdf"
    text = urdf.read_text()
    monkeypatch.setattr("jointwear.robots.dynamics.moving_mass", lambda path: 3.37)
    urdf.write_text(text.replace('value="1.37"', 'value="1.3"'))
    with pytest.raises(InputError, match=r"Pinocchio reads 3\.3 kg"):
        Dynamics(robot)


def test_a_urdf_is_no_robot_file_and_the_message_says_how_to_name_it(tmp_path):
    (tmp_path / "arm.urdf").write_text("<robot name='arm'/>")
    with pytest.raises(InputError, match=r"names it, as 'urdf: arm.urdf'"):
        read_robot_file(tmp_path / "arm.urdf")
