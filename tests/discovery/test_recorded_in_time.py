"""The recorded torque put forward in time: exact on waves, and it tells a delay from none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_instruments import RATE, coarse

from jointwear.discovery.estimates.harmless_band import where_noise_is_harmless
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.problem.candidates import Candidate, term_of
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search.acceptance import refusals
from jointwear.discovery.search.crossval import cross_validate
from jointwear.discovery.search.recorded_in_time import (
    bridged,
    change_in_time,
    nats_of_time,
    put_forward,
    whitened_change,
)
from jointwear.discovery.settings import Settings
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot


@given(st.floats(0.5, 30.0), st.floats(-0.03, 0.03), st.floats(-3.0, 3.0), st.floats(0.0, 6.0))
def test_a_wave_on_a_slope_is_put_forward_exactly(frequency, delay, slope, phase):
    time = np.arange(400) / RATE

    def torque(t):
        return np.sin(2 * np.pi * frequency * t + phase) + slope * t

    middle = slice(100, 300)
    np.testing.assert_allclose(put_forward(torque(time), delay, RATE)[middle], torque(time + delay)[middle], atol=0.03)


@given(st.floats(-0.03, 0.03))
def test_noise_keeps_its_size_at_another_time(delay):
    noise = np.random.default_rng(0).standard_normal(2000)
    middle = slice(100, 1900)
    assert np.std(put_forward(noise, delay, RATE)[middle]) > 0.97 * np.std(noise[middle])


@given(st.lists(st.booleans(), min_size=4, max_size=80), st.floats(-3.0, 3.0))
def test_what_is_not_known_is_led_over_without_jump_or_kink(used, slope):
    used = np.array([True, True, *used, True, True])
    line = slope * np.arange(len(used))
    found = bridged(np.where(used, line, 1e3), used)
    np.testing.assert_allclose(found, line, atol=1e-9)


def whitened(robot, **told):
    recording = split(coarse(robot, **told))
    problem = build_problem(recording, robot, Settings(), measure(recording))
    return whiten(problem, estimate_noise(problem))


def test_the_recorded_torque_tells_a_delay_and_its_sign_and_none():
    robot = load_robot("config/robots/puma560.yaml")
    late, right = whitened(robot, seed=6, late=0.02), whitened(robot, seed=5)
    fit, plain = late.fit(), right.fit()
    half = 0.5 * Settings().accept
    for axis in (0, 1, 2):
        assert nats_of_time(late, fit, axis, 0.02) > half
        assert nats_of_time(late, fit, axis, -0.02) < 0
        assert max(nats_of_time(right, plain, axis, d) for d in (-0.01, 0.01)) < half


def test_a_delay_is_as_large_where_noise_is_harmless_and_a_longer_one_is_not():
    robot = load_robot("config/robots/puma560.yaml")
    late = whitened(robot, seed=6, late=0.02)
    fit, settings = late.fit(), Settings()
    for axis in (0, 1, 2):
        nats, share = where_noise_is_harmless(
            late, fit, Candidate("actuation_delay", axis, None, {"delay": 0.02, "lag": 0})
        )
        assert nats > 0.5 * settings.accept
        assert share > settings.nearly_all
        wrong = Candidate("actuation_delay", axis, None, {"delay": 0.06, "lag": 0})
        assert where_noise_is_harmless(late, fit, wrong)[1] < settings.nearly_all
        early = Candidate("actuation_delay", axis, None, {"delay": -0.02, "lag": 0})
        assert where_noise_is_harmless(late, fit, early)[0] < 0.5 * settings.accept


def test_friction_that_jumps_does_not_hide_a_fraction_of_a_sample():
    robot = load_robot("config/robots/puma560.yaml")
    late = whitened(robot, seed=6, step=2 * np.pi / 2**22, late=0.4 / RATE)
    fit, half = late.fit(), 0.5 * Settings().accept
    for axis in (0, 1, 2):
        assert nats_of_time(late, fit, axis, 0.4 / RATE) > half
        assert nats_of_time(late, fit, axis, -0.4 / RATE) < 0


def test_a_torque_that_cannot_be_judged_says_nothing_of_a_delay():
    robot = load_robot("config/robots/puma560.yaml")
    white = whitened(robot, seed=6)
    problem, axis, delay = white.problem, 1, 0.01
    usable = problem.measured.usable.copy()
    usable[300:340, axis] = False
    torque = problem.measured.torque.copy()
    torque[300:340, axis] = 1e3
    spoilt = replace(problem, measured=replace(problem.measured, usable=usable, torque=torque))
    change, _ = change_in_time(replace(white, problem=spoilt), white.fit(), axis, delay)
    # Two samples later lies what cannot be judged.
    assert not change[298:338].any()
    assert np.abs(change[:290]).max() < 1e2
    plain, _ = change_in_time(white, white.fit(), axis, delay)
    np.testing.assert_allclose(change[:200], plain[:200], atol=0.05 * np.abs(plain).max())


@pytest.mark.parametrize("delay", [0.01, -0.01])
def test_a_stretch_that_cannot_be_judged_leaves_no_jump_beside_it(delay):
    """Slow noise is whitened by differences: a change that ended at that stretch would be a jump of many deviations."""
    white = whitened(load_robot("config/robots/puma560.yaml"), seed=6)
    axis = 1
    lags = np.array([1.6, -0.62])
    slow = [None if w is None else replace(w, lags=lags, sigma=0.1 * w.sigma) for w in white.whiteners]
    white = replace(white, whiteners=slow)
    usable = white.problem.measured.usable.copy()
    usable[300:340, axis] = False
    spoilt = replace(white.problem, measured=replace(white.problem.measured, usable=usable))
    whole, cut = (whitened_change(replace(white, problem=p), white.fit(), axis, delay) for p in (white.problem, spoilt))
    rows = white.whiteners[axis].rows
    elsewhere = (rows < 300) | (rows > 355)
    wanted = np.where(cut == 0.0, 0.0, whole)[elsewhere]
    np.testing.assert_allclose(cut[elsewhere], wanted, atol=0.1 * np.abs(whole).max())
    assert np.mean(cut != 0.0) > 0.9


def test_a_clock_that_is_far_off_predicts_as_well_as_a_delay_but_is_not_believed():
    white = whitened(load_robot("config/robots/puma560.yaml"), seed=6, step=2 * np.pi / 2**22, late=0.8 / RATE)
    settings = white.problem.settings
    one = Candidate("actuation_delay", 1, None, {"delay": 0.8 / RATE, "lag": 0})
    term = term_of(white, one)
    evidence = white.fit([term]).evidence - white.fit().evidence
    assert evidence > 10.0 * settings.accept
    assert cross_validate(white, [], [term]).nats < settings.accept
    assert not refusals(white, [], Named(one, term, None, evidence))
