"""Low-pass filter with zero phase: forward and backward, states of a steady signal at either end."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

#: Fewest samples that are filtered.
SHORTEST = 24


@lru_cache(maxsize=512)
def _butterworth(cutoff: float, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Sections of a Butterworth filter of order 4, and their states for a constant signal of 1."""
    sections = butter(4, cutoff, fs=rate, output="sos")
    return sections, sosfilt_zi(sections)


def low_pass(values: np.ndarray, cutoff: float, rate: float) -> np.ndarray:
    """Filter (k, ...) with zero phase along the first axis; nothing happens where the cut-off is near Nyquist.

    The same as scipy's sosfiltfilt with odd extension, but the states are worked out once for a filter and not at every
    call, which for short stretches costs more than the filter.
    """
    if cutoff >= 0.45 * rate or len(values) < SHORTEST:
        return values
    pad = min(len(values) - 1, int(3 * rate / cutoff))
    # Rates that were found from stamps differ in their last digits from stretch to stretch.
    sections, steady = _butterworth(float(f"{cutoff:.9g}"), float(f"{rate:.9g}"))
    flat = values.reshape(len(values), -1).T
    first, last = flat[:, :1], flat[:, -1:]
    x = np.concatenate([2 * first - flat[:, pad:0:-1], flat, 2 * last - flat[:, -2 : -pad - 2 : -1]], axis=1)
    for _ in range(2):
        state = steady[:, None, :] * x[None, :, :1]
        x = sosfilt(sections, x, axis=1, zi=state)[0][:, ::-1]
    return x[:, pad : x.shape[1] - pad].T.reshape(values.shape)
