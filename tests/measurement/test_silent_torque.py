"""A torque that keeps one value while its joint turns was not recorded there."""

from dataclasses import replace

import numpy as np

from jointwear.measurement.checks.silent_joints import moving_torques, silence_in_words
from jointwear.measurement.recording import Recording

RATE = 100.0


def moves():
    time = np.arange(0, 20.0, 1 / RATE)
    position = np.stack([np.sin(time), np.cos(1.3 * time)], axis=1)
    torque = 5 * np.cos(time)[:, None] + np.random.default_rng(1).standard_normal(position.shape)
    return Recording(time, np.zeros(len(time), int), position, torque)


def test_a_while_without_torque_is_left_out_and_told():
    recording = moves()
    torque = recording.torque.copy()
    torque[400:800, 1] = 0.0
    measured = moving_torques(replace(recording, torque=torque))
    assert not measured.usable[400:800, 1].any()
    assert measured.usable[400:800, 0].sum() > 300
    assert silence_in_words(measured) == [
        "the torque of joint 2 keeps one value in 400 samples in which the joint turns, first at 4 s: left out"
    ]
    (told,) = silence_in_words(replace(measured, time=measured.time + 14_406.4))
    assert told.endswith("first at 14410 s: left out")


def test_a_coarse_scale_and_a_rest_are_recorded():
    recording = moves()
    # The arm stops where it is and goes on from there.
    rows = np.clip(np.arange(2000), 0, 1000) + np.maximum(np.arange(2000) - 1400, 0)
    torque = np.round(recording.torque / 4.0) * 4.0
    assert (
        silence_in_words(moving_torques(replace(recording, torque=torque[rows], position=recording.position[rows])))
        == []
    )
