"""Stops: what holds a joint, or a drive that two joints share, does not jump; and what is asked of a slow drive."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear import effects
from jointwear.effects.order import late_torque, smoothed_torque
from jointwear.effects.rests import SLOW, rests, sense_of
from jointwear.robots.robot import load_robot
from jointwear.statistics.runs import runs

RATE = 100.0


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


def sampled(robot, velocity, rigid=None, noise=0.0):
    """Return an ordered state whose first two joints turn at `velocity` (m,) and the given rigid-body torque."""
    rng = np.random.default_rng(1)
    speed = np.zeros((len(velocity), 6))
    speed[:, 0] = velocity + noise * rng.standard_normal(len(velocity))
    speed[:, 1] = 0.5
    time = np.arange(len(velocity)) / RATE
    torque = np.zeros_like(speed) if rigid is None else np.repeat(rigid[:, None], 6, axis=1)
    zero = np.zeros_like(speed)
    return effects.make_state(robot, zero, speed, zero, torque, time=time, record=np.zeros(len(time), int))


def stopping(still, after=-1.0):
    """Return a velocity that falls to nothing, stays for `still` samples, and leaves again."""
    return np.concatenate([np.linspace(0.5, 0.05, 40), np.zeros(still), after * np.linspace(0.05, 0.5, 40)])


@settings(max_examples=30, deadline=None)
@given(st.integers(3, 40), st.sampled_from([-1.0, 1.0]))
def test_a_stop_lies_between_the_moving_samples(still, after):
    velocity = stopping(still, after)
    (found,) = rests(velocity, np.arange(len(velocity)) / RATE, [slice(0, len(velocity))])
    assert found.samples == slice(40, 40 + still)
    assert (found.before, found.after) == (1.0, after)
    share = found.sense(np.arange(40, 40 + still) / RATE)
    assert np.all(np.abs(share) <= 1)
    assert np.all(np.diff(share) * after >= 0)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.02, 5.0), st.floats(0, 1))
def test_turning_without_a_stop_is_none(acceleration, offset):
    velocity = acceleration * (np.arange(200) - 100 + offset) / RATE
    assert not rests(velocity, np.arange(200) / RATE, [slice(0, 200)])


@settings(max_examples=30, deadline=None)
@given(st.floats(0.02, 5.0), st.floats(0.1, 0.9))
def test_a_drive_that_turns_slowly_has_a_sense(acceleration, offset):
    velocity = acceleration * (np.arange(200) - 100 + offset) / RATE
    np.testing.assert_array_equal(sense_of(velocity, [slice(0, 200)]), np.sign(velocity))


def test_a_drive_that_stands_still_or_chatters_has_none():
    standing = np.concatenate([1e-3 * (-1.0) ** np.arange(30), np.linspace(SLOW, 1, 30)])
    assert np.all(sense_of(standing, [slice(0, 60)]) == np.repeat([0.0, 1.0], 30))
    chattering = np.array([-0.3, -0.2, -0.1, 0.01, 0.01, -0.008, 0.1, 0.2, 0.3])
    np.testing.assert_array_equal(sense_of(chattering, [slice(0, 9)]), [-1, -1, -1, 0, 0, 0, 1, 1, 1])


def test_a_record_that_begins_at_rest_has_no_stop():
    velocity = np.concatenate([np.zeros(30), np.linspace(SLOW, 1, 30)])
    assert not rests(velocity, np.arange(60) / RATE, [slice(0, 60)])


@pytest.mark.parametrize("delay", [-0.03, 0.03])
def test_noise_of_a_joint_at_rest_is_no_jump_of_friction(robot, delay):
    state = sampled(robot, stopping(30), noise=1e-3)
    late = np.diff(late_torque(state, 0, delay))
    height = robot.coulomb_positive[0] - robot.coulomb_negative[0]
    assert np.max(np.abs(np.diff(state.torque[:, 0]))) > 0.9 * height
    assert np.max(np.abs(late)) < 0.15 * height
    behind = smoothed_torque(state, 0, delay)
    assert np.max(np.abs(np.diff(behind))) < 0.35 * height


@settings(max_examples=20, deadline=None)
@given(st.floats(0.005, 0.03), st.floats(0.3, 1.5))
def test_what_is_asked_of_a_slow_drive_leads_what_it_gives(robot, lag, frequency):
    time = np.arange(400) / RATE
    w = 2 * np.pi * frequency
    state = sampled(robot, np.ones(400), np.sin(w * time))
    inner = slice(20, 380)
    constant = state.torque[:, 0] - np.sin(w * time)
    led = (smoothed_torque(state, 0, -lag) - constant)[inner]
    np.testing.assert_allclose(
        led, (np.sin(w * time) + lag * w * np.cos(w * time))[inner], atol=0.2 * (lag * w) ** 3 + 5e-3
    )


def test_a_shared_drive_that_sticks_keeps_its_friction(robot):
    effect = effects.get_effect("drive_coupling")
    state = sampled(robot, stopping(30) - 0.5)
    column = effect.columns(state, 0, 1, {"own": 1.0, "other": 1.0})[:, 0]
    assert (column[39], column[70]) == (1, -1)
    assert np.all(np.diff(column[39:71]) < 0)
    unordered = effect.columns(replace(state, record=None), 0, 1, {"own": 1.0, "other": 1.0})[:, 0]
    assert np.all(unordered[40:70] == 0)


def test_a_part_of_a_motion_has_waves_and_a_torque_of_its_own(robot):
    state = sampled(robot, stopping(5), np.linspace(1.0, 2.0, 85))
    state = replace(state, position=np.cumsum(state.velocity, axis=0) / RATE)
    chosen = np.arange(20, 60)
    whole, now = state.waves_of(0, 3.0), late_torque(state, 0, 0.0)
    assert replace(state, torque=2.0 * state.torque).waves_of(0, 3.0) is whole
    np.testing.assert_array_equal(state.part(chosen).waves_of(0, 3.0), whole[chosen])
    moved = replace(state, position=state.position + 1.0)
    np.testing.assert_allclose(moved.waves_of(0, 3.0)[:, 0], np.sin(3.0 * moved.position[:, 0]))
    assert not np.allclose(late_torque(replace(state, torque=2.0 * state.torque), 0, 0.0), now)


def test_runs_are_told_by_how_long_they_are():
    values = np.array([1, 1, 0, 2, 2, 2])
    assert list(runs(values, 10)) == [slice(10, 12), slice(12, 13), slice(13, 16)]
    assert list(runs(values, shortest=2)) == [slice(0, 2), slice(3, 6)]
    assert list(runs(values, longest=2)) == [slice(0, 2), slice(2, 3)]
    assert not list(runs(values[:0]))
