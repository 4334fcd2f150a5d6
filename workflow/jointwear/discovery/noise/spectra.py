"""Spectra of the torques of one axis over pieces of recordings that can be judged throughout."""

from __future__ import annotations

import numpy as np

#: Longest and shortest piece, in samples, of which spectra are taken, and its length [s] between: runs of samples that
#: can be judged end at reversals, and at a low rate are short. Pieces overlap by half.
LONGEST, SHORTEST, SPAN = 128, 16, 0.64
#: Pieces from which spectra say something.
FEWEST_PIECES = 8
#: Neighbouring frequencies that a line has to stand out of.
SURROUNDINGS = 64


def piece_of(rate: float) -> int:
    """Return the length [samples], a power of two, of the pieces of a recording of `rate` [Hz]."""
    return int(np.clip(2 ** round(np.log2(SPAN * rate)), SHORTEST, LONGEST))


def frequencies(rate: float) -> np.ndarray:
    """Return the frequencies [Hz] of the spectra of a recording of `rate` [Hz]."""
    return np.fft.rfftfreq(piece_of(rate), 1.0 / rate)


def pieces_of(usable: np.ndarray, record: np.ndarray, rate: float) -> np.ndarray:
    """Return the samples (p, length) of pieces that can be judged throughout, within records.

    Parameters
    ----------
    usable : (N,) samples that can be judged. record : (N,) label of each sample. rate : [Hz].
    """
    length, index = piece_of(rate), np.flatnonzero(usable)
    cuts = np.flatnonzero((np.diff(index) > 1) | (np.diff(record[index]) != 0)) + 1
    starts = [run[k] for run in np.split(index, cuts) for k in range(0, len(run) - length + 1, length // 2)]
    return np.array(starts, dtype=int)[:, None] + np.arange(length)


def spectra(pieces: np.ndarray) -> np.ndarray:
    """Return the spectra (p, k) of pieces (p, length) without their lines, under a Hann window."""
    length = pieces.shape[1]
    ramp = np.arange(length) - 0.5 * (length - 1)
    level = pieces - pieces.mean(axis=1, keepdims=True)
    level = level - np.outer(level @ ramp / (ramp @ ramp), ramp)
    return np.fft.rfft(np.hanning(length) * level, axis=1)


def density_of(pieces: np.ndarray, rate: float) -> np.ndarray:
    """Return the mean density (k,) of pieces (p, length), in their unit squared and per Hz at :func:`frequencies`."""
    return scale_of(pieces.shape[1], rate) * np.mean(np.abs(spectra(pieces)) ** 2, axis=0)


def scale_of(length: int, rate: float) -> float:
    """Return the factor [1/Hz] that makes one-sided densities of squares of :func:`spectra` of pieces of a length."""
    return 2.0 / (rate * float(np.sum(np.hanning(length) ** 2)))


def around(power: np.ndarray) -> np.ndarray:
    """Return the mean power around each cell of a spectrum (k,), from medians that no line moves."""
    if len(power) < 3 * SURROUNDINGS:
        return np.full(len(power), max(float(np.median(power)) / np.log(2.0), 1e-300))
    middle = np.median(power.reshape(-1, SURROUNDINGS), axis=1) / np.log(2.0)
    centre = (np.arange(len(middle)) + 0.5) * SURROUNDINGS
    return np.exp(np.interp(np.arange(len(power)), centre, np.log(np.maximum(middle, 1e-300))))
