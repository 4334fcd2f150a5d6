"""Instruments for effects of timing: columns that do not share the noise of derived accelerations with the residual.

The residual holds -M e, with e the error of a derived acceleration. A column that says how the torque changes when it
is late or filtered is made of the nominal torque, so that it holds L M e with L the (second) derivative. The product
of the two has a mean whatever is missing in the model, on every recording: neither evidence nor recordings left out
see that it is noise. Columns of timing are therefore made of a band-limited nominal torque: below the cut-off the
nominal torque is motion, above it noise. Everything else stays as it is measured, and steps of friction stay sharp.
This is the method of instrumental variables (Soderstrom and Stoica 1983; Janot, Vandanjon and Gautier 2014 for robots).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery.noise import Whitener
from jointwear.effects import State
from jointwear.measurement.derived_noise import DerivedNoise, zero_phase_gain
from jointwear.measurement.motion import low_pass, runs

#: Evidence [nats] that noise which column and residual share may feign at most: what a parameter gains by chance on
#: average, half of a chi-square of one degree of freedom.
FEIGNED = 0.5
#: Frequencies at which spectra are compared, and cut-offs that are tried.
FREQUENCIES, CUTOFFS = 512, 80
#: Share of the rate from which on nothing is left to filter, as in :func:`jointwear.measurement.motion.low_pass`.
HIGHEST = 0.45


def torque_noise(noise: DerivedNoise, mass_squares: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Return the density (n, k) [(N m)^2/Hz] of what the noise of accelerations makes of the nominal torques.

    Parameters
    ----------
    mass_squares : (n, n) mean squares over poses of the derivative of torque j by acceleration k [kg2 m4].
    """
    return mass_squares @ noise.acceleration(frequency)


def cutoff_of(white: Whitener, density: np.ndarray, frequency: np.ndarray, rate: float) -> float:
    """Return the cut-off [Hz] of the instruments of one axis, infinite where none is needed.

    Parameters
    ----------
    white : the noise model of the residual of the axis. density : (k,) of :func:`torque_noise` at `frequency` (k,).

    A column of second derivatives of the torque, the worst there is, is filtered with gain h. Of noise alone it would
    gain N/2 (mean of w h S_a/S_r)^2 / (mean of w^2 h^2 S_a/S_r) nats, w = (2 pi f)^2, S_a the density of the noise of
    the torque and S_r that of the residual. The cut-off is the highest one at which that is :data:`FEIGNED`.
    """
    share = density / white.density(frequency, rate)
    square = (2 * np.pi * frequency) ** 2
    for cutoff in np.geomspace(HIGHEST * rate, HIGHEST * rate / 100, CUTOFFS):
        gain = 1.0 if cutoff >= HIGHEST * rate else zero_phase_gain(frequency / cutoff)
        product, energy = np.mean(square * gain * share), np.mean((square * gain) ** 2 * share)
        if 0.5 * len(white.rows) * product**2 <= FEIGNED * energy or energy == 0:
            return float(cutoff) if cutoff < HIGHEST * rate else np.inf
    return float(cutoff)


def band_limited(state: State, axis: int, cutoff: float, rate: float) -> State:
    """Return the state in which the rigid-body torque of `axis` ends at `cutoff` [Hz]; its friction stays sharp."""
    if not np.isfinite(cutoff):
        return state
    rigid = state.load[:, axis] + state.drive.armature[axis] * state.acceleration[:, axis]
    load, torque = state.load.copy(), state.torque.copy()
    for piece in runs(np.asarray(state.record)):
        load[piece, axis] = low_pass(state.load[piece, axis], cutoff, rate)
        torque[piece, axis] += low_pass(rigid[piece], cutoff, rate) - rigid[piece]
    return replace(state, load=load, torque=torque)
