"""Noise of derived accelerations, its filter, and a step that is given."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import COARSE_RATE as RATE
from discovery_cases import coarse

from jointwear.measurement.derived.derived_noise import quantisation_density
from jointwear.measurement.derived.filtering import low_pass, zero_phase_gain
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot("config/robots/puma560.yaml")


def test_rounding_has_its_density():
    rng = np.random.default_rng(2)
    values = rng.uniform(0, 1, 200_000)
    error = values - 0.01 * np.round(values / 0.01)
    assert np.var(error) == pytest.approx(quantisation_density(0.01, 500.0) * 250.0, rel=0.02)


def test_gain_is_that_of_the_filter():
    time = np.arange(4000) / RATE
    for cutoff in (0.1 * RATE, 0.3 * RATE):
        for share in (0.25, 0.9, 1.1, 1.3):
            passed = low_pass(np.sin(2 * np.pi * share * cutoff * time), cutoff, RATE)[1000:3000]
            gain = zero_phase_gain(share * cutoff, cutoff, RATE)
            assert np.sqrt(2 * np.mean(passed**2)) == pytest.approx(gain, abs=0.01)


def test_noise_of_accelerations_is_predicted(robot):
    recording = coarse(robot)
    exact = measure(coarse(robot, step=1e-12))
    # A hole: a filter takes the place of splines, whose own error would be larger on so smooth a motion.
    recording.position[700:703, 5] = np.nan
    measured = measure(recording)
    assert not measured.fitted
    frequency = np.linspace(0, RATE / 2, 1025)[1:]
    predicted = np.sqrt(measured.noise.acceleration(frequency).sum(axis=1) * frequency[0])
    used = measured.usable & exact.usable
    for axis in range(4):
        error = (measured.acceleration - exact.acceleration)[used[:, axis], axis]
        assert np.sqrt(np.mean(error**2)) == pytest.approx(predicted[axis], rel=0.25)


def test_a_given_step_counts_where_the_positions_were_smoothed(robot):
    recording = split(coarse(robot, step=1e-9))
    told = replace(recording, encoder_step=1e-4)
    assert np.all(measure(told).noise.density > 100 * measure(recording).noise.density)
