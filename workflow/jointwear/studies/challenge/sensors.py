"""What the recorder makes of the truth: torque noise, encoder steps, rounded temperatures."""

from __future__ import annotations

import numpy as np


def torque_noise(
    rng: np.random.Generator, deviation: np.ndarray, colour: float, recordings: int, samples: int
) -> np.ndarray:
    """Return stationary noise (recordings x samples, n) [N m], white or autoregressive, new in each recording.

    Parameters
    ----------
    deviation : (n,) standard deviation of every joint's noise [N m]. colour : coefficient of the autoregression.
    """
    noise = rng.normal(size=(recordings, samples, len(deviation)))
    if colour:
        noise[:, 1:] *= np.sqrt(1 - colour**2)
        for k in range(1, samples):
            noise[:, k] += colour * noise[:, k - 1]
    return noise.reshape(-1, len(deviation)) * deviation


def encoder_steps(rng: np.random.Generator, gear: np.ndarray) -> np.ndarray:
    """Return the step (n,) [rad] seen at the joint: 2^12 to 2^16 a motor turn, 2^19 a turn without a gear."""
    counts = 2.0 ** rng.integers(12, 17, len(gear))
    return 2 * np.pi / np.where(np.abs(gear) > 4, counts * np.abs(gear), 2.0**19)


def quantise(values: np.ndarray, step: np.ndarray | float) -> np.ndarray:
    """Round to whole steps."""
    return np.round(values / step) * step
