"""The noise floor of a joint once something on it has a name: what that explains is no noise."""

import numpy as np
import pytest

from jointwear.discovery import Recording, discover
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

RATE, NOISE, AXIS = 200.0, 0.05, 1


@pytest.fixture(scope="module")
def found():
    """What is found in five records of an arm whose second motor cogs seven times a turn."""
    robot = load_robot("config/robots/puma560.yaml")
    rng = np.random.default_rng(5)
    time = np.arange(0, 5.0, 1 / RATE)
    parts = []
    for k in range(5):
        phase, speed = rng.uniform(0, 6, (2, 6)), 2 * np.pi * np.array([0.1, 0.22])[:, None] * rng.uniform(0.8, 1.2, 6)
        x = speed * time[:, None, None] + phase
        size = np.array([0.4, 0.1])[:, None]
        q, v = np.sum(size * np.sin(x), axis=1), np.sum(size * speed * np.cos(x), axis=1)
        a = -np.sum(size * speed**2 * np.sin(x), axis=1)
        torque = Dynamics(robot).inverse_dynamics(q, v, a) + NOISE * rng.standard_normal(q.shape)
        torque[:, AXIS] += 0.8 * np.sin(7 * robot.gear_ratio[AXIS] * q[:, AXIS])
        parts.append((time + 6 * k, np.full(len(time), k), q, torque, v, a))
    time, label, q, torque, v, a = (np.concatenate(x) for x in zip(*parts, strict=True))
    return discover(Recording(time, label, q, torque, velocity=v, acceleration=a, name="cogging"), robot)


def test_a_wave_that_has_a_name_is_no_noise(found):
    assert [(e["effect"], e["axis"]) for e in found.effects] == [("cogging_torque", AXIS + 1)]
    floor = found.data["gap"]["noise_floor"]
    before = found.final.outcome.noise_floor
    # The fit behind the noise holds a wave that is as plain as this one.
    assert before[AXIS] == pytest.approx(NOISE, rel=0.1)
    assert floor[AXIS] == pytest.approx(NOISE, rel=0.1)
    assert [f for j, f in enumerate(floor) if j != AXIS] == pytest.approx(
        [b for j, b in enumerate(before) if j != AXIS], rel=1e-5
    )


@pytest.mark.long
@pytest.mark.parametrize("excess", [0.0, 0.4])
def test_the_noise_of_derived_accelerations_is_noise(excess):
    """Of an exact model of which encoders tell the motion 30 of 46 pages of a bench said that more than noise is left;
    what is left of a joint that lacks a torque stays above the noise.
    """
    robot = load_robot("config/robots/puma560.yaml")
    rng = np.random.default_rng(2)
    time = np.arange(0, 8.0, 1 / RATE)
    step = 2 * np.pi / 2**17
    parts = []
    for k in range(4):
        # A controller that shakes the arm a little, so that derivatives have to reach far up.
        phase, pace = rng.uniform(0, 6, (6, 6)), rng.uniform(0.8, 1.2, 6)
        speed = 2 * np.pi * np.array([0.1, 0.3, 10.0, 20.0, 35.0, 50.0])[:, None] * pace
        x = speed * time[:, None, None] + phase
        size = np.array([0.5, 0.15, 3e-4, 1e-4, 5e-5, 4e-5])[:, None]
        q, v = np.sum(size * np.sin(x), axis=1), np.sum(size * speed * np.cos(x), axis=1)
        a = -np.sum(size * speed**2 * np.sin(x), axis=1)
        torque = Dynamics(robot).inverse_dynamics(q, v, a) + NOISE * rng.standard_normal(q.shape)
        # Nothing that the library holds.
        torque[:, AXIS] += excess * robot.coulomb_positive[AXIS] * np.sin(40.0 * q[:, 0]) * np.sign(v[:, 2])
        parts.append((time + 9 * k, np.full(len(time), k), step * np.round(q / step), torque))
    time, label, q, torque = (np.concatenate(x) for x in zip(*parts, strict=True))
    content = discover(Recording(time, label, q, torque, name="encoders"), robot).content
    ratio = np.array(content.gap.augmented) / np.array(content.gap.noise_floor)
    assert list(np.flatnonzero(ratio > 1.2)) == ([AXIS] if excess else [])
