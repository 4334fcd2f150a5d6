"""A wave of friction with flat crests: its order is no better known than the form of its crests."""

import numpy as np
import pytest

from jointwear.discovery import Recording, discover
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot


@pytest.mark.long
def test_the_order_of_a_wave_with_flat_crests_is_not_known_to_a_hundredth():
    robot = load_robot("config/robots/puma560.yaml")
    rng, time, parts = np.random.default_rng(2), np.arange(0, 8.0, 0.01), []
    for k in range(5):
        phase, speed = rng.uniform(0, 6, (2, 6)), 2 * np.pi * np.array([[0.15], [0.5]]) * rng.uniform(0.8, 1.2, 6)
        size, angle = np.array([[1.2], [0.15]]), speed * time[:, None, None] + phase
        motion = (size * np.sin(angle), size * speed * np.cos(angle), -size * speed**2 * np.sin(angle))
        position, velocity, acceleration = (np.sum(x, axis=1) for x in motion)
        torque = Dynamics(robot).inverse_dynamics(position, velocity, acceleration)
        wave = np.tanh(3.0 * np.sin(2.0 * position[:, 2] + 0.7)) / np.tanh(3.0)
        torque[:, 2] += 1.5 * wave * np.sign(velocity[:, 2])
        torque += 0.004 * torque.std(axis=0) * rng.standard_normal(torque.shape)
        parts.append((time + 9 * k, np.full(len(time), k), position, torque, velocity, acceleration))
    fields = ("time", "trajectory", "position", "torque", "velocity", "acceleration")
    columns = (np.concatenate(x) for x in zip(*parts, strict=True))
    found = discover(Recording(**dict(zip(fields, columns, strict=True)), train=(0, 1, 2, 3), test=(4,)), robot)
    (one,) = found.effects
    assert (one["effect"], one["axis"]) == ("position_dependent_friction", 3)
    order = one["parameters"]["order"]
    # Of the evidence alone 2.066 +- 0.010.
    assert abs(order["value"] - 2.0) < 1.96 * order["std"]
    assert order["std"] < 0.2
