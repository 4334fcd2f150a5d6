"""Gravity torques of many samples against Pinocchio's, one by one."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.gravity import BLOCK, GravityTorque
from jointwear.robots.robot import load_robot


def random_tree(seed: int, joints: int = 5) -> pin.Model:
    """Return a tree of joints that turn or slide, each about an axis of its own."""
    rng, model = np.random.default_rng(seed), pin.Model()
    pin.seed(seed)
    for k in range(joints):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        kinds = [
            pin.JointModelRX(),
            pin.JointModelRZ(),
            pin.JointModelPY(),
            pin.JointModelRevoluteUnaligned(axis),
            pin.JointModelPrismaticUnaligned(axis),
        ]
        parent = int(rng.integers(0, k + 1))
        joint = model.addJoint(parent, kinds[rng.integers(len(kinds))], pin.SE3.Random(), f"joint_{k}")
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Random())
    model.gravity.linear = rng.normal(size=3)
    return model


@pytest.mark.parametrize("seed", range(8))
def test_trees_of_any_joints(seed):
    model = random_tree(seed)
    position = np.random.default_rng(seed).uniform(-2, 2, (40, model.nq))
    data = model.createData()
    expected = np.array([pin.computeGeneralizedGravity(model, data, q) for q in position])
    assert GravityTorque(model)(position) == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max())


def test_more_samples_than_a_block_and_one_alone():
    dynamics = Dynamics(load_robot("config/robots/puma560.yaml"))
    position = np.random.default_rng(0).uniform(-3, 3, (BLOCK + 3, 6))
    gravity = GravityTorque(dynamics.model)
    torque = gravity(position)
    assert torque == pytest.approx(dynamics.gravity_torque(position), abs=1e-12)
    assert np.array_equal(gravity(position[-1:]), torque[-1:])
    assert gravity(position[:0]).shape == (0, 6)
