"""What scales the two levels of a friction that differ has one name, not a second one of an offset or a spring."""

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery.pipeline import discover
from jointwear.robots.robot import load_robot


def scaled(robot, axis, share):
    """Return friction that is larger by `share(q, v, time)` of the level of its direction, of one 0-based axis."""

    def hidden(q, v, a, temperature, time, torque):
        full = np.zeros_like(q)
        full[:, axis] = share(q[:, axis], v[:, axis], time) * robot.coulomb(v)[:, axis]
        return full

    return hidden


SHARES = {
    "wear_drift": lambda q, v, time: 0.5 * time / time.max(),
    "position_dependent_friction": lambda q, v, time: 0.4 * np.cos(2 * q + 0.7),
    "stribeck_friction": lambda q, v, time: 0.6 * np.exp(-((v / 0.12) ** 2)),
}


@pytest.mark.parametrize("effect", SHARES)
def test_unequal_levels_grow_by_the_same_share(effect):
    """The wrist of the PUMA drags two and a half times as much one way as the other."""
    robot = load_robot("config/robots/puma560.yaml")
    found = discover(make_case(robot, 3, scaled(robot, 5, SHARES[effect])), robot)
    assert [(e["effect"], e["axis"]) for e in found.effects] == [(effect, 6)]
    assert found.effects[0]["parameters"]["unequal"]["value"] == pytest.approx(-0.45, abs=0.01)


@pytest.mark.parametrize("effect", SHARES)
def test_the_same_friction_both_ways_is_told_as_that(effect):
    robot = load_robot("config/robots/puma560.yaml")
    size = 0.5 * (robot.coulomb_positive - robot.coulomb_negative)[5]

    def hidden(q, v, a, temperature, time, torque):
        full = np.zeros_like(q)
        full[:, 5] = SHARES[effect](q[:, 5], v[:, 5], time) * size * np.sign(v[:, 5])
        return full

    found = discover(make_case(robot, 3, hidden), robot)
    assert [(e["effect"], e["axis"]) for e in found.effects] == [(effect, 6)]
    assert found.effects[0]["parameters"]["unequal"]["value"] == 0.0


def test_each_level_of_a_friction_may_build_up_by_itself():
    """Behind a reversal there is nothing of the level of its direction, and then all of it."""
    robot = load_robot("config/robots/puma560.yaml")

    def hidden(q, v, a, temperature, time, torque):
        full, level, z = np.zeros_like(q), robot.coulomb(v)[:, 5], 1.0
        for k in range(1, len(q)):
            s = np.sign(v[k, 5])
            z = s + (z - s) * np.exp(-abs(q[k, 5] - q[k - 1, 5]) / 0.02)
            full[k, 5] = level[k] * (z * s - 1.0)
        return full

    found = discover(make_case(robot, 3, hidden), robot)
    assert [(e["effect"], e["axis"]) for e in found.effects] == [("presliding_hysteresis", 6)]
    assert found.effects[0]["parameters"]["unequal"]["value"] == pytest.approx(-0.45, abs=0.01)
