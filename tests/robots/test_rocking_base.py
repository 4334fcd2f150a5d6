"""The moments on a base that gives way, and what its turning does to the joints."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.robots.rocking_base import WAYS, RockingBase


@pytest.fixture(scope="module")
def dynamics():
    return Dynamics(load_robot("config/robots/puma560.yaml"))


def test_moments_are_those_of_the_joints_behind_a_firm_base(dynamics):
    """What the joints do to the base by accelerating, the base does to the joints: mass matrices are symmetric."""
    rng = np.random.default_rng(0)
    poses, still = rng.uniform(-2, 2, (4, 6)), np.zeros((4, 6))
    base = RockingBase(dynamics)
    by_acceleration, _ = base.pulls(poses)
    for joint in range(6):
        turned = still.copy()
        turned[:, joint] = 1.0
        moments = base.moments(poses, still, turned) - base.moments(poses, still, still)
        np.testing.assert_allclose(moments, by_acceleration[:, :, WAYS + joint], atol=1e-9)
    assert np.all(by_acceleration[:, 0, 0] > 0)


def test_a_turned_base_is_gravity_turned_back(dynamics):
    poses = np.random.default_rng(1).uniform(-2, 2, (3, 6))
    _, by_angle = RockingBase(dynamics).pulls(poses)
    angle, level, found, robot = 1e-3, dynamics.gravity_torque(poses), [], dynamics.robot
    for way in np.eye(3)[:2]:
        turned = Dynamics(replace(robot, gravity=pin.exp3(-angle * way) @ robot.gravity))
        found.append((turned.gravity_torque(poses) - level) / angle)
    # About any two directions across the first joint, which stands upright.
    spread = np.einsum("wmj,wmk->mjk", found, found)
    np.testing.assert_allclose(
        np.einsum("mwj,mwk->mjk", by_angle[..., WAYS:], by_angle[..., WAYS:]), spread, rtol=0.02, atol=0.5
    )
