"""The noise of a signal and where the signal ends, from its spectrum.

The noise floor is the median of the upper third of the band. The highest frequency at which the smoothed spectrum
stands ten times above the floor is the end of the signal. A joint at rest that its controller shakes by one step of
the encoder, from sample to sample, is no motion: :func:`resting` takes it out.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from jointwear.measurement.derived.filtering import SAFELY
from jointwear.statistics.runs import runs

#: Samples of a piece of which the spectrum is taken, pieces half of which overlap, and of the shortest.
PIECE, SHORTEST_PIECE = 256, 64
#: Samples in a row within one step of the encoder of which a joint that rests is told.
RESTING = 24


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


def resting(position: np.ndarray, pieces: list[slice]) -> np.ndarray:
    """Return positions (m, n) with a joint that stays within one step of its encoder at one place.

    A wave of one step from sample to sample stands in the spectrum up to the end of the band. The step is the smallest
    one that a joint makes; noise that is finer than what is logged has none, and stays.
    """
    still = position.copy()
    for j, x in enumerate(position.T):
        moved = np.abs(np.concatenate([np.diff(x[p]) for p in pieces] or [np.zeros(0)]))
        moved = moved[moved > 0]
        if not len(moved):
            continue
        # Half a step more: what is logged is rounded.
        within = 1.5 * moved.min()
        for p in pieces:
            if p.stop - p.start < RESTING:
                continue
            within_one = np.ptp(sliding_window_view(x[p], RESTING), axis=1) <= within
            at_rest = np.convolve(within_one.astype(int), np.ones(RESTING, int)) > 0
            for rest in runs(at_rest):
                if at_rest[rest.start]:
                    still[p, j][rest] = np.mean(x[p][rest])
    return still
