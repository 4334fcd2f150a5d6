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


#: Highest frequency [Hz] of the motion of an arm: a filter above it costs nothing.
MOTION_BAND = 10.0


def felt_noise(torque: np.ndarray, step: np.ndarray, inertia: np.ndarray, rate: float) -> np.ndarray:
    """Return the standard deviation (n,) [N m] of white noise that is worth torque noise and encoder steps together.

    Parameters
    ----------
    torque : (n,) of the torque channel [N m]. step : (n,) of the encoders [rad]. inertia : (n,) [kg m2].
    rate : of the log [Hz].
    """
    # Rounding has the variance step^2 / 12 spread up to half the rate; twice differentiated it is multiplied by
    # (2 pi f)^4, whose mean over the band is (2 pi)^4 band^4 / 5.
    band = min(MOTION_BAND, rate / 4)
    acceleration = step**2 / 12 * (2 * np.pi * band) ** 4 / 5
    return np.sqrt(torque**2 + inertia**2 * acceleration)


def quantise(values: np.ndarray, step: np.ndarray | float) -> np.ndarray:
    """Round to whole steps."""
    return np.round(values / step) * step
