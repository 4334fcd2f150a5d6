"""Coulomb friction that builds up with speed."""

import numpy as np
import pytest
from discovery_cases import COARSE_RATE as RATE
from discovery_cases import make_case

from jointwear.discovery.pipeline import discover
from jointwear.discovery.problem import building_up
from jointwear.discovery.problem.building_up import FORMS, built_up_anywhere, built_up_friction
from jointwear.discovery.settings import Settings
from jointwear.robots.robot import load_robot

LIMITS = Settings().accept, Settings().form_error
LEVELS, NOISE = (0.8, -0.6), 0.02


def samples(friction, seed=5, joints=2, count=6000):
    """Return samples of joints whose first has `friction`(velocity, acceleration) and whose others have a step."""
    rng = np.random.default_rng(seed)
    time = np.arange(count) / RATE
    velocity = np.stack([np.sin((2.0 + 1.1 * k) * time + k) + 0.4 * np.sin(0.7 * time) for k in range(joints)], axis=1)
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    inertial = rng.standard_normal((count, joints, 3))
    level = np.where(velocity > 0, *LEVELS)
    torque = level.copy()
    torque[:, 0] = friction(velocity[:, 0], acceleration[:, 0])
    torque += 0.1 * velocity + inertial @ np.array([0.05, -0.02, 0.1]) + NOISE * rng.standard_normal(velocity.shape)
    return np.abs(velocity) > 0.005, velocity, acceleration, torque - level, inertial, level


def level_of(velocity):
    return np.where(velocity > 0, *LEVELS)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("speed", [0.03, 0.12])
def test_form_and_speed_of_a_rounded_sign_are_found_on_its_joint_alone(form, speed):
    rounded = FORMS[form][0]
    own, other = built_up_friction(*samples(lambda v, _: level_of(v) * rounded(np.abs(v) / speed)), *LIMITS)
    assert other is None
    assert own.form == form
    assert own.speed == pytest.approx(speed, rel=0.05)
    assert (own.positive, own.negative) == pytest.approx(LEVELS, rel=0.02)
    assert own.noise == pytest.approx(NOISE, rel=0.1)
    # At the speed of one unit a clip is whole, and what is put right makes a step of all of them.
    at = np.array([0.5 * speed, -0.5 * speed, 50 * speed])
    whole = level_of(at) * rounded(np.abs(at) / speed) + own.lacking(at)
    assert whole == pytest.approx(level_of(at), abs=0.05)


def _bristle(v, _):
    """Friction that builds up over the travel after each reversal, not over the speed."""
    state, z = np.zeros(len(v)), 0.0
    for k, x in enumerate(v):
        z += (x - abs(x) * z) / RATE / 0.03
        state[k] = z
    return 0.7 * state


OTHERS = {
    "step": lambda v, a: level_of(v),
    "stribeck": lambda v, a: level_of(v) * (1 + 0.6 * np.exp(-np.abs(v) / 0.1)),
    "curved": lambda v, a: level_of(v) + 0.8 * np.sign(v) * np.abs(v) ** 0.45,
    "late": lambda v, a: level_of(np.roll(v, 4)),
    "bristle": _bristle,
}


@pytest.mark.parametrize("friction", OTHERS.values(), ids=OTHERS)
def test_friction_of_another_kind_does_not_build_up(friction):
    assert built_up_friction(*samples(friction), *LIMITS) == [None, None]


def test_what_one_joint_shows_is_asked_of_the_others():
    """One formula makes the friction of a simulated arm: a weak joint is held to the form and speed of a strong one."""
    usable, v, a, missing, inertial, level = samples(lambda v, _: level_of(v) * np.tanh(np.abs(v) / 0.05), joints=3)
    missing = missing.copy()
    weak = 0.8 * NOISE * np.sign(v[:, 2])
    missing[:, 2] += weak * np.tanh(np.abs(v[:, 2]) / 0.05)
    level = level.copy()
    level[:, 2] = 0.0
    alone = built_up_friction(*(x[:, 2:] for x in (usable, v, a, missing, inertial, level)), *LIMITS)
    found = built_up_friction(usable, v, a, missing, inertial, level, *LIMITS)
    assert alone == [None]
    assert found[1] is None
    assert (found[2].form, found[2].speed) == (found[0].form, found[0].speed)


def test_the_form_of_the_arm_is_that_of_a_joint_whose_friction_is_curved_too():
    """Alone such a friction fits another form, or none: what is added at low speed builds up as well."""

    def rounded(v, _):
        return level_of(v) * np.tanh(np.abs(v) / 0.05)

    usable, v, a, missing, inertial, level = samples(rounded, joints=4)
    missing = missing.copy()
    speed = np.abs(v)
    added = np.stack([0 * v[:, 0], 0.5 * speed[:, 1] ** 0.5, 0.4 * np.exp(-speed[:, 2] / 0.15), 0 * v[:, 0]], axis=1)
    missing += (np.abs(level) + added) * np.sign(v) * np.tanh(speed / 0.05) - level
    missing[:, 0] -= (np.abs(level[:, 0]) * np.tanh(speed[:, 0] / 0.05) - np.abs(level[:, 0])) * np.sign(v[:, 0])
    found = built_up_friction(usable, v, a, missing, inertial, level, *LIMITS)
    assert {way.form for way in found} == {"as a tanh"}
    assert [way.speed for way in found] == pytest.approx([0.05] * 4, rel=0.05)
    assert [way.excess for way in found] == pytest.approx([0.0, 0.0, 0.4, 0.0], abs=0.1)
    slow = np.array([0.02, 0.3])
    assert list(found[2].unsure(slow, 0.3)) == [True, False]


def test_what_is_missing_on_fast_samples_is_not_bent_to_slow_ones():
    """A torque that is missing where the joint is fast leaves slow samples far quieter than the others."""
    usable, v, a, missing, inertial, level = samples(lambda v, _: level_of(v) * np.minimum(np.abs(v) / 0.04, 1.0))
    assert built_up_friction(usable, v, a, missing, inertial, level, *LIMITS)[0] is not None
    rng = np.random.default_rng(8)
    missing = missing.copy()
    missing[:, 0] += np.where(np.abs(v[:, 0]) > 0.04, 5 * NOISE * rng.standard_normal(len(v)), 0.0)
    assert built_up_friction(usable, v, a, missing, inertial, level, *LIMITS)[0] is None


def test_too_few_samples_say_nothing():
    few = [x[:20] for x in samples(lambda v, _: level_of(v) * np.tanh(np.abs(v) / 0.05))]
    assert built_up_friction(*few, *LIMITS) == [None, None]


@pytest.mark.long
def test_an_arm_whose_friction_is_rounded_lacks_nothing():
    robot = load_robot("config/robots/puma560.yaml")

    def rounded(q, v, a, *_):
        level = np.where(v > 0, robot.coulomb_positive, robot.coulomb_negative)
        return level * (np.tanh(np.abs(v) / 0.08) - 1.0)

    recording = make_case(robot, 11, rounded)
    found = discover(recording, robot)
    assert (found.verdict in {"none", "retuned"}, found.effects, found.content.unexplained) == (True, [], ())
    ways = found.problem.built_up
    assert {way.form for way in ways} == {"as a tanh"}
    assert [way.speed for way in ways] == pytest.approx([0.08] * 6, rel=0.1)
    told = [words for words in found.content.restrictions if "builds up as a tanh of the speed over 0.0" in words]
    assert len(told) == 1
    # What the arm does is kept as it was measured; the samples that are judged have whole friction.
    problem = found.problem
    used = problem.measured.usable & (np.abs(problem.measured.velocity) > 0.02)
    assert np.sqrt(np.mean(problem.discrepancy[used] ** 2)) < 0.6


def _to_and_fro(seed=4, count=6000):
    """Position, velocity and acceleration (N, 2) of joints that go to and fro between two places and stop there."""
    rng = np.random.default_rng(seed)
    q = np.zeros((count, 2))
    for joint in range(2):
        places, at, k = rng.uniform(-1.0, 1.0, 2), 0.0, 0
        while k < count:
            to, length = places[int(at != places[1])], int(rng.integers(120, 260))
            x = np.linspace(0.0, 1.0, length)
            q[k : k + length, joint] = (at + (to - at) * x**3 * (10 - 15 * x + 6 * x**2))[: count - k]
            at, k = to, k + length
    velocity = np.gradient(q, 1 / RATE, axis=0)
    return q, velocity, np.gradient(velocity, 1 / RATE, axis=0)


@pytest.mark.parametrize(("stiffness", "rounds"), [(3.0, False), (0.0, True)])
def test_a_spring_that_a_file_lacks_is_no_friction_that_builds_up(stiffness, rounds):
    """Moves that are slow in few places: a spring was told as friction that builds up, and named with a Stribeck."""
    q, v, a = _to_and_fro()
    rng = np.random.default_rng(8)
    level = np.where(v > 0, *LEVELS)
    missing = np.column_stack([stiffness * (q[:, 0] - 0.3), np.zeros(len(q))])
    if rounds:
        missing[:, 0] += level[:, 0] * (np.tanh(np.abs(v[:, 0]) / 0.1) - 1.0)
    missing += NOISE * rng.standard_normal(v.shape)
    usable, inertial = np.abs(v) > 0.005, rng.standard_normal((*v.shape, 3))
    looked_at = (v, a, missing, inertial, level, *LIMITS)
    assert built_up_friction(usable, *looked_at)[0] is not None
    own, other = built_up_anywhere(usable, np.zeros(len(q)), q, *looked_at, lambda: np.zeros((*v.shape, 3)))
    assert (own is not None) is rounds
    assert other is None


@pytest.mark.parametrize("lasts", [True, False])
def test_friction_builds_up_beside_another_level_in_each_record_too(monkeypatch, lasts):
    """Friction that rose by a third after two of four recordings was told as an arctan over 0.02 rad/s."""
    parts = samples(lambda v, _: level_of(v) * np.tanh(np.abs(v) / 0.05))
    usable, velocity, inertial = parts[0], parts[1], parts[4]
    record = np.repeat(np.arange(20) // 2, len(velocity) // 20)
    asked = built_up_friction

    def by_record(usable, velocity, acceleration, missing, beside, *others):
        found = asked(usable, velocity, acceleration, missing, beside, *others)
        levels = beside.shape[-1] == inertial.shape[-1] + building_up.PARTS - 1
        return [None] * len(found) if levels and not lasts else found

    monkeypatch.setattr(building_up, "built_up_friction", by_record)
    position = np.cumsum(velocity, axis=0) / RATE
    own, other = built_up_anywhere(
        usable, record, position, *parts[1:], *LIMITS, lambda: np.zeros((*velocity.shape, 3))
    )
    assert (own is not None) is lasts
    assert other is None


@pytest.mark.parametrize("lasts", [True, False])
def test_friction_builds_up_beside_gravity_from_another_direction_too(monkeypatch, lasts):
    """A tilt of 2.5 degrees was told as an arctan over 0.03 rad/s, and a Stribeck curve beside it."""
    parts = samples(lambda v, _: level_of(v) * np.tanh(np.abs(v) / 0.05))
    usable, velocity = parts[0], parts[1]
    pulls = np.random.default_rng(6).standard_normal((*velocity.shape, 3))
    asked = built_up_friction

    def beside_pulls(usable, velocity, acceleration, missing, beside, *others):
        found = asked(usable, velocity, acceleration, missing, beside, *others)
        leans = np.array_equal(beside[..., -3:], pulls)
        return [None] * len(found) if leans and not lasts else found

    monkeypatch.setattr(building_up, "built_up_friction", beside_pulls)
    position = np.cumsum(velocity, axis=0) / RATE
    own, other = built_up_anywhere(usable, np.zeros(len(velocity)), position, *parts[1:], *LIMITS, lambda: pulls)
    assert (own is not None) is lasts
    assert other is None


def test_each_record_but_the_first_may_have_another_level():
    velocity = np.array([[1.0], [-1.0], [2.0], [-0.5], [0.3], [0.1]])
    usable, record = np.ones(velocity.shape, dtype=bool), np.array([7, 7, 3, 3, 5, 5])
    usable[4:] = False
    columns = building_up.records_apart(usable, record, velocity)
    np.testing.assert_array_equal(columns[:, 0], np.array([[0, 0, 1, -1, 0, 0]]).T)
    assert building_up.records_apart(usable, np.zeros(6), velocity).shape == (6, 1, 0)
