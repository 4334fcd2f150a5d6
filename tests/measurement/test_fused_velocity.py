"""Velocities made of positions and recorded velocities: better than either, and left alone where both disagree."""

import numpy as np
import pytest

from jointwear.measurement.derived.filtering import derivatives, low_pass
from jointwear.measurement.derived.fused_velocity import fuse, made_of_positions

RATE = 200.0


def log(seed=0, step=2 * np.pi / 2**18, noise=5e-4):
    """Two joints for two records of 10 s: time, pieces, exact speed, positions of an encoder, noisy velocities."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, 10.0, 1 / RATE)
    turn = 2 * np.pi * np.array([0.3, 0.8, 3.1])[:, None] * rng.uniform(0.9, 1.1, (2, 1, 2))
    phase = rng.uniform(0, 6, (2, 3, 2))
    size = np.array([0.6, 0.3, 0.01])[:, None]
    parts = [(turn[k] * time[:, None, None] + phase[k]) for k in range(2)]
    position = np.concatenate([np.sum(size * np.sin(a), axis=1) for a in parts])
    speed = np.concatenate([np.sum(size * turn[k] * np.cos(a), axis=1) for k, a in enumerate(parts)])
    pieces = [slice(0, len(time)), slice(len(time), 2 * len(time))]
    return np.tile(time, 2), pieces, speed, step * np.round(position / step), speed + rng.normal(0, noise, speed.shape)


def floors(step=2 * np.pi / 2**18, noise=5e-4):
    return np.array([[step**2 / 12], [noise**2]]) / (0.5 * RATE) * np.ones(2)


def rms(values):
    return float(np.sqrt(np.mean(values[200:-200] ** 2)))


def test_both_signals_know_more_than_either():
    time, pieces, speed, position, velocity = log()
    made, fused = fuse(time, pieces, position, velocity, floors(), RATE)
    assert fused.all()
    for j in range(2):
        by_position = np.concatenate([derivatives(time[p], position[p, j])[0] for p in pieces])
        errors = [rms(x[:, j] - speed[:, j]) for x in (made, velocity)]
        assert errors[0] < 0.95 * errors[1]
        assert errors[0] < 0.8 * rms(by_position - speed[:, j])


def test_accelerations_gain_most():
    time, pieces, speed, position, velocity = log()
    made, _ = fuse(time, pieces, position, velocity, floors(), RATE)
    p = pieces[0]
    exact, before, after = (derivatives(time[p], low_pass(x[p, 0], 8.0, RATE))[0] for x in (speed, velocity, made))
    assert rms(after - exact) < 0.65 * rms(before - exact)


def test_a_velocity_from_elsewhere_stays():
    time, pieces, _, position, velocity = log()
    velocity[:, 1] += 0.02 * np.sin(2 * np.pi * 1.3 * time)
    made, fused = fuse(time, pieces, position, velocity, floors(), RATE)
    assert fused.tolist() == [True, False]
    assert np.array_equal(made[:, 1], velocity[:, 1])


def test_a_good_velocity_beside_a_coarse_encoder_stays():
    step, noise = 2 * np.pi / 2**10, 1e-6
    time, pieces, _, position, velocity = log(step=step, noise=noise)
    made, fused = fuse(time, pieces, position, velocity, floors(step, noise), RATE)
    assert not fused.any()
    assert np.array_equal(made, velocity)


def test_records_too_short_to_filter_stay():
    time, _, _, position, velocity = log()
    made, fused = fuse(time[:10], [slice(0, 10)], position[:10], velocity[:10], floors(), RATE)
    assert not fused.any()
    assert made == pytest.approx(velocity[:10])


@pytest.mark.parametrize("band", [None, 30.0, 80.0])
def test_a_velocity_that_was_made_of_the_positions_is_told_from_one_of_its_own(band):
    step = 2 * np.pi / 2**15
    time, pieces, _, position, velocity = log(step=step)
    if band is not None:
        derived = [derivatives(time[p], low_pass(position[p], band, RATE))[0] for p in pieces]
        velocity = np.concatenate(derived) + np.random.default_rng(1).normal(0, 5e-5, velocity.shape)
    noise = 5e-4 if band is None else 5e-5
    made = made_of_positions(time, pieces, position, velocity, floors(step, noise), RATE)
    assert made.tolist() == [band is not None] * 2
