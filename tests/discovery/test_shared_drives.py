"""Samples in which a drive that two joints share sticks."""

import numpy as np
from discovery_cases import COARSE_RATE as RATE

from jointwear.discovery import assumed
from jointwear.discovery.settings import Settings
from jointwear.discovery.shared_drives import sticking

SIGMAS = Settings().noise_sigmas


def test_samples_of_a_shared_drive_that_sticks_are_left_out():
    rng = np.random.default_rng(3)
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(w * time + k) for k, w in enumerate((2.0, 3.1, 4.3))], axis=1)
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    usable, inertial = np.abs(velocity) > 0.02, rng.standard_normal((4000, 3, 2))
    speed = velocity[:, 1] + velocity[:, 2]
    slow = np.abs(speed) < assumed.STICKS
    # A shared drive on joints 2 and 3, of any friction where it sticks.
    level = np.where(slow, rng.uniform(-1, 1, 4000), np.sign(speed))
    missing = 0.02 * rng.standard_normal((4000, 3)) + 0.8 * level[:, None] * np.array([0, 1, 1])
    stuck = sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)
    assert not stuck[:, 0].any()
    np.testing.assert_array_equal(stuck[:, 1:], np.stack([slow, slow], axis=1))
    missing[:, 1] = 0.02 * rng.standard_normal(4000)
    assert not sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)[:, 1].any()


def test_a_shared_drive_that_sticks_for_a_third_of_the_time_is_no_program():
    """Friction of a shared drive holds two joints together for whole stretches; a program that does leaves no trace."""
    rng = np.random.default_rng(4)
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(2.0 * time), np.cos(3.1 * time)], axis=1)
    held = np.cos(0.7 * time) > 0.4
    velocity[held, 1] = -velocity[held, 0]
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    usable, inertial = np.ones((4000, 2), dtype=bool), rng.standard_normal((4000, 2, 2))
    speed = velocity.sum(axis=1)
    slow = np.abs(speed) < assumed.STICKS
    assert 0.3 < slow.mean() < 0.5
    noise = 0.02 * rng.standard_normal((4000, 2))
    friction = 0.8 * np.where(slow, rng.uniform(-1, 1, 4000), np.sign(speed))
    stuck = sticking(usable, velocity, acceleration, noise + friction[:, None], inertial, SIGMAS)
    np.testing.assert_array_equal(stuck, np.stack([slow, slow], axis=1))
    assert not sticking(usable, velocity, acceleration, noise, inertial, SIGMAS).any()


def test_samples_beside_reversals_of_a_dragging_neighbour_are_left_out():
    """A filter rounds the jump of a neighbour's friction on a joint that moves on."""
    rng = np.random.default_rng(5)
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(2.0 * time), np.cos(3.1 * time)], axis=1)
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    usable, inertial = np.ones((4000, 2), dtype=bool), rng.standard_normal((4000, 2, 2))
    slow = np.abs(velocity[:, 1]) < assumed.STICKS
    level = np.where(slow, rng.uniform(-1, 1, 4000), np.sign(velocity[:, 1]))
    missing = 0.02 * rng.standard_normal((4000, 2)) + 0.8 * level[:, None] * np.array([1, 0])
    stuck = sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)
    np.testing.assert_array_equal(stuck, np.stack([slow, np.zeros(4000, dtype=bool)], axis=1))
