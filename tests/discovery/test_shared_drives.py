"""Samples in which a drive that two joints share sticks."""

import numpy as np
from discovery_cases import COARSE_RATE as RATE

from jointwear.discovery import assumed
from jointwear.discovery.shared_drives import sticking


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
    stuck = sticking(usable, velocity, acceleration, missing, inertial)
    assert not stuck[:, 0].any()
    np.testing.assert_array_equal(stuck[:, 1:], np.stack([slow, slow], axis=1))
    missing[:, 1] = 0.02 * rng.standard_normal(4000)
    assert not sticking(usable, velocity, acceleration, missing, inertial)[:, 1].any()
