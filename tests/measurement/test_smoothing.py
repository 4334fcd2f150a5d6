"""Derivatives by least-squares splines, and numbers of a nominal model that are right."""

import numpy as np
import pytest

from jointwear.measurement.derived.filtering import low_pass
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.derived.smoothing import CLEAR_OF_END, END, LONGEST_END, smooth
from jointwear.measurement.recording import Recording

STEP = 2e-5


def motion(seconds=15.0, rate=100.0):
    time = np.arange(0, seconds, 1 / rate)
    order, size = 2 * np.pi * np.array([[0.23, 0.61, 0.95], [0.31, 0.47, 0.7]]).T, np.array([[0.6, 0.2, 0.1]]).T
    phase = time[:, None, None] * order + 0.4
    q, v, a = (np.sum(x * size, axis=1) for x in (np.sin(phase), order * np.cos(phase), -(order**2) * np.sin(phase)))
    return time, q, v, a


def recording(time, q, v=None, a=None):
    return Recording(time, np.zeros(len(time), int), STEP * np.round(q / STEP), np.ones_like(q), v, a)


def rms(x):
    return np.sqrt(np.mean(x**2, axis=0))


def test_accelerations_of_rounded_positions_beat_the_filter():
    time, q, _, a = motion()
    rounded = STEP * np.round(q / STEP)
    found = measure(recording(time, q))
    assert found.fitted
    filtered = np.gradient(np.gradient(low_pass(rounded, 6.0, 100.0), 0.01, axis=0), 0.01, axis=0)
    inside = slice(30, -30)
    assert np.all(rms((found.acceleration - a)[inside]) < 0.2 * rms((filtered - a)[inside]))


def test_noise_of_derivatives_is_foretold():
    rng = np.random.default_rng(3)
    time, q, v, a = motion()
    found = smooth([(time, q + 1e-5 * rng.standard_normal(q.shape))], 100.0)
    np.testing.assert_allclose(found.noise, 1e-5, rtol=0.1)
    inside = slice(150, -150)
    for order, (got, true) in enumerate(((found.first, v), (found.second, a)), start=1):
        assert np.all(rms((got - true)[inside]) < 2.0 * found.derivative_noise(order, 100.0))


def test_spacing_follows_the_motion():
    time = np.arange(0, 15, 0.01)
    noise = 1e-5 * np.random.default_rng(0).standard_normal((len(time), 2))
    found = smooth([(time, np.stack([np.sin(2 * time), 0.05 * np.sin(30 * time)], axis=1) + noise)], 100.0)
    assert found.cutoff[0] < 2.0 < 30 / 2 / np.pi < found.cutoff[1] < 20


@pytest.mark.parametrize("shift", [0.0, 0.02])
def test_a_velocity_that_disagrees_with_the_positions_is_kept(shift):
    time, q, v, _ = motion()
    given = v + shift + 1e-4 * np.random.default_rng(1).standard_normal(v.shape)
    found = measure(recording(time, q, given))
    assert np.abs(np.mean(found.velocity - v) - shift) < 1e-4
    assert np.all(rms(found.velocity - v - shift) < 1e-4)


@pytest.mark.parametrize("noise", [2e-2, 2e-5])
def test_derivatives_come_from_the_signal_that_follows_the_motion(noise):
    """In its own band a velocity that is nearly all noise has the least: its fit follows hardly anything."""
    time, q, v, a = motion(rate=200.0)
    shake = 2 * np.pi * 9.0
    wave, slope = (2e-4 * f(shake * time)[:, None] for f in (np.sin, np.cos))
    q, v, a = q + wave, v + shake * slope, a - shake**2 * wave
    given = v + noise * np.random.default_rng(2).standard_normal(v.shape)
    alone, both = measure(recording(time, q)), measure(recording(time, q, given))
    assert alone.fitted
    assert both.fitted
    inside = slice(60, -60)
    errors = [rms((found.acceleration - a)[inside]) for found in (alone, both)]
    frequency = np.linspace(1.0, 8.0, 8)
    expected = [found.noise.acceleration(frequency) for found in (alone, both)]
    if noise > 1e-3:
        np.testing.assert_allclose(errors[1], errors[0])
        np.testing.assert_allclose(both.cutoff, alone.cutoff)
        np.testing.assert_allclose(expected[1], expected[0])
    else:
        assert np.all(errors[1] < 0.5 * errors[0])


def test_given_accelerations_are_kept_and_ends_left_out():
    time, q, v, a = motion()
    found = measure(recording(time, q, v, a))
    np.testing.assert_array_equal(found.acceleration, a)
    assert np.isnan(found.cutoff).all()
    derived = measure(recording(time, q))
    edge = int(END * 0.5 / derived.cutoff.max() * 100)
    assert edge >= 1
    assert not derived.usable[:edge].any()
    assert not derived.usable[-edge:].any()


def test_ends_are_left_out_on_all_joints_by_the_widest_knots_up_to_a_longest_time():
    time, q, _, _ = motion(rate=200.0)
    for waves in (0.0, 4e-3):
        shaken = q + waves * np.sin(2 * np.pi * 12.0 * time)[:, None] * np.array([1.0, 0.05])
        found = measure(recording(time, shaken))
        assert found.fitted
        spacing = 0.5 / found.cutoff
        clear = int(200.0 * min(CLEAR_OF_END * spacing.max(), LONGEST_END))
        for joint in (0, 1):
            edge = max(clear, int(200.0 * END * spacing[joint]))
            assert not found.usable[:edge, joint].any()
            assert not found.usable[-edge:, joint].any()
            assert found.usable[edge : edge + 8, joint].any()


def test_missing_samples_and_unresolved_motion_go_to_the_filter():
    time, q, _, _ = motion()
    holed = q.copy()
    holed[400:420, 0] = np.nan
    assert not measure(recording(time, holed)).fitted
    rough = q + 0.002 * np.sign(np.sin(90 * time))[:, None]
    assert not measure(recording(time, rough)).fitted


def test_a_joint_at_rest_is_no_trouble():
    time, q, _, _ = motion()
    q[:, 1] = 0.3
    found = measure(recording(time, q))
    assert np.isfinite(found.acceleration).all()
    assert np.abs(found.acceleration[:, 1]).max() < 1e-6
    assert not found.usable[:, 1].any()


def test_records_that_are_sampled_alike_are_fitted_as_each_would_be():
    time, q, _, _ = motion(seconds=6.0)
    other = q[:, ::-1] + 1e-5 * np.random.default_rng(2).standard_normal(q.shape)
    later = np.append(time, time[-1] + 0.01)
    pieces = [(time, q), (time + 40.0, other), (later, np.append(q, q[-1:], axis=0))]
    found = smooth(pieces, 100.0)
    jittered = smooth([(t + 1e-10 * k * np.arange(len(t)), y) for k, (t, y) in enumerate(pieces)], 100.0)
    np.testing.assert_array_equal(found.spacing, jittered.spacing)
    np.testing.assert_allclose(found.second, jittered.second, atol=1e-6)
    np.testing.assert_allclose(found.noise, jittered.noise, rtol=1e-6)
