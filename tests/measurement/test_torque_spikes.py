"""Torques of a few samples that stand far out of all others are left out and told; what arms do is left alone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.measurement.checks.checked import checked
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.derived.torque_spikes import (
    spikes,
    spikes_in_words,
    spikes_of,
    without_spikes,
    without_spikes_of,
)
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording, split
from jointwear.measurement.recording_files import load_recording
from jointwear.robots.robot import load_robot

RATE = 125.0


def moves(seconds=20.0, rate=RATE, noise=0.2):
    """Return a motion of two joints, the torque of inertia, weight and Coulomb friction, and noise."""
    time = np.arange(0, seconds, 1 / rate)
    position = np.stack([1.2 * np.sin(time), 0.8 * np.cos(1.7 * time)], axis=1)
    torque = np.stack(
        [
            5 * np.sin(time) + 8 * np.sign(np.cos(time)),
            20 * np.cos(position[:, 1]) - 3 * np.sign(np.sin(1.7 * time)),
        ],
        axis=1,
    )
    torque += noise * np.random.default_rng(1).normal(size=torque.shape)
    return Recording(time, np.zeros(len(time), int), position, torque)


def found(recording):
    return spikes(recording.time, recording.trajectory, recording.torque)


def with_torque(recording, rows, joint, added):
    torque = recording.torque.copy()
    torque[rows, joint] += added
    return replace(recording, torque=torque)


@given(
    joint=st.integers(0, 1),
    starts=st.lists(st.integers(1, 245), min_size=1, max_size=8, unique=True),
    length=st.integers(1, 3),
    size=st.floats(3.0, 1e6),
    side=st.sampled_from([-1, 1]),
)
def test_few_torques_beyond_all_others_are_found_and_no_others(joint, starts, length, size, side):
    whole = moves()
    rows = np.concatenate([10 * k + np.arange(length) for k in starts])
    span = float(np.ptp(whole.torque[:, joint]))
    away = found(with_torque(whole, rows, joint, side * size * span))
    assert set(np.flatnonzero(away[:, joint])) == set(rows)
    assert not away[:, 1 - joint].any()


@given(st.sampled_from([5.0, 25.0, 40.0, 60.0, 125.0, 250.0, 1000.0]), st.floats(0.0, 3.0), st.floats(0.06, 0.5))
def test_what_an_arm_does_is_no_spike(rate, noise, pulse):
    still = moves(rate=rate, noise=noise)
    assert not found(still).any()
    # An arm that rests, but for one acceleration: all torque that there is.
    time = np.arange(0, 20, 1 / rate)
    pushed = np.zeros((len(time), 2))
    pushed[(time > 5) & (time < 5 + pulse), 0] = 40.0
    pushed += 0.01 * np.random.default_rng(2).normal(size=pushed.shape)
    assert not found(Recording(time, np.zeros(len(time), int), pushed * 0, pushed)).any()


@pytest.mark.parametrize("rate", [12.5, 20.0, 25.0, 30.0])
def test_a_sample_of_a_slow_log_that_is_far_beyond_all_others_is_found(rate):
    """Below 40 Hz an acceleration may be as short: nothing was asked, and three spikes cost half of a log."""
    whole = moves(seconds=60.0, rate=rate)
    span = float(np.ptp(whole.torque[:, 1]))
    assert list(np.argwhere(found(with_torque(whole, [200, 400], 1, 4 * span)))[:, 0]) == [200, 400]
    # What is short and no larger may be the one hard stop of a log.
    assert not found(with_torque(whole, [200], 1, 1.2 * span)).any()
    assert not found(whole).any()


def test_a_step_that_stays_and_many_at_once_are_a_signal():
    whole = moves()
    assert not found(with_torque(whole, slice(1000, None), 0, 500.0)).any()
    many = np.arange(10, len(whole.time), 20)
    assert not found(with_torque(whole, many, 0, 500.0)).any()


def test_spikes_are_told_with_joint_and_sample_and_cost_these_samples_alone():
    whole = moves()
    rows = np.array([700, 1200, 1201])
    spoilt = with_torque(whole, rows, 1, 900.0)
    assert spikes_in_words(spikes_of(whole)) == []
    (told,) = spikes_in_words(spikes_of(spoilt))
    assert told.startswith("3 torques of joint 2 differ from those beside them by more than the whole range of all ")
    assert told.endswith("first at sample 701: left out")
    assert np.isnan(without_spikes(spoilt, spikes_of(spoilt)).torque).sum() == 3
    assert without_spikes(whole, spikes_of(whole)) is whole
    one, other = measure(whole), measure(spoilt)
    np.testing.assert_array_equal(other.spiked, spikes_of(spoilt))
    assert not one.spiked.any()
    # A torque is no part of the motion: it is derived as if nothing were missing.
    np.testing.assert_array_equal(one.acceleration, other.acceleration)
    lost = one.usable & ~other.usable
    assert set(np.flatnonzero(lost[:, 1])) <= set(rows)
    assert lost[:, 1].any()
    assert not lost[:, 0].any()
    assert not (other.usable & ~one.usable).any()
    np.testing.assert_array_equal(one.torque[other.usable], other.torque[other.usable])


@pytest.mark.parametrize("rate", [500.0, 1000.0])
def test_where_the_torque_is_filtered_what_the_filter_reaches_is_left_out(rate):
    whole = moves(rate=rate)
    spoilt = with_torque(whole, [4000], 0, 900.0)
    one, other = measure(whole), measure(spoilt)
    lost = np.flatnonzero(one.usable[:, 0] & ~other.usable[:, 0])
    assert 0 < len(lost) < 0.2 * one.rate
    assert np.abs(one.torque - other.torque)[other.usable].max() < 1e-3
    np.testing.assert_array_equal(one.usable[:, 1], other.usable[:, 1])


def test_samples_of_a_log_lose_them_too():
    whole = moves()
    chunk = Chunk(whole.time, whole.position, with_torque(whole, [700], 1, 900.0).torque)
    stretch = np.zeros(len(whole.time), int)
    assert list(np.argwhere(np.isnan(without_spikes_of(chunk, stretch).torque))[0]) == [700, 1]
    plain = Chunk(whole.time, whole.position, whole.torque)
    assert without_spikes_of(plain, stretch) is plain


def test_discovery_tells_spikes_and_jumps_where_they_were_recorded():
    found = split(load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm"))
    torque, position = found.torque.copy(), found.position.copy()
    torque[700, 1], position[900, 2] = 5e3, position[900, 2] + 2.0
    read = checked(replace(found, torque=torque, position=position), load_robot("config/robots/puma560.yaml"))
    measured, told = read.measured, read.restrictions
    assert list(np.argwhere(measured.spiked)[0]) == [700, 1]
    assert list(np.argwhere(measured.jumped)[0]) == [900, 2]
    words = [line for line in told if "left out" in line]
    assert len(words) == 2
    assert "positions of joint 3 jump away" in words[0]
    assert "first at sample 901: 1 sample left out" in words[0]
    assert words[1].startswith("1 torque of joint 2 ")
    assert words[1].endswith("first at sample 701: left out")
