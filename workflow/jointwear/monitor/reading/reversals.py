"""Torque where the load reverses: what lost motion in a gear does to it, gathered while a log is read.

A gear with play carries its load on one flank. Where the torque that it transmits changes sign, the motor crosses the
gap without the load and then catches it: within a tenth of a second the torque first lacks what the load would have
asked for, then has too much. Friction, which follows the speed, changes slowly there, because loads mostly reverse in
the middle of a move, when it begins to brake.

What the regression of the window leaves of the residual, less its mean over two times :data:`REACH`, shows this pulse.
Before the regression it would not: where the bodies of the model are a few percent wrong, the error is quick too
wherever an axis is accelerated, and it follows speed, load and program. The mean square near reversals of the load is
held against that of the rest of the motion, so that noise, ripple and the scale of the torque cancel
(:mod:`.backlash`). How much friction acts behind the gap is not known: near means from where the
torque of the bodies alone changes sign to where body torque and friction together do, and :data:`NEAR` around.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.measurement.derived.even_steps import reaches, steps_in
from jointwear.monitor.reading.model import ModelTorque

#: Half of the span [s] over which the mean is taken, and that lies between a used sample and the next rest or turn:
#: the controller of an arm answers within a tenth of a second.
REACH = 0.1
#: Time [s] around a reversal in which the gap is crossed and the link is caught.
NEAR = 0.15
#: Slowest rate [Hz] that shows such a pulse: a handful of samples of it.
SLOWEST = 25.0
#: Most samples that REACH and NEAR together may span: what is read along around a block.
MOST_SAMPLES = 390


@dataclass(frozen=True)
class Pulses:
    """Squares of the quick part of what is left [N2 m2], (n, m), 0 where it is not known; `near`, `far`: where it is,
    close to a reversal of the load and away from all; `turns`: at the samples at which the load reverses."""

    square: np.ndarray
    near: np.ndarray
    far: np.ndarray
    turns: np.ndarray


def reach_of(rate: float) -> int:
    """Return :data:`REACH` in samples of a rate [Hz], 0 where the rate shows no pulse."""
    if not reaches(rate, SLOWEST):
        return 0
    return min(steps_in(REACH, 1 / rate), int(MOST_SAMPLES * REACH / (REACH + NEAR)))


def pulses(left: np.ndarray, model: ModelTorque, used: np.ndarray, stretch: np.ndarray, reach: int) -> Pulses:
    """Return the pulses of samples in order.

    Parameters
    ----------
    left : (n, m) what the regression leaves of the residual [N m], 0 where not used. used : (m, n) moving samples that
        count. stretch : (m,). reach : :func:`reach_of`.
    """
    known = used.T.copy()
    known[:, 1:] &= (stretch[1:] == stretch[:-1])[None]
    inside = _spread(known, reach) == 2 * reach + 1
    values = np.where(known, left, 0.0)
    quick = values - _spread(values, reach) / (2 * reach + 1)
    square = np.where(inside, quick * quick, 0.0)
    bodies = (model.gravity + model.inertial).T
    whole = model.total.T
    between = (bodies > 0) != (whole > 0)
    turn = np.zeros_like(between)
    turn[:, 1:] = ((bodies[:, 1:] > 0) != (bodies[:, :-1] > 0)) & known[:, 1:] & known[:, :-1]
    near = _spread(between | turn, round(reach * NEAR / REACH)) > 0
    return Pulses(square, inside & near, inside & ~near, turn)


def _spread(values: np.ndarray, reach: int) -> np.ndarray:
    """Return the sums (n, m) over `reach` samples to either side; nothing lies beyond the ends."""
    kind = float if values.dtype.kind == "f" else np.int32
    m = values.shape[1]
    # Sums up to each sample, carried on beyond both ends.
    total = np.empty((values.shape[0], m + 2 * reach + 1), dtype=kind)
    total[:, : reach + 1] = 0
    np.cumsum(values, axis=1, out=total[:, reach + 1 : reach + 1 + m])
    total[:, reach + 1 + m :] = total[:, reach + m : reach + m + 1]
    return total[:, 2 * reach + 1 :] - total[:, :m]
