"""The load of an axis, made of the rigid model and of the measured torque.

The load of the model holds the noise of derived accelerations, and so does the residual: M_l e and -M e, with M_l the
mass matrix without motor inertia. What the residual says of the noise is put back into the load: load + G residual,
with G the gain of Wiener's filter, so that the error that is left in the load is not that of the residual. Its second
derivative may then end higher than an instrument without the torque (:mod:`jointwear.discovery.problem.instruments`).

While it is not known what an elastic gear adds to the residual, that part is put into the load as well. Against nothing
hidden the columns are then as they should be, but the size that they give to a gear is too small, the more so the
closer its swing is. Once a gear has its name, what it adds, share load'', is taken off the residual first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jointwear.discovery.problem.instruments import FREQUENCIES
from jointwear.effects.order import shaped
from jointwear.statistics.runs import runs

if TYPE_CHECKING:
    from jointwear.discovery.noise.noise import Whitener
    from jointwear.discovery.problem.problem import Problem

#: How many ends the columns of an elastic gear may have between that of columns of timing and that of a swing.
ENDS = 9


def fused_load(problem: Problem, axis: int, white: Whitener, residual: np.ndarray, share: float = 0.0) -> np.ndarray:
    """Return the load (N_train,) [N m] of one axis without the noise that its residual shows.

    Parameters
    ----------
    white : the noise model of the residual. residual : (N_train,) discrepancy less base regression [N m].
    share : Jm G^2/K [s2] of an elastic gear that the residual holds, 0 for none.
    """
    state, rate = problem.train_state, problem.measured.rate
    frequency = np.linspace(0.0, 0.5 * rate, FREQUENCIES + 1)[1:]
    turned = share * (2 * np.pi * frequency) ** 2
    gain = _gain(problem, axis, white.density(frequency, rate), frequency, turned)
    pieces, load = runs(np.asarray(state.record)), state.load[:, axis]

    def through(values: np.ndarray, gain: np.ndarray) -> np.ndarray:
        return np.concatenate([shaped(values[p], 1 / rate, lambda f: np.interp(f, frequency, gain)) for p in pieces])

    noise = through(residual, gain)
    if share:
        # Its second derivative is the load times -(2 pi f)^2: share load'' is taken off the residual.
        noise += through(load, gain * turned)
    return load + noise


def end_of_columns(problem: Problem, axis: int, white: Whitener, share: float, low: float, high: float) -> float:
    """Return the frequency [Hz], from `low` to `high`, at which the columns of an elastic gear end.

    Of what a gear adds to the residual the fused load gets the part gain (2 pi f)^2 share, with the wrong sign. Columns
    end before that is more than a bend of their form may be: further up a soft gear speaks against itself.

    Parameters
    ----------
    share : Jm G^2/K [s2] of the gear.
    """
    rate = problem.measured.rate
    frequency = np.linspace(0.0, 0.5 * rate, FREQUENCIES + 1)[1:]
    gain = _gain(problem, axis, white.density(frequency, rate), frequency, np.zeros(len(frequency)))
    spoilt = np.flatnonzero(gain * share * (2 * np.pi * frequency) ** 2 > problem.settings.usual)
    first = frequency[spoilt[0]] if len(spoilt) else np.inf
    # In steps, so that sizes that hardly differ are asked of the same columns.
    ends = np.geomspace(low, high, ENDS)
    return float(ends[max(int(np.searchsorted(ends, first, side="right")) - 1, 0)])


def _gain(problem: Problem, axis: int, density: np.ndarray, frequency: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Return the gain (k,) from a residual of `density` (k,) [(N m)^2/Hz] to less the noise of the load.

    Parameters
    ----------
    turned : (k,) share of the load, with the other sign, that a gear adds to the residual. Taken off, it leaves the
        noise (M - turned M_l) e in it. Without a gear the gain is 0 to 1; well above its swing the torque alone tells
        the load.
    """
    squares = problem.mass_squares[axis]
    noise = problem.measured.noise.acceleration(frequency)
    whole = np.sqrt(squares)
    light = whole.copy()
    light[axis] = max(whole[axis] - problem.robot.armature[axis], 0.0)
    left = whole[:, None] - light[:, None] * turned
    shared = np.sum(light[:, None] * left * noise, axis=0)
    rest = np.maximum(density - squares @ noise, 0.0)
    return shared / np.maximum(np.sum(left**2 * noise, axis=0) + rest, 1e-300)
