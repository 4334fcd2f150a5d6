"""Low-pass filter with zero phase, forward and backward, and derivatives of what it leaves."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfilt, sosfilt_zi

#: Fewest samples that are filtered.
SHORTEST = 24
#: Share of the rate from which on nothing is left to filter.
HIGHEST = 0.45
#: Fewest samples that a signal is continued by beyond its ends. A filter with its cut-off near Nyquist rings for so
#: long, however short its period: continued by less, a joint that moves at an end of its record gets an acceleration
#: there that is wrong by ten times itself.
RINGING = 30


@lru_cache(maxsize=512)
def _butterworth(cutoff: float, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Sections (2, 6) of a Butterworth filter of order 4, and their states (2, 2) after a long row of ones."""
    sections = butter(4, cutoff, fs=rate, output="sos")
    return sections, sosfilt_zi(sections)


def low_pass(values: np.ndarray, cutoff: float, rate: float) -> np.ndarray:
    """Filter (k, ...) with zero phase along the first axis; nothing happens where the cut-off is near Nyquist."""
    if cutoff >= HIGHEST * rate or len(values) < SHORTEST:
        return values
    # Rates that were found from stamps differ in their last digits from stretch to stretch.
    pad = min(len(values) - 1, max(int(3 * rate / cutoff + 1e-6), RINGING))
    # As scipy.signal.sosfiltfilt does, which works out the settled states anew at every call: a third of its time.
    sections, settled = _butterworth(float(f"{cutoff:.9g}"), float(f"{rate:.9g}"))
    settled = settled.reshape(2, 2, *[1] * (values.ndim - 1))
    along = [(pad, pad), *[(0, 0)] * (values.ndim - 1)]
    longer = np.pad(values, along, mode="reflect", reflect_type="odd")
    forward, _ = sosfilt(sections, longer, axis=0, zi=settled * longer[0])
    backward, _ = sosfilt(sections, forward[::-1], axis=0, zi=settled * forward[-1])
    return backward[::-1][pad : len(values) + pad]


def zero_phase_gain(frequency: np.ndarray, cutoff: float, rate: float) -> np.ndarray:
    """Return the gain (...,) of :func:`low_pass` at frequencies (...,) [Hz]; 0 from half the rate on.

    The bilinear transform bends frequencies, so that the digital filter ends more sharply than the analogue one.
    """
    if cutoff >= HIGHEST * rate:
        return np.ones(np.shape(frequency))
    bent = np.tan(np.pi * np.minimum(frequency / rate, 0.5)) / np.tan(np.pi * cutoff / rate)
    return 1.0 / (1.0 + ((bent**2) ** 2) ** 2)


def derivatives(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and second derivative of values (k, ...) at their times (k,), by a spline through them."""
    spline = make_interp_spline(time, values, k=5 if len(time) > 6 else 1)
    return spline(time, 1), spline(time, 2)
