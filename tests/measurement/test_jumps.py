"""Positions that jump away and back are none of the arm; what an arm does is left alone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.measurement.jumps import jumps, jumps_in_words, without_jumps
from jointwear.measurement.motion import measure
from jointwear.measurement.recording import Recording

RATE = 100.0


def moves(seconds=20.0, rate=RATE):
    time = np.arange(0, seconds, 1 / rate)
    position = np.stack([1.2 * np.sin(time), 0.8 * np.cos(1.7 * time) + 1.0, 0.02 * np.sin(2 * time)], axis=1)
    return Recording(time, np.zeros(len(time), int), position, np.zeros_like(position))


def found(recording):
    return jumps(recording.time, recording.trajectory, recording.position)


@pytest.mark.parametrize("length", [1, 2, 10, 30])
def test_a_row_of_zeros_is_lost_for_every_joint(length):
    recording = moves()
    position = recording.position.copy()
    position[500 : 500 + length] = 0.0
    away = found(replace(recording, position=position))
    assert away[500 : 500 + length].all()
    assert away.sum() == 3 * length


def test_rows_that_follow_each_other_are_told_apart():
    recording = moves()
    position = recording.position.copy()
    position[500:510], position[530:540] = 0.0, 0.0
    assert list(np.flatnonzero(found(replace(recording, position=position))[:, 0])) == [
        *range(500, 510),
        *range(530, 540),
    ]


def test_one_joint_that_jumps_is_left_out_alone():
    recording = moves()
    position = recording.position.copy()
    position[700, 1] += 0.3
    spoilt = replace(recording, position=position, velocity=np.zeros_like(position))
    mended = without_jumps(spoilt)
    assert np.isnan(mended.position[700, 1])
    assert np.isnan(mended.velocity[700, 1])
    assert np.isfinite(mended.position).sum() == position.size - 1
    assert jumps_in_words(spoilt) == ["positions of joint 2 jump away and back, first at sample 701: 1 sample left out"]


def test_a_position_that_stays_away_is_no_jump():
    recording = moves()
    position = recording.position.copy()
    position[700:, 1] += 0.3
    assert not found(replace(recording, position=position)).any()


@given(st.integers(0, 2**32 - 1), st.sampled_from([20.0, 50.0, 125.0, 500.0]), st.integers(12, 20))
def test_what_an_arm_can_do_is_left_alone(seed, rate, bits):
    random = np.random.default_rng(seed)
    time = np.arange(0, 10.0, 1 / rate)
    # Moves from stop to stop, at up to 10 rad/s and 100 rad/s2, read by an encoder.
    speed = np.zeros(len(time))
    for begin in np.arange(0.0, 10.0, 1.0):
        top, rise = random.uniform(-10, 10), random.uniform(0.1, 0.3)
        speed += top * np.clip(np.minimum(time - begin, begin + 0.8 - time) / rise, 0, 1)
    position = np.cumsum(speed)[:, None] / rate
    position = np.round(position * 2**bits / (2 * np.pi)) * (2 * np.pi) / 2**bits
    assert not jumps(time, np.zeros(len(time), int), position).any()


def test_one_row_of_zeros_does_not_hide_the_motion():
    recording = moves()
    position = recording.position.copy()
    position[500] = 0.0
    floors = [measure(r).speed_floor for r in (recording, replace(recording, position=position))]
    assert np.all(floors[1] < 2.0 * floors[0])
