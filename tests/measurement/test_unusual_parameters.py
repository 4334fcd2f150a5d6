"""What a robot file says that is seldom meant is told in words, and refuses nothing."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.measurement.checks.model_size import unusual_parameters
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def puma():
    return load_robot("config/robots/puma560.yaml")


def geared(robot, joints, ratio):
    gear = robot.gear_ratio.copy()
    gear[joints] = ratio
    return replace(robot, gear_ratio=gear)


def test_a_gear_ratio_that_is_left_out_beside_geared_joints_is_told(puma):
    assert not unusual_parameters(puma)
    (told,) = unusual_parameters(geared(puma, [1], 1.0))
    assert told.startswith("the gear ratio of joint 2 is 1, as it is where a robot file says nothing of it")
    assert "give 'gear_ratio' unless that is so" in told


def test_direct_drives_and_joints_without_a_drive_are_not_told(puma):
    assert not unusual_parameters(geared(puma, list(range(6)), 1.0))
    none = np.where(np.arange(6) == 1, 0.0, 1.0)
    bare = replace(
        geared(puma, [1], 1.0),
        armature=puma.armature * none,
        viscous=puma.viscous * none,
        coulomb_positive=puma.coulomb_positive * none,
        coulomb_negative=puma.coulomb_negative * none,
    )
    assert not unusual_parameters(bare)
