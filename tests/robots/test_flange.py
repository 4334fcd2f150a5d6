"""Torques of a load at the flange, against the dynamics of a robot that carries it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import BLOCK, FlangeLoad
from jointwear.robots.inertia import wind_up_regressor
from jointwear.robots.robot import Link, load_robot

ROBOT = load_robot(Path(__file__).parents[2] / "config/robots/puma560.yaml")
#: A body almost without inertia about its centre.
THIN = 1e-12 * np.eye(3)


def torques(load, motion):
    dynamics = Dynamics(replace(ROBOT, payload=load))
    gravity = dynamics.gravity_torque(motion[0])
    return np.stack([gravity, dynamics.rigid_body_torque(*motion) - gravity])


@settings(max_examples=10, deadline=None)
@given(
    seed=st.integers(0, 10**6), mass=st.floats(0.1, 20), centre=st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3)
)
def test_unit_loads_are_the_linear_part_of_a_payload(seed, mass, centre):
    motion = np.random.default_rng(seed).normal(size=(3, 20, 6))
    centre = np.array(centre)
    flange = FlangeLoad(ROBOT)
    bare, alone = torques(None, motion), torques(Link(mass, 0 * centre, THIN), motion)
    there, opposite = (torques(Link(mass, sign * centre, THIN), motion) for sign in (1, -1))
    unit = flange.unit(*motion)
    size = np.abs(there).max()
    assert mass * unit[:, :, 0] == pytest.approx(alone - bare, abs=1e-8 * size)
    pulled = flange.pull(motion[0]) @ ROBOT.gravity
    assert mass * pulled == pytest.approx(alone[0] - bare[0], abs=1e-8 * size)
    first = np.einsum("smkn,k->smn", unit[:, :, 1:], mass * centre)
    # What is even in the centre is of second order in it.
    assert first == pytest.approx((there - opposite) / 2, abs=1e-8 * size)
    moments = np.tile([mass, *(mass * centre)], (20, 1))
    assert flange.torque(*motion, moments) == pytest.approx(np.einsum("smkn,mk->smn", unit, moments), abs=1e-8 * size)
    assert flange.unit_sum(*motion) == pytest.approx(unit.sum(axis=0), abs=1e-12 * size)


def test_a_long_motion_is_the_sum_of_its_pieces():
    random = np.random.default_rng(3)
    motion, moments = random.normal(size=(3, BLOCK + 7, 6)), random.normal(size=(BLOCK + 7, 4))
    flange, end = FlangeLoad(ROBOT), slice(BLOCK - 2, None)
    assert np.array_equal(flange.unit(*motion)[:, end], flange.unit(*motion[:, end]))
    assert np.array_equal(flange.torque(*motion, moments)[:, end], flange.torque(*motion[:, end], moments[end]))


def test_a_robot_with_one_joint(tmp_path):
    inertial = '<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" iyz="0" ixz="0"/></inertial>'
    (tmp_path / "arm.urdf").write_text(
        f'<robot name="arm"><link name="base"/><link name="arm">{inertial}</link><joint name="j" type="revolute">'
        '<parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1" effort="5" velocity="1"/></joint></robot>'
    )
    (tmp_path / "arm.yaml").write_text("name: arm\nurdf: arm.urdf\n")
    unit = FlangeLoad(load_robot(tmp_path / "arm.yaml")).unit(*np.zeros((3, 4, 1)))
    assert unit.shape == (2, 4, 4, 1)
    # One kilogram metre along x, about y, upright: gravity times one.
    assert unit[0, :, 1, 0] == pytest.approx(-9.81)


def two_joints(path):
    """Return a robot by URDF whose joints turn about y and about a slanting axis."""
    inertia = '<inertia ixx="1" iyy="2" izz="2" ixy="0" iyz="0" ixz="0"/>'
    body = f'<inertial><origin xyz="0.1 0.2 0.3"/><mass value="2"/>{inertia}</inertial>'
    joints = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="l{k}"/><child link="l{k + 1}"/><origin xyz="0 0.2 0.4"/>'
        f'<axis xyz="{axis}"/><limit lower="-1" upper="1" effort="5" velocity="1"/></joint>'
        f'<link name="l{k + 1}">{body}</link>'
        for k, axis in enumerate(("0 1 0", "0.6 0 0.8"))
    )
    (path / "arm.urdf").write_text(f'<robot name="arm"><link name="l0"/>{joints}</robot>')
    (path / "arm.yaml").write_text("name: arm\nurdf: arm.urdf\n")
    return load_robot(path / "arm.yaml")


def test_gravity_changes_with_the_angle_of_a_link_as_small_turns_say(tmp_path):
    load = Link(2.0, np.array([0.1, 0.0, 0.2]), np.eye(3))
    for robot in (ROBOT, replace(ROBOT, gravity=np.array([1.0, -3.0, 9.0]), payload=load), two_joints(tmp_path)):
        dynamics, n = Dynamics(robot), robot.joints
        position = np.random.default_rng(6).uniform(-3.0, 3.0, (20, n))
        still = np.zeros_like(position)
        regressor = wind_up_regressor(dynamics, position, still, still)
        for axis, turn in enumerate(1e-4 * np.eye(n)):
            change = dynamics.gravity_torque(position + turn) - dynamics.gravity_torque(position - turn)
            by_acceleration, by_velocity, by_angle = regressor(axis)
            # At rest nothing changes in proportion to a velocity.
            np.testing.assert_array_equal(by_velocity, 0.0)
            np.testing.assert_allclose(by_angle, change / 2e-4, atol=1e-6)
            inertia = dynamics.mass_matrix(position)[..., axis] - np.eye(n)[axis] * robot.armature[axis]
            np.testing.assert_allclose(by_acceleration, inertia, atol=1e-12)


def test_the_angle_of_a_link_changes_what_the_other_joints_accelerate_and_its_own_gravity_alone():
    dynamics, n = Dynamics(ROBOT), ROBOT.joints
    motion = np.random.default_rng(7).normal(size=(3, 20, n))
    regressor, slopes = wind_up_regressor(dynamics, *motion), dynamics.torque_slopes(*motion)[0]
    level = wind_up_regressor(dynamics, motion[0], *np.zeros_like(motion[1:]))
    for axis in range(n):
        own = np.arange(n) == axis
        _, by_velocity, by_angle = regressor(axis)
        np.testing.assert_allclose(by_angle[:, ~own], slopes[:, ~own, axis])
        np.testing.assert_allclose(by_angle[:, own], level(axis)[2][:, own])
        # Torque is a square of the velocities: a difference about the middle is exact.
        faster, slower = (motion[1] + turn * own for turn in (1.0, -1.0))
        change = dynamics.rigid_body_torque(motion[0], faster, motion[2]) - dynamics.rigid_body_torque(
            motion[0], slower, motion[2]
        )
        np.testing.assert_allclose(by_velocity, change / 2.0, atol=1e-9)
    # By its acceleration too the torque of a shoulder changes with its own angle.
    assert not np.allclose(regressor(1)[2][:, 1], slopes[:, 1, 1])
