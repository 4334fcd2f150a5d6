"""A column of one joint under the name of another is refused; coarse, still and silent ones are not."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.copied_columns import check_columns_differ
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.refused import Refused
from jointwear.robots.dynamics import Dynamics


@pytest.fixture(scope="module")
def arm(puma):
    return puma.robot


@pytest.fixture(scope="module")
def sound(arm):
    return make_case(arm, 3)


def copied(recording, role, copy, origin, factor=1.0, rows=None, digits=None):
    values = getattr(recording, role).copy()
    rows = np.ones(len(values), bool) if rows is None else rows
    values[rows, copy] = factor * values[rows, origin]
    return replace(recording, **{role: values if digits is None else values.round(digits)})


def check(recording, robot, records=True):
    check_columns_differ(measure(recording), robot, "a log", records)


@pytest.mark.parametrize("factor", [1.0, 0.5, -2.3])
@pytest.mark.parametrize("digits", [None, 4])
def test_a_torque_of_another_joint_is_refused_with_both(sound, arm, factor, digits):
    multiple = "" if factor == 1.0 else f"{factor:g} times "
    with pytest.raises(Refused, match=f"the torque of joint 5 is {multiple}that of joint 4 in most samples in") as told:
        checked(copied(sound, "torque", 4, 3, factor, digits=digits), arm)
    assert "each joint needs a torque of its own: name the right columns under 'variables'" in told.value.suggestion


def test_a_position_of_another_joint_is_refused_with_both(sound, arm):
    with pytest.raises(Refused, match="the position of joint 5 is that of joint 4 in most samples in which"):
        checked(copied(sound, "position", 4, 3), arm)


@pytest.mark.parametrize("role", ["torque", "position"])
def test_a_copy_in_one_recording_is_told_with_it(sound, arm, role):
    one = copied(sound, role, 5, 4, rows=sound.trajectory == 2)
    with pytest.raises(Refused, match=f"the {role} of joint 6 is that of joint 5 in .* of trajectory 2 in") as told:
        check(one, arm)
    assert "leave it out: name the others under 'train' and 'test'" in told.value.suggestion


def test_what_was_measured_is_no_copy(sound, arm):
    check(sound, arm)
    # Of coarse columns, of zeros and of torques at a limit many values are the same.
    step = 2 * np.std(sound.torque[:, 4])
    check(replace(sound, torque=np.round(sound.torque / step) * step), arm)
    still = sound.torque.copy()
    still[:, 3:] = [0.0, 0.0, 1.5]
    check(replace(sound, torque=still), arm)
    limit = 0.3 * np.std(sound.torque[:, 3:])
    check(replace(sound, torque=np.clip(sound.torque, -limit, limit)), arm)
    check(copied(sound, "torque", 4, 3, rows=np.arange(len(sound.time)) % 10 < 4), arm)


def test_joints_that_are_moved_alike_without_noise_are_no_copies(arm):
    """A simulation that gives two joints one course, and explains both torques."""
    one = make_case(arm, 5, noise=0.0)
    alike = copied(one, "position", 4, 3)
    with pytest.raises(Refused):
        check(alike, arm)
    measured = measure(alike)
    torque = Dynamics(arm).inverse_dynamics(measured.position, measured.velocity, measured.acceleration)
    check_columns_differ(replace(measured, torque=torque), arm, "a log", records=True)
