"""An arm that lacks many effects at once, as real ones do: axes share no places and are no rivals of each other."""

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings
from jointwear.discovery.estimates.outcome import Unexplained
from jointwear.discovery.findings import listed
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.search.searches import search, whitened
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot

#: Spatial order of the friction of each joint, and the share of its Coulomb friction that it varies by.
ORDERS, SHARE = (3.0, 4.0, 3.0, 5.0, 4.0, 3.0), 0.25
#: Stribeck peak as a share of the Coulomb friction, and its speed [rad/s].
PEAK, SPEED = 0.4, 0.08


@pytest.fixture(scope="module")
def found():
    robot = load_robot("config/robots/puma560.yaml")
    coulomb = 0.5 * (robot.coulomb_positive - robot.coulomb_negative)

    def hidden(q, v, *_):
        wave = SHARE * coulomb * np.sin(np.array(ORDERS) * q + 1.0)
        return (wave + PEAK * coulomb * np.exp(-np.abs(v) / SPEED)) * np.sign(v)

    recording = split(make_case(robot, 31, hidden, noise=0.003))
    return search(whitened(build_problem(recording, robot, Settings())))


def test_two_effects_on_every_axis_are_named(found):
    names = {(n.candidate.effect, n.candidate.axis) for n in found.named}
    true = {(effect, axis) for axis in range(6) for effect in ("stribeck_friction", "position_dependent_friction")}
    assert names <= true
    assert len(names) >= 10
    assert {axis for _, axis in names} == set(range(6))


def test_what_another_axis_lacks_makes_no_name_less_likely(found):
    assert all(n.log_odds > 10 and n.probability > 0.5 for n in found.named)


def structure(axis, nats):
    return Unexplained(axis, "position", "rad", 0.0, 1.0, 1e-12, nats)


def test_no_axis_with_structure_is_cut_from_the_list():
    many = [structure(0, 100.0 - k) for k in range(20)] + [structure(3, 20.0), structure(5, 10.0)]
    shown = listed(many)
    assert len(shown) == 12
    assert {u.axis for u in shown} == {0, 3, 5}
    assert [u.nats for u in shown] == sorted((u.nats for u in shown), reverse=True)
    assert listed(many[:5]) == many[:5]
