"""Torques of another size than the model's: refused with the factor, whatever load the arm carries."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.measurement.checks import Refused
from jointwear.measurement.motion import measure
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.silent_joints import moving_torques
from jointwear.measurement.torque_follows import check_follows
from jointwear.measurement.torque_scale import check_scale
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def example():
    recording = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    return recording, load_robot("config/robots/puma560.yaml"), measure(recording)


def check(example, factor, more=0.0):
    recording, robot, measured = example
    check_scale(recording, robot, replace(measured, torque=measured.torque * factor + more))


def test_a_torque_of_the_models_size_is_taken(example):
    check(example, 1.0)
    check(example, np.array([0.7, 1.3, 0.9, 1.2, 0.8, 1.1]))


@pytest.mark.parametrize(
    ("factor", "words", "key"),
    [
        (0.1, "0.1.* on joint 2", "'torque_constant'"),
        (1000.0, "looks like mN m", "torque: mN m"),
        (1 / np.array([3.0, 4.0, 5.0, 6.0, 7.0, 8.0]), "looks like a current", "'torque_constant'"),
    ],
)
def test_another_unit_or_a_current_is_told_with_its_key(example, factor, words, key):
    with pytest.raises(Refused, match=words) as refusal:
        check(example, factor)
    assert key in refusal.value.suggestion


def test_one_joint_in_another_unit_is_told(example):
    with pytest.raises(Refused, match="torque of joint 3 is 903 times that of the model") as refusal:
        check(example, np.array([1.0, 1.0, 1000.0, 1.0, 1.0, 1.0]))
    assert "'scale' with 0.00111 for joint 3" in refusal.value.suggestion


def test_a_heavy_load_is_no_unit(example):
    _, robot, measured = example
    load = FlangeLoad(robot).unit_sum(measured.position, measured.velocity, measured.acceleration)
    check(example, 1.0, np.einsum("mkn,k->mn", load, [20.0, 0.0, 0.0, 4.0]))


@pytest.mark.parametrize("turn", [lambda x: np.random.default_rng(0).permutation(x), lambda x: np.roll(x, 300, axis=0)])
def test_torques_of_other_rows_are_told(example, turn):
    _, robot, measured = example
    check_follows(measured, robot, "arm")
    with pytest.raises(Refused, match="does not follow the motion"):
        check_follows(replace(measured, torque=turn(measured.torque)), robot, "arm")


def test_a_joint_whose_torque_keeps_one_value_is_not_judged_and_all_of_them_are_refused(example):
    recording, _, _ = example
    still = recording.torque.copy()
    still[:, 2] = 0.0
    found = moving_torques(replace(recording, torque=still))
    assert found.usable.any(axis=0).tolist() == [True, True, False, True, True, True]
    with pytest.raises(Refused, match="keeps one value while the axes move"):
        moving_torques(replace(recording, torque=np.ones_like(still)))
