"""The noise of derived accelerations: that of the signal they come from, times the square of the frequency.

Differentiation multiplies the density of the noise of a position by (2 pi f)^4, so that an encoder of 17 bits, exact
to 0.05 mrad, gives accelerations that are wrong by several rad/s2 at 50 Hz. Through the mass matrix that is a torque.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.measurement.derived.filtering import zero_phase_gain


@dataclass(frozen=True)
class DerivedNoise:
    """Noise of the accelerations of a recording.

    A velocity that was recorded beside the positions may have been derived from them before: its own floor, above the
    band of the filter that made it, then says too little, and counts as nothing. The noise is the larger one of what
    either signal gives.

    Attributes
    ----------
    density : (s, n) of the noise of the signals that may have been derived [unit^2/Hz, one-sided].
    order : (s,) how often each is derived: 2 for a position, 1 for a velocity, 0 for a measured acceleration.
    band : (n,) frequency [Hz] at which the filter or the splines behind the derivatives stop; infinite for none.
    sharp : whether the band ends sharply, as that of splines does, or as that of the zero-phase filter.
    rate : of the recording [Hz] that the filter worked on.
    fused : (n,) joints whose velocities are made of both signals, each where it is the better one; None: no joint.
    """

    density: np.ndarray
    order: tuple[int, ...]
    band: np.ndarray
    sharp: bool
    rate: float
    fused: np.ndarray | None = None

    def acceleration(self, frequency: np.ndarray) -> np.ndarray:
        """Return the density (n, k) [(rad/s2)^2/Hz] of the noise of the accelerations at frequencies (k,) [Hz]."""
        gains = (2 * np.pi * frequency) ** (2 * np.array(self.order)[:, None])
        passed = np.stack([self.passed(axis, frequency) for axis in range(len(self.band))])
        each = self.density[:, :, None] * gains[:, None, :]
        noise = np.max(each, axis=0)
        if self.fused is not None and self.fused.any():
            # Where a velocity may have been made of the positions its density is 0, and it adds nothing to them.
            known = np.where(each > 0, 1 / np.maximum(each, 1e-300), 0.0).sum(axis=0)
            noise = np.where(self.fused[:, None] & (known > 0), 1 / np.maximum(known, 1e-300), noise)
        return noise * passed**2

    def passed(self, axis: int, frequency: np.ndarray) -> np.ndarray:
        """Return the share (...,) that is left of the acceleration of an axis (0-based) at frequencies (...,) [Hz]."""
        if self.sharp:
            return np.where(frequency <= self.band[axis], 1.0, 0.0)
        return zero_phase_gain(frequency, self.band[axis], self.rate)


def quantisation_density(step: float, rate: float) -> float:
    """Return the density [unit^2/Hz] of rounding to multiples of `step`: variance step^2/12 over the band rate/2."""
    return step**2 / 12 / (rate / 2)
