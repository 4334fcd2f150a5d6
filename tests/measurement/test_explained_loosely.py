"""What rules out most readings of the axes at a fraction of the cost leaves no more of the torque than the fit."""

import numpy as np
import pytest

from jointwear.measurement.checks.axes_check import explained
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot


@pytest.mark.parametrize("samples", [2, 5, 300])
def test_a_projection_leaves_no_more_than_a_fit_whose_signs_are_held(samples):
    robot = load_robot("config/robots/puma560.yaml")
    dynamics, random = Dynamics(robot), np.random.default_rng(samples)
    for k in range(20):
        parts = random.normal(size=(samples, 4, robot.joints))
        rigid = dynamics.rigid_body_torque(*(parts[:, i] for i in range(3)))
        parts[:, 3] = rigid + random.normal() * np.sign(parts[:, 1]) + 0.3 * random.normal(size=rigid.shape)
        parts[:, :, k % robot.joints] *= k % 3  # an axis at rest, too
        usable = random.random(rigid.shape) > 0.3
        loosely, left = (explained(dynamics, parts, usable, only) for only in (True, False))
        known = np.isfinite(left)
        assert known.any() == (samples == 300)
        assert (loosely[known] <= left[known]).all()
        assert (loosely >= 0).all()


def test_the_two_are_one_where_friction_brakes_and_inertia_is_one():
    robot = load_robot("config/robots/puma560.yaml")
    dynamics, random = Dynamics(robot), np.random.default_rng(4)
    parts = random.normal(size=(300, 4, robot.joints))
    position, velocity, acceleration = (parts[:, i] for i in range(3))
    more = 2.0 * np.sign(velocity) + 0.5 * velocity + 0.5 * acceleration + 0.1 * random.normal(size=velocity.shape)
    parts[:, 3] = dynamics.rigid_body_torque(position, velocity, acceleration) + more
    usable = np.ones(velocity.shape, dtype=bool)
    loosely, left = (explained(dynamics, parts, usable, only) for only in (True, False))
    np.testing.assert_allclose(loosely, left, rtol=1e-4)
