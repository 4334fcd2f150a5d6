"""The noise of a signal and where the signal ends, from its spectrum.

The noise floor is the median of the upper third of the band. The highest frequency at which the smoothed spectrum
stands ten times above the floor is the end of the signal.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from jointwear.measurement.filtering import SAFELY

#: Samples of a piece of which the spectrum is taken, pieces half of which overlap, and of the shortest.
PIECE, SHORTEST_PIECE = 256, 64


def spectral_floor(signals: list[np.ndarray], rate: float) -> tuple[float, float]:
    """Return noise density [unit^2/Hz] of signals (k,) and the frequency [Hz] where the signal ends.

    The spectrum is taken of the second difference and divided by its gain: the range of a position spectrum is so
    wide that the side lobes of any window would hide the floor.
    """
    frequencies = np.fft.rfftfreq(PIECE, 1 / rate)[1:]
    power, weight = np.zeros(len(frequencies)), 0
    for x in signals:
        second = np.diff(x, 2)
        if len(second) < SHORTEST_PIECE:
            continue
        size = min(len(second), PIECE)
        pieces, window = sliding_window_view(second, size)[:: PIECE // 2], np.hanning(size)
        spectra = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * window, PIECE)[:, 1:]
        power += np.sum(np.abs(spectra) ** 2, axis=0) * 2 / (rate * np.sum(window**2))
        weight += len(pieces)
    if not weight:
        return 0.0, SAFELY * rate
    power /= weight * (2 * np.sin(np.pi * frequencies / rate)) ** 4
    floor = float(np.median(power[2 * len(power) // 3 :]))
    smooth = np.exp(np.convolve(np.log(np.pad(power, 1, mode="edge") + 1e-300), np.ones(3) / 3, mode="valid"))
    above = np.flatnonzero(smooth > 10 * floor)
    end = frequencies[above[-1]] if len(above) else frequencies[0]
    return floor, float(max(end, frequencies[1]))
