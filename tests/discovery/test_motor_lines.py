"""Waves over the motor angle in the noise: plain ones are held by the fit behind it, others are not."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery.noise.gear_waves import gear_orders
from jointwear.discovery.noise.noise import estimate
from jointwear.discovery.noise.ridge_fit import RidgeFit
from jointwear.discovery.pipeline import discover
from jointwear.discovery.problem.motor_lines import loud_waves, waves_in_band
from jointwear.discovery.problem.saturated import axis_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.settings import Settings
from jointwear.effects import get_effect, make_state
from jointwear.measurement.derived.derived_noise import DerivedNoise
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split

AXIS = 2


def cogging(robot, size, order=1):
    gear = order * robot.gear_ratio[AXIS]

    def hidden(q, v, *_):
        full = np.zeros_like(q)
        full[:, AXIS] = size * np.sin(gear * q[:, AXIS] + 0.3)
        return full

    return hidden


def noise_of(robot, size):
    problem = build_problem(split(make_case(robot, 5, cogging(robot, size))), robot, Settings())
    return axis_noise(problem, AXIS)


def test_a_plain_cogging_torque_is_no_noise(robot):
    quiet = noise_of(robot, 0.0).marginal
    assert noise_of(robot, 20.0 * quiet).marginal == pytest.approx(quiet, rel=0.3)


def test_a_wave_is_held_by_how_quiet_the_residual_is_without_it(robot):
    """The noise model of the residual with the wave may know all of it: that says nothing against the wave."""
    problem = build_problem(split(make_case(robot, 5, cogging(robot, 0.5))), robot, Settings())
    state, rng = problem.train_state, np.random.default_rng(1)
    noise = 0.01 * rng.standard_normal(problem.discrepancy.shape)
    wave = get_effect("cogging_torque").columns(state, AXIS, None, {"order": 1.0})

    def found(size):
        noise[problem.train, AXIS] += size * wave[:, 0]
        label = problem.measured.trajectory[problem.train]
        white = estimate(noise[problem.train, AXIS], problem.usable[:, AXIS], label, 6)
        waves = waves_in_band(problem, AXIS, state)
        offset = RidgeFit(np.ones((len(label), 1)), problem.usable[:, AXIS], None)
        left = offset(noise[problem.train, AXIS])
        return loud_waves(replace(problem, discrepancy=noise), AXIS, waves, white, offset, left, 6)

    assert found(0.0).shape[1] == 0
    loud = found(0.4)
    left = np.linalg.lstsq(loud, wave, rcond=None)
    assert loud.shape[1]
    np.testing.assert_allclose(loud @ left[0], wave, atol=1e-6)


def test_the_answer_of_a_controller_is_seen_where_filters_take_the_shaking(robot):
    """Bends of cogging hold the wave above the band of the accelerations, those of a ripple of the constant nothing."""
    time = np.linspace(0.0, 1.0, 200)
    q = np.zeros((200, robot.joints))
    q[:, AXIS] = 1.5 * time**2
    v = np.gradient(q, time, axis=0)
    state = make_state(robot, q, v, np.zeros_like(q), v + 1.0, time=time)
    object.__setattr__(state, "derives", lambda axis, frequency: (frequency < 10.0).astype(float))
    fast = np.abs(robot.gear_ratio[AXIS] * v[:, AXIS]) / (2 * np.pi) >= 10.0
    answered = get_effect("cogging_torque").bend.columns(state, AXIS, None, {"order": 1.0}, None)[:, -2:]
    assert not np.any(answered[~fast])
    assert np.allclose(np.sum(answered[fast] ** 2, axis=1), 1.0)
    ripple = get_effect("torque_constant_ripple").bend.columns(state, AXIS, None, {"order": 1.0}, None)[:, -2:]
    assert not np.any(ripple)


def test_fast_cogging_under_a_stiff_controller_has_its_name(robot):
    """The joint follows its path exactly, so that the drive gives all of the wave and none is in the acceleration."""
    found = discover(make_case(robot, 5, cogging(robot, 0.3, order=2)), robot)
    assert [(e["effect"], e["axis"]) for e in found.effects] == [("cogging_torque", AXIS + 1)]
    assert found.effects[0]["parameters"]["held"]["value"] == 1.0
    assert found.effects[0]["parameters"]["amplitude"]["value"] == pytest.approx(0.3, rel=0.05)


@pytest.mark.long
def test_a_wave_of_a_gear_has_its_order_and_its_name(robot):
    """Forty waves in a turn of the joint are 0.7 in one of the motor; whole orders are tried anyway."""
    of_gear, of_motor = (make_case(robot, 5, cogging(robot, 0.3, order)) for order in (0.7, 2))
    shown = [build_problem(split(case), robot, Settings()).train_state.gear_orders for case in (of_gear, of_motor)]
    assert [len(orders) for orders in shown[0]] == [axis == AXIS for axis in range(robot.joints)]
    assert shown[0][AXIS][0] == pytest.approx(0.7, rel=0.01)
    assert not any(shown[1])
    found = discover(of_gear, robot)
    assert [(e["effect"], e["axis"]) for e in found.effects] == [("cogging_torque", AXIS + 1)]
    assert found.effects[0]["parameters"]["amplitude"]["value"] == pytest.approx(0.3, rel=0.1)


@pytest.mark.parametrize(
    ("steps", "times", "logged"), [(9000, 1, True), (9000, 3, True), (2**13, 1, False), (2**13, 3, False)]
)
def test_what_repeats_with_the_step_of_an_encoder_is_the_controllers(steps, times, logged):
    """A controller answers to each step of a coarse encoder behind a gear of 100 as it would to a wave.

    The steps are those of the log, or any power of two in a turn: a controller may read fewer bits than are logged.
    """
    rng, step, gear = np.random.default_rng(4), 2 * np.pi / steps, 100.0
    time = np.linspace(0.0, 1.0, 4000)
    position, used = np.sin(2 * np.pi * time) + 0.3 * np.sin(7.3 * time), np.ones(4000, dtype=bool)
    answered = 0.1 * np.sin(times * 2 * np.pi / step * position + 0.4)
    meshed = 0.1 * np.sin(0.7 * gear * position + 0.2)
    take_off = RidgeFit(np.full((4000, 1), 4000**-0.5), used, None)

    def orders(wave, encoder_step):
        residual, torque = wave + 0.02 * rng.standard_normal(4000), np.ones(4000)
        label = np.zeros(4000)
        return gear_orders(residual, take_off, position, torque, used, label, gear, np.inf, 9.0, encoder_step)

    known = step if logged else 2 * np.pi / 2**19
    assert orders(answered, known) == ()
    if logged:
        assert orders(answered, np.nan) == pytest.approx((times * steps / gear,), rel=1e-4)
    # What a gear adds to it keeps its order.
    assert orders(answered + meshed, known) == pytest.approx((0.7,), rel=0.01)


def test_a_held_wave_is_tried_where_filters_made_the_accelerations(robot):
    state = make_state(robot, *np.zeros((4, 5, robot.joints)))
    effect = get_effect("cogging_torque")
    assert not any("held" in p for p in effect.grid(state, AXIS))
    object.__setattr__(state, "derives", lambda axis, frequency: np.zeros(np.shape(frequency)))
    assert any("held" in p for p in effect.grid(state, AXIS))
    held, shaken = (effect.columns(state, AXIS, None, {"order": 1.0, "held": h}) for h in (1.0, 0.0))
    assert np.allclose(held[:, 1], 1.0)
    assert not shaken.any()


def test_what_takes_noise_off_accelerations_takes_the_shaking_of_a_wave(robot):
    """A controller that chatters leaves the filter at its highest cut-off, where noise is most of the acceleration."""
    recording = split(make_case(robot, 5))
    measured, frequency = measure(recording), np.array([2.0, 35.0])
    band, size = np.full(robot.joints, 0.4 * measured.rate), 50.0
    density = np.full((1, robot.joints), 2.0 * size**2 / measured.rate)
    noise = DerivedNoise(density, (0,), band, False, measured.rate)
    measured = replace(measured, fitted=False, cutoff=band, noise=noise)
    shaken = size * np.random.default_rng(2).standard_normal(measured.acceleration.shape)
    coarse = replace(measured, acceleration=measured.acceleration + shaken)
    calm, loud = (
        build_problem(recording, robot, Settings(), x).train_state.derives(AXIS, frequency) for x in (measured, coarse)
    )
    assert calm.min() > 0.95
    assert loud[0] > 0.95
    assert loud[1] < 0.5
