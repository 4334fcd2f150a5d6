"""How much of the noise of a torque moves the arm.

A sensor's noise is in the recorded torque alone. What disturbs a drive whose *command* is recorded, or a joint behind
the place where its torque is measured, shakes the arm instead: the nominal torque along the motion holds it, the
recorded torque does not, and the residual holds it with the other sign. Rates of torque are then partly rates of the
residual's own noise, turned by the controller, which looks like a delay (closed-loop identification: Gilson and Van
den Hof 2005; Janot, Vandanjon and Gautier 2014).
"""

from __future__ import annotations

import numpy as np

#: Samples of a piece of which spectra are taken; pieces overlap by half.
PIECE = 128
#: Pieces from which spectra say something.
FEWEST = 8
#: Frequencies count where the nominal torque has at most this many times the power of the residual: above the motion.
ABOVE = 2.0
#: They count where noise of derived accelerations is at most this share of the residual, and above this one [Hz].
DERIVED, LOWEST = 0.25, 2.0
#: Bins of a spectrum that have to count.
BINS = 4
#: Share below which nothing is said to move the arm: noise of a sensor alone comes out at up to 0.08.
LEAST = 0.1


def shaken_shares(
    residual: np.ndarray,
    torque: np.ndarray,
    usable: np.ndarray,
    record: np.ndarray,
    rate: float,
    derived: np.ndarray,
) -> np.ndarray:
    """Return the share (n,) of the noise of each axis that moves the arm, 0 to 1.

    Above the frequencies of the motion the power that residual and nominal torque have in common, with opposite signs,
    over that of the residual; 0 below :data:`LEAST`. A drive behind an elastic gear swings alone; disturbances shake
    more than one joint: no axis counts as more shaken than the next one.

    Parameters
    ----------
    residual, torque : (N, n) [N m] recorded torque less the nominal one, and the nominal one without steps of friction.
    usable : (N, n) samples that can be judged. record : (N,) label of each sample. rate : [Hz].
    derived : (n, 1 + PIECE / 2) density [(N m)^2/Hz] of what noise of derived accelerations makes of the nominal
        torque, at :func:`frequencies`.
    """
    shares = np.zeros(residual.shape[1])
    frequency = frequencies(rate)
    for axis in range(len(shares)):
        pieces = _pieces(usable[:, axis], record)
        if len(pieces) < FEWEST:
            continue
        left, moved = (_spectra(x[:, axis][pieces]) for x in (residual, torque))
        scale = 2.0 / (rate * np.sum(np.hanning(PIECE) ** 2))
        power, motion, common = (
            scale * np.mean(x, axis=0) for x in (np.abs(left) ** 2, np.abs(moved) ** 2, -(left * moved.conj()).real)
        )
        band = (motion < ABOVE * power) & (derived[axis] < DERIVED * power) & (frequency > LOWEST)
        if band.sum() >= BINS:
            shares[axis] = np.sum((common - derived[axis])[band]) / np.sum((power - derived[axis])[band])
    others = [np.max(np.delete(shares, axis), initial=0.0) for axis in range(len(shares))]
    shares = np.minimum(shares, others)
    return np.where(shares < LEAST, 0.0, np.minimum(shares, 1.0))


def frequencies(rate: float) -> np.ndarray:
    """Return the frequencies [Hz] of the spectra of a recording of `rate` [Hz]."""
    return np.fft.rfftfreq(PIECE, 1.0 / rate)


def _pieces(usable: np.ndarray, record: np.ndarray) -> np.ndarray:
    """Return the samples (p, PIECE) of pieces that can be judged throughout, within records."""
    index = np.flatnonzero(usable)
    cuts = np.flatnonzero((np.diff(index) > 1) | (np.diff(record[index]) != 0)) + 1
    starts = [run[k] for run in np.split(index, cuts) for k in range(0, len(run) - PIECE + 1, PIECE // 2)]
    return np.array(starts, dtype=int)[:, None] + np.arange(PIECE)


def _spectra(pieces: np.ndarray) -> np.ndarray:
    """Return the spectra of pieces (p, PIECE) without their lines, under a Hann window."""
    ramp = np.arange(PIECE) - 0.5 * (PIECE - 1)
    level = pieces - pieces.mean(axis=1, keepdims=True)
    level = level - np.outer(level @ ramp / (ramp @ ramp), ramp)
    return np.fft.rfft(np.hanning(PIECE) * level, axis=1)
