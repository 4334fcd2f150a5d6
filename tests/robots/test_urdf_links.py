"""A URDF that is written with other links: bodies welded at any depth count once."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from jointwear.files.errors import InputError
from jointwear.measurement.checks.model_size import unusual_parameters
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import (
    bodies,
    inertial_regressor,
    links_from_parameters,
    mass_direction,
    parameters_of_body,
    prior_factor,
    to_joint_frame,
)
from jointwear.robots.robot import Robot, load_robot, robot_from_data
from jointwear.robots.urdf_links import urdf_with_links

ROBOTS = Path("share/example-robot-data/robots")
LINK = (
    '<link name="{0}"><inertial><origin xyz="0.1 0.02 {1}" rpy="0.3 0.1 0"/><mass value="{2}"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" iyz="0.002" ixz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><origin xyz="0.1 0 0.3" rpy="0.2 0 0.4"/>'
    '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="3"/></joint>'
)


def arm(tmp_path: Path) -> Robot:
    """Two moving joints; behind the second a flange, on it a hand, on that a finger."""
    names = ("base", "upper", "lower", "flange", "hand", "finger")
    links = [LINK.format(name, 0.01 * k, 1.0 + k) for k, name in enumerate(names)]
    joints = [
        JOINT.format(f"j{k}", "revolute" if k < 2 else "fixed", names[k], names[k + 1]) for k in range(len(names) - 1)
    ]
    (tmp_path / "arm.urdf").write_text('<robot name="arm">' + "".join(links + joints) + "</robot>", encoding="utf-8")
    (tmp_path / "arm.yaml").write_text("name: arm\nurdf: arm.urdf\n", encoding="utf-8")
    return load_robot(tmp_path / "arm.yaml")


def torques(robot: Robot, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    q = rng.uniform(robot.lower, robot.upper, (20, robot.joints))
    v, a = rng.standard_normal((2, *q.shape))
    return q, v, a


def written_change(robot: Robot, delta: np.ndarray) -> np.ndarray:
    """Return the change (10 n,) of the parameters that :func:`links_from_parameters` writes when asked for `delta`."""
    result = np.zeros(10 * robot.joints)
    nominal = bodies(robot)
    for link, body in enumerate(links_from_parameters(robot, delta)):
        xx, yy, zz, xy, yz, xz = body["inertia"]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        new = parameters_of_body(body["mass"], np.array(body["com"]), inertia)
        result[10 * link : 10 * link + 10] = to_joint_frame(robot, link) @ (new - parameters_of_body(*nominal[link]))
    return result


def assert_written_as_meant(robot: Robot, path: Path, rng: np.random.Generator) -> None:
    """Write links that are a few percent off and compare with the regressor, which is exact."""
    factor = prior_factor(robot, 0.05)
    change = factor @ rng.standard_normal(factor.shape[1]) + 0.1 * mass_direction(robot, robot.joints - 1)
    path.write_text(urdf_with_links(robot, change), encoding="utf-8")
    joints = [
        {"name": n, "limits": [-2, 2], "gear_ratio": 1.0, "motor_inertia": 0.0, "viscous": 0.0, "torque_limit": None}
        | {"coulomb": {"positive": 0.0, "negative": 0.0}}
        for n in robot.joint_names
    ]
    written = robot_from_data({"name": "written", "gravity": list(robot.gravity), "joints": joints}, path)
    q, v, a = torques(robot, rng)
    dynamics = Dynamics(robot)
    meant = dynamics.rigid_body_torque(q, v, a) + inertial_regressor(dynamics, q, v, a) @ change
    np.testing.assert_allclose(Dynamics(written).rigid_body_torque(q, v, a), meant, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(written_change(robot, change), change, rtol=1e-9, atol=1e-9)


def test_bodies_welded_at_any_depth_count_once(tmp_path):
    robot = arm(tmp_path)
    assert bodies(robot)[1][0] == pytest.approx(3 + 4 + 5 + 6)
    assert_written_as_meant(robot, tmp_path / "written.urdf", np.random.default_rng(3))


@pytest.mark.plants
def test_every_arm_of_the_package_is_written_as_meant(tmp_path):
    package = Path(importlib.util.find_spec("pinocchio").origin)
    folder = next(p for p in package.parents if (p / ROBOTS).is_dir()) / ROBOTS
    done = []
    for urdf in sorted(folder.rglob("*.urdf")):
        (tmp_path / "arm.yaml").write_text(f"name: arm\nurdf: {urdf}\n", encoding="utf-8")
        try:
            robot = load_robot(tmp_path / "arm.yaml")
            Dynamics(robot)
        except InputError:
            continue  # trees, sliding joints, mimics: no serial arm
        if not robot.joints:
            continue
        assert_written_as_meant(robot, tmp_path / "written.urdf", np.random.default_rng(len(done)))
        done.append(urdf.name)
    assert len(done) >= 10, done


def test_angles_of_a_urdf_in_degrees_and_a_centre_of_mass_in_mm_are_told(tmp_path):
    arm(tmp_path)
    right = (tmp_path / "arm.urdf").read_text(encoding="utf-8")
    for old, new, words in (
        ('rpy="0.2 0 0.4"', 'rpy="0 90 0"', r"'rpy' of <origin> is '0 90 0', in rad; .* degrees: '0 1\.5708 0'"),
        ('xyz="0.1 0.02 0.01"', 'xyz="0 0 28.0"', r"link 'upper': .* lies 28 m .* looks like mm"),
    ):
        (tmp_path / "arm.urdf").write_text(right.replace(old, new, 1), encoding="utf-8")
        with pytest.raises(InputError, match=words):
            load_robot(tmp_path / "arm.yaml")
    (tmp_path / "arm.urdf").write_text(right.replace('rpy="0.2 0 0.4"', 'rpy="0 6.2832 -3.1416"', 1), encoding="utf-8")
    load_robot(tmp_path / "arm.yaml")


def test_a_link_that_moves_and_has_no_inertial_is_told(tmp_path):
    robot = arm(tmp_path)
    assert not unusual_parameters(robot)
    text = (tmp_path / "arm.urdf").read_text(encoding="utf-8")
    begin = text.index("<inertial>", text.index('<link name="upper">'))
    end = text.index("</inertial>", begin) + len("</inertial>")
    (tmp_path / "arm.urdf").write_text(text[:begin] + text[end:], encoding="utf-8")
    (told,) = unusual_parameters(load_robot(tmp_path / "arm.yaml"))
    assert "no mass for what joint 1 moves" in told
