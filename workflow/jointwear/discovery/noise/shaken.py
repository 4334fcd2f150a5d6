"""How much of the noise of a torque moves the arm.

A sensor's noise is in the recorded torque alone. What disturbs a drive whose *command* is recorded, or a joint behind
the place where its torque is measured, shakes the arm instead: the nominal torque along the motion holds it, the
recorded torque does not, and the residual holds it with the other sign. Rates of torque are then partly rates of the
residual's own noise, turned by the controller, which looks like a delay (closed-loop identification: Gilson and Van
den Hof 2005; Janot, Vandanjon and Gautier 2014).
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.noise.spectra import FEWEST_PIECES, frequencies, pieces_of, scale_of, spectra

#: Share of the residual that noise of derived accelerations is at most where it is asked what shakes the arm: half.
DERIVED = 0.5


def shaken_shares(
    residual: np.ndarray,
    torque: np.ndarray,
    usable: np.ndarray,
    record: np.ndarray,
    rate: float,
    derived: np.ndarray,
    sigmas: float,
) -> np.ndarray:
    """Return the share (n,) of the noise of each axis that moves the arm, 0 to 1.

    Above the frequencies of the motion the power that residual and nominal torque have in common, with opposite signs,
    over that of the residual, 0 where two spectra without anything in common have as much. Derived motion ends at some
    frequency, above which a torque has the noise of its sensor alone: the octave with the largest share counts. A drive
    behind an elastic gear swings alone; disturbances shake more than one joint: no axis counts as more shaken than the
    next one.

    Parameters
    ----------
    residual, torque : (N, n) [N m] recorded torque less the nominal one, and the nominal one without steps of friction.
    usable : (N, n) samples that can be judged. record : (N,) label of each sample. rate : [Hz].
    derived : (n, k) density [(N m)^2/Hz] of what noise of derived accelerations makes of the nominal torque, at
        :func:`.spectra.frequencies`. sigmas : standard deviations that a share of an octave needs.
    """
    shares = np.zeros(residual.shape[1])
    frequency = frequencies(rate)
    octave = np.frexp(frequency / assumed.slow())[1]
    for axis in range(len(shares)):
        pieces = pieces_of(usable[:, axis], record, rate)
        if len(pieces) < FEWEST_PIECES:
            continue
        left, moved = (spectra(x[:, axis][pieces]) for x in (residual, torque))
        scale = scale_of(pieces.shape[1], rate)
        power, motion, common = (
            scale * np.mean(x, axis=0) for x in (np.abs(left) ** 2, np.abs(moved) ** 2, -(left * moved.conj()).real)
        )
        band = (motion < assumed.UNDER_MOTION * power) & (derived[axis] < DERIVED * power)
        band &= (frequency > assumed.slow()) & (frequency <= 0.5 * rate / assumed.OCTAVE)
        if not band.any():
            continue
        own, noise = common - derived[axis], power - derived[axis]
        for part in (band, *(band & (octave == one) for one in np.unique(octave[band]))):
            share = np.sum(own[part]) / np.sum(noise[part])
            # Of two spectra without anything in common.
            chance = np.sqrt(np.sum((power * motion)[part]) / (2.0 * len(pieces))) / np.sum(noise[part])
            if share > sigmas * chance:
                shares[axis] = max(shares[axis], share)
    others = [np.max(np.delete(shares, axis), initial=0.0) for axis in range(len(shares))]
    shares = np.minimum(shares, others)
    return np.minimum(shares, 1.0)
