"""Noise that moves the arm is told from a sensor's."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from jointwear.discovery.shaken import PIECE, frequencies, shaken_shares

RATE, N, JOINTS = 200.0, 8000, 3


def _arm(seed):
    """Torques of a motion that ends at 3 Hz, (N, JOINTS), and white noise."""
    rng = np.random.default_rng(np.random.SeedSequence([5, seed]))
    motion = sosfiltfilt(butter(4, 3.0, fs=RATE, output="sos"), rng.standard_normal((N, JOINTS)), axis=0)
    return 20.0 * motion, 0.1 * rng.standard_normal((N, JOINTS))


def _shares(residual, torque):
    derived = np.zeros((JOINTS, len(frequencies(RATE))))
    usable = np.ones((N, JOINTS), dtype=bool)
    return shaken_shares(residual, torque, usable, np.repeat([0, 1], N // 2), RATE, derived)


def test_noise_of_a_sensor_moves_nothing():
    motion, noise = _arm(0)
    assert _shares(noise, motion).max() < 0.1


def test_what_disturbs_a_commanded_drive_moves_the_arm():
    motion, noise = _arm(1)
    assert _shares(-noise, motion + noise).min() > 0.9


def test_half_of_either():
    motion, noise = _arm(2)
    _, other = _arm(3)
    assert np.all(np.abs(_shares(other - noise, motion + noise) - 0.5) < 0.1)


def test_a_late_torque_is_no_shaken_arm():
    motion, noise = _arm(4)
    late = np.roll(motion, 2, axis=0) - motion + noise
    assert _shares(late, motion).max() < 0.2


def test_no_axis_is_more_shaken_than_the_next():
    motion, noise = _arm(6)
    alone = noise.copy()
    alone[:, 0] *= -1.0
    moved = motion.copy()
    moved[:, 0] += noise[:, 0]
    assert _shares(alone, moved).max() < 0.1


def test_short_stretches_say_nothing():
    motion, noise = _arm(7)
    usable = np.ones((N, JOINTS), dtype=bool)
    usable[:: PIECE // 2] = False
    derived = np.zeros((JOINTS, len(frequencies(RATE))))
    shares = shaken_shares(-noise, motion + noise, usable, np.zeros(N, dtype=int), RATE, derived)
    assert shares.max() == 0.0
