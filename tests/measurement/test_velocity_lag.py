"""Velocities that a controller has filtered are put back to the instants of their positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from jointwear.discovery.problem.restrictions import late_velocities
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import Recording

RATE, FINE = 125.0, 1000
STEP = 2 * np.pi / 2**17


def _motion(shift: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return fine time, positions and velocities (m, 2) of two joints, `shift` [s] later."""
    time = np.arange(0, 30, 1 / FINE)
    waves = [(0.8, 0.10, 0.0), (0.3, 0.37, 1.0), (0.1, 0.9, 2.0)]
    at = (time - shift)[:, None] + np.array([0.0, 3.0])
    position = sum(a * np.sin(2 * np.pi * f * at + p) for a, f, p in waves)
    velocity = sum(2 * np.pi * f * a * np.cos(2 * np.pi * f * at + p) for a, f, p in waves)
    return time, position, velocity


def _measured(velocity: np.ndarray):
    time, position, _ = _motion()
    position = STEP * np.round(position[::8] / STEP)
    label = np.repeat([0, 1], [len(position) // 2, len(position) - len(position) // 2])
    return measure(Recording(time[::8], label, position, np.zeros_like(position), velocity[::8]))


def test_a_filter_of_the_controller_is_seen_and_its_lag_taken_out():
    _, _, velocity = _motion()
    share = 1 - np.exp(-2 * np.pi * 70 / FINE)
    late = lfilter([share], [1, share - 1], velocity, axis=0)
    lag = (1 - share) / share / FINE
    found = _measured(late)
    np.testing.assert_allclose(found.velocity_lag, lag, rtol=0.02)
    middle = found.usable
    true = velocity[::8]
    assert np.std((found.velocity - true)[middle]) < 0.25 * np.std((late[::8] - true)[middle])


@pytest.mark.parametrize("shift", [-0.006, 0.003])
def test_a_velocity_of_another_instant_is_moved_either_way(shift):
    found = _measured(_motion(shift)[2])
    np.testing.assert_allclose(found.velocity_lag, shift, rtol=0.02)


def test_a_velocity_of_its_own_instant_stays():
    _, _, velocity = _motion()
    noisy = velocity + 1e-3 * np.random.default_rng(1).standard_normal(velocity.shape)
    for same in (velocity, noisy):
        assert not np.any(_measured(same).velocity_lag)


@pytest.mark.parametrize(("rate", "used"), [(125.0, True), (1000.0, False)])
def test_a_lag_of_many_samples_leaves_the_positions_alone(rate, used):
    """A filter of 12 ms: at 1 kHz positions are dense against it, and tell more than a velocity that is moved back."""
    time, position, velocity = _motion()
    share = 1 - np.exp(-1 / (0.012 * FINE))
    late = lfilter([share], [1, share - 1], velocity, axis=0)
    every = round(FINE / rate)
    position, late = STEP * np.round(position[::every] / STEP), late[::every]
    label = np.repeat([0, 1], [len(position) // 2, len(position) - len(position) // 2])
    without = Recording(time[::every], label, position, np.zeros_like(position))
    found, derived = measure(replace(without, velocity=late)), measure(without)
    np.testing.assert_allclose(found.velocity_lag, 0.0115, rtol=0.05)
    assert found.velocity_used is used
    (told,) = late_velocities(found)
    assert told.endswith("put right" if used else "no given velocity is used")
    assert np.array_equal(found.acceleration, derived.acceleration) is not used


def test_another_clock_is_left_alone():
    # A lag of many samples is not that of a filter: moving it would hide a recorder that mixed two sources.
    assert not np.any(_measured(_motion(0.2)[2]).velocity_lag)


def test_what_a_filter_took_off_fast_motion_is_given_back():
    """A wave of 9 Hz, of which a filter of first order at 25 Hz leaves 0.94."""
    wave = 2 * np.pi * 9.0
    time, position, velocity = _motion()
    swing = 2e-3 * np.sin(wave * time)[:, None]
    position, velocity = (position + swing)[::8], velocity + 2e-3 * wave * np.cos(wave * time)[:, None]
    share = 1 - np.exp(-2 * np.pi * 25 / FINE)
    late = lfilter([share], [1, share - 1], velocity, axis=0)[::8]
    label = np.repeat([0, 1], [len(position) // 2, len(position) - len(position) // 2])
    found = measure(Recording(time[::8], label, STEP * np.round(position / STEP), np.zeros_like(position), late))
    shape = np.cos(wave * time[::8])

    def size(values):
        return [x[m] @ shape[m] / (shape[m] @ shape[m]) for x, m in zip(values.T, found.usable.T, strict=True)]

    np.testing.assert_allclose(size(found.velocity), size(velocity[::8]), rtol=0.02)
