"""The load of an axis, made of the rigid model and of the measured torque.

The load of the model holds the noise of derived accelerations, and so does the residual: M_l e and -M e, with M_l the
mass matrix without motor inertia. What the residual says of the noise is put back into the load: load + G residual,
with G the gain of Wiener's filter, so that the error that is left in the load is not that of the residual. Its second
derivative may then end higher than an instrument without the torque (:mod:`jointwear.discovery.instruments`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jointwear.discovery.instruments import FREQUENCIES
from jointwear.measurement.even_steps import runs

if TYPE_CHECKING:
    from jointwear.discovery.noise import Whitener
    from jointwear.discovery.problem import Problem

#: Samples by which a record is continued, turned about its ends, before its spectrum is multiplied.
CONTINUED = 64


def fused_load(problem: Problem, axis: int, white: Whitener, residual: np.ndarray) -> np.ndarray:
    """Return the load (N_train,) [N m] of one axis without the noise that its residual shows.

    Parameters
    ----------
    white : the noise model of the residual. residual : (N_train,) discrepancy less base regression [N m].
    """
    state, rate = problem.train_state, problem.measured.rate
    frequency = np.linspace(0.0, 0.5 * rate, FREQUENCIES + 1)[1:]
    gain = _gain(problem, axis, white.density(frequency, rate), frequency)
    record = np.asarray(state.record)
    noise = np.concatenate([_shaped(residual[piece], frequency, gain, rate) for piece in runs(record)])
    return state.load[:, axis] + noise


def _gain(problem: Problem, axis: int, density: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Return the gain (k,) from a residual of `density` (k,) [(N m)^2/Hz] to less the noise of the load, 0 to 1."""
    squares = problem.mass_squares[axis]
    of_load = np.array(squares)
    of_load[axis] -= problem.robot.armature[axis] * np.sqrt(squares[axis])
    noise = problem.measured.noise.acceleration(frequency)
    shared, whole = np.maximum(of_load, 0.0) @ noise, squares @ noise
    return shared / np.maximum(np.maximum(density, whole), 1e-300)


def _shaped(values: np.ndarray, frequency: np.ndarray, gain: np.ndarray, rate: float) -> np.ndarray:
    """Return values (m,) with their spectrum multiplied by a gain (k,) at frequencies (k,) [Hz]."""
    more = min(len(values) - 1, CONTINUED)
    whole = np.pad(values, more, mode="reflect", reflect_type="odd")
    spectrum = np.fft.rfft(whole)
    spectrum *= np.interp(np.fft.rfftfreq(len(whole), 1 / rate), frequency, gain)
    return np.fft.irfft(spectrum, len(whole))[more : more + len(values)]
