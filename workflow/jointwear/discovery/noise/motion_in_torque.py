"""Up to which frequency a nominal torque is motion: above it most of it is noise of derived accelerations.

The base regression takes that noise off the residual, as far as it follows the filter behind the derivatives. A column
with a coefficient of one that goes on where the torque is noise then brings it back, and speaks against itself however
much is true of it. So columns of a torque at another time end where noise is most of it, as an instrument does that is
to be correlated with the motion (Soderstrom and Stoica 1983).
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.noise.spectra import FEWEST_PIECES, density_of, frequencies, pieces_of


def noise_in_torque(
    residual: np.ndarray, usable: np.ndarray, record: np.ndarray, rate: float, derived: np.ndarray
) -> np.ndarray:
    """Return the density (n, k) [(N m)^2/Hz] of the noise of derived accelerations in the nominal torque of each axis.

    The residual holds all of that noise: where its density, before any regression, is lower than what the floor of the
    positions says, the floor is motion. Of too few pieces that can be judged the floor is all that is known.

    Parameters
    ----------
    residual : (N, n) [N m] recorded torque less the nominal one. usable : (N, n) samples that can be judged.
    record : (N,) label of each sample. rate : [Hz].
    derived : (n, k) what noise of derived accelerations makes of the nominal torque by the floor of the positions, at
        :func:`jointwear.discovery.noise.spectra.frequencies`.
    """
    noise = np.array(derived, dtype=float)
    for axis in range(len(noise)):
        pieces = pieces_of(usable[:, axis], record, rate)
        if len(pieces) >= FEWEST_PIECES:
            noise[axis] = np.minimum(noise[axis], density_of(residual[:, axis][pieces], rate))
    return noise


def motion_ends(
    torque: np.ndarray, usable: np.ndarray, record: np.ndarray, rate: float, noise: np.ndarray
) -> np.ndarray:
    """Return the lowest frequency (n,) [Hz] at which noise is most of the torque of an axis, infinite without one.

    Of too few pieces that can be judged nothing is said: infinite.

    Parameters
    ----------
    torque : (N, n) [N m] nominal torque without steps of friction. noise : (n, k) of :func:`noise_in_torque`.
    usable, record, rate : as there.
    """
    ends, frequency = np.full(torque.shape[1], np.inf), frequencies(rate)
    for axis in range(len(ends)):
        pieces = pieces_of(usable[:, axis], record, rate)
        if len(pieces) < FEWEST_PIECES:
            continue
        most = np.flatnonzero(noise[axis] > density_of(torque[:, axis][pieces], rate) - noise[axis])
        if len(most):
            ends[axis] = frequency[most[0]]
    return ends
