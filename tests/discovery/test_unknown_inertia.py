"""A robot whose file knows no motor inertia is asked with the motors that the data show, and the verdict tells them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover
from jointwear.discovery.model.retuned import known_to
from jointwear.discovery.posing import pose_problem
from jointwear.effects.order import change_by_delay
from jointwear.measurement.recording import split

#: Delay [s] of one joint.
LATE = 0.01


@pytest.fixture(scope="module")
def recording(robot):
    return split(make_case(robot, 29, lambda q, v, *_: np.zeros_like(q)))


def _posed(recording, robot):
    return pose_problem(recording, robot, Settings()).problem


def test_the_problem_is_that_of_the_robot_with_its_motors_and_the_given_torque_that_of_the_file(recording, robot):
    found, true = _posed(recording, robot.without_motor_inertia()), _posed(recording, robot)
    assert found.motors.inertia == pytest.approx(robot.armature, rel=0.1)
    assert np.array_equal(found.robot.armature, found.motors.inertia)
    assert np.array_equal(found.state.drive.armature, found.motors.inertia)
    off = found.motors.inertia - robot.armature
    assert np.all(np.abs(off) < 4.0 * found.motors.std)
    # That of the first joint is felt as inertia of links alone, which are known to 5 %.
    assert np.all(found.motors.std < 0.2 * robot.armature)
    assert found.mass_squares == pytest.approx(true.mass_squares, rel=0.2)
    moved = true.given_torque - robot.armature * true.state.acceleration
    assert found.given_torque == pytest.approx(moved, abs=1e-9)


def test_what_a_late_torque_changes_holds_the_motors(recording, robot):
    found, true = (_posed(recording, one) for one in (robot.without_motor_inertia(), robot))
    late, right = (change_by_delay(p.state, 1, LATE) for p in (found, true))
    assert np.std(late - right) < 0.2 * np.std(right)


def test_a_motor_that_is_known_or_not_felt_is_left_alone(recording, robot):
    assert _posed(recording, robot).motors is None
    behind = replace(recording, torque_kind="link_sensor")
    assert _posed(behind, robot.without_motor_inertia()).motors is None
    some = np.where(np.arange(robot.joints) == 2, 0.0, robot.armature)
    assert np.array_equal(np.flatnonzero(_posed(recording, replace(robot, armature=some)).motors.inertia), [2])


@pytest.mark.long
def test_the_motors_are_told_and_written_and_the_gap_is_that_of_the_given_file(recording, robot):
    bare = robot.without_motor_inertia()
    found = discover(recording, bare)
    assert found.verdict == "retuned"
    told = {one.axis - 1: one for one in found.content.retuned if one.parameter == "motor_inertia"}
    assert sorted(told) == list(range(robot.joints))
    at_motor = robot.armature / np.square(robot.gear_ratio)
    for axis, one in told.items():
        assert one.nominal == 0.0
        assert one.value == pytest.approx(at_motor[axis], rel=0.1)
        assert one.std > 0.0
    written = [joint["motor_inertia"] for joint in found.augmented_robot["joints"]]
    assert written == pytest.approx([told[axis].value for axis in sorted(told)], rel=1e-5)
    gap = found.content.gap
    assert max(np.array(gap.retuned) / np.array(gap.nominal)) < 0.9


@pytest.mark.parametrize(
    ("held", "corrected", "std"),
    [([2e-8], 2e-8, 0.03), ([6.0], 0.01, 0.01), ([], 0.0, 0.03)],
    ids=["held at what was found", "fitted freely", "put back"],
)
def test_a_motor_that_is_held_at_what_was_found_is_known_no_better_than_it_was_found(held, corrected, std):
    terms = [SimpleNamespace(drive=(0, 3), std=np.array([width])) for width in held]
    final = SimpleNamespace(std_friction=np.array([[0.0, 0.0, 0.0, corrected]]), fit=SimpleNamespace(terms=terms))
    assert known_to(final, 0, 3, std_found=0.03) == std
    # A parameter that the file gives is known as its correction is.
    assert known_to(final, 0, 3, std_found=0.0) == corrected
