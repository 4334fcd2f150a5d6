"""Expected maximum and coefficient of variation of |torque| over noisy samples, with derivatives.

An hour holds the same k instants r times over. Each sample is the instant's level plus Gaussian noise of one
standard deviation, so the largest of the k r samples lies above the largest level: by 1.5 standard
deviations for one dominating instant with ten repeats, by 2 or more if several instants come close.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import erf, ndtr

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_LOW, _HIGH = -1.0, 4.5  # of the integral, in standard deviations from the largest level
_ROOT_2_PI = np.sqrt(2 * np.pi)


@dataclass(frozen=True)
class Expected:
    """A statistic (...,), its derivative `by_level` (..., k) and `by_noise` (...,)."""

    value: np.ndarray
    by_level: np.ndarray
    by_noise: np.ndarray


def expected_maximum(level: np.ndarray, noise: np.ndarray, repeats: int, slopes: bool = True) -> Expected:
    """Return the expected largest of the noisy samples.

    Parameters
    ----------
    level : (..., k) |torque| without noise [N m]; instants near zero never decide the maximum, so that the
        sign change by noise is of no account.
    noise : (...,) standard deviation [N m], > 0.
    repeats : samples of every instant.
    slopes : False to leave the derivatives out (zeros), which takes half the time.

    Notes
    -----
    E = b - integral of F from a to b, with F the distribution of the maximum, F(a) = 0 and F(b) = 1, by
    Gauss-Legendre quadrature with 16 nodes.
    """
    top = level.max(axis=-1)
    half, middle = (_HIGH - _LOW) / 2, (_HIGH + _LOW) / 2
    x = middle + half * _NODES
    z = ((top[..., None] - level) / noise[..., None])[..., None] + x  # (..., k, nodes)
    below = np.maximum(ndtr(z), 1e-30)
    distribution = np.prod(below, axis=-2) ** repeats
    weight = half * _WEIGHTS
    value = top + noise * (_HIGH - distribution @ weight)
    if not slopes:
        return Expected(value, np.zeros_like(level), np.zeros_like(noise))
    hazard = repeats * np.exp(-0.5 * z**2) / (_ROOT_2_PI * below)
    by_level = (hazard * (distribution * weight)[..., None, :]).sum(axis=-1)
    by_level /= by_level.sum(axis=-1, keepdims=True)
    # The maximum is homogeneous of degree one in levels and noise.
    by_noise = (value - (by_level * level).sum(axis=-1)) / noise
    return Expected(value, by_level, by_noise)


def coefficient_of_variation(level: np.ndarray, noise: np.ndarray, repeats: int, ddof: int) -> Expected:
    """Return standard deviation over mean of the noisy |samples|.

    Parameters
    ----------
    level, noise, repeats : as expected_maximum; here the sign change by noise near zero counts (folded normal).
    ddof : 1 for the standard deviation with k r - 1 in the denominator, 0 with k r.
    """
    count = level.shape[-1] * repeats
    unit = level / noise[..., None]
    bell = np.sqrt(2 / np.pi) * np.exp(-0.5 * unit**2)
    folded_by_level = erf(unit / np.sqrt(2))
    mean = (noise[..., None] * bell + level * folded_by_level).mean(axis=-1)
    square = (level**2).mean(axis=-1) + noise**2
    correction = count / (count - 1) if ddof else 1.0
    variance = np.maximum(square - mean**2, 1e-12 * square) * correction
    value = np.sqrt(variance) / mean
    # value^2 = correction (square / mean^2 - 1)
    by_square = correction / (2 * value * mean**2)
    by_mean = -correction * square / (value * mean**3)
    k = level.shape[-1]
    by_level = by_square[..., None] * 2 * level / k + by_mean[..., None] * folded_by_level / k
    by_noise = by_square * 2 * noise + by_mean * bell.mean(axis=-1)
    return Expected(value, by_level, by_noise)
