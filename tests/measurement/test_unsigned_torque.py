"""Torques without their sign are refused with that cause, and torques that a preload keeps on one side are not."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.checks.unsigned_torque import check_torque_has_sign
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split
from jointwear.measurement.recording_files import load_recording
from jointwear.measurement.refused import Refused
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def example():
    recording = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    return recording, load_robot("config/robots/puma560.yaml")


def ask(recording, robot):
    check_torque_has_sign(recording.torque, measure(recording), robot, "arm")


def test_sizes_that_an_entry_turned_around_are_refused_too(example):
    recording, robot = example
    turned = np.abs(recording.torque) * np.array([1, -1, 1, 1, -1, 1])
    with pytest.raises(Refused, match="without their sign"):
        ask(replace(recording, torque=turned), robot)


def test_sizes_alone_are_refused_with_their_cause(example):
    recording, robot = example
    with pytest.raises(Refused, match="without their sign"):
        checked(replace(recording, torque=np.abs(recording.torque)), robot)


def test_right_torques_pass(example):
    recording, robot = example
    ask(recording, robot)


def test_torques_that_a_preload_keeps_on_one_side_pass(example):
    recording, robot = example
    preloaded = replace(recording, torque=recording.torque - recording.torque.min(axis=0))
    ask(preloaded, robot)


@pytest.mark.parametrize("axis", range(6))
def test_the_size_of_one_torque_alone_is_told_where_gravity_moves_it(example, axis):
    recording, robot = example
    torque = recording.torque.copy()
    torque[:, axis] = np.abs(torque[:, axis])
    with pytest.raises(Refused, match=f"torque of joint {axis + 1} keeps its sign.*without its sign"):
        ask(replace(recording, torque=torque), robot)


@pytest.mark.parametrize("axis", range(6))
def test_one_torque_that_a_preload_keeps_on_one_side_passes(example, axis):
    recording, robot = example
    torque = recording.torque.copy()
    torque[:, axis] -= torque[:, axis].min()
    ask(replace(recording, torque=torque), robot)


def test_sizes_beside_one_torque_with_its_sign_are_told(example):
    recording, robot = example
    torque = np.abs(recording.torque)
    torque[:, 3] = recording.torque[:, 3]
    with pytest.raises(Refused, match=r"joints 1, 2, 3, 5 and 6 keeps its sign[^;]*without their sign"):
        ask(replace(recording, torque=torque), robot)
