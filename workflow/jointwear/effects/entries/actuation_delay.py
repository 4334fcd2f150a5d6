"""Torque that is measured or acts later than commanded."""

import numpy as np

from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.order import delayed, lagged


def _late(state, axis, delay):
    # Coulomb friction jumps between two samples: the instant of reversal comes from the velocity, which does not.
    velocity, torque = state.velocity[..., axis], state.torque[..., axis]
    smooth = delayed(state, torque - state.drive.coulomb(axis, velocity), delay)
    return smooth + state.drive.coulomb(axis, delayed(state, velocity, delay))


def _smoothed(state, axis, lag):
    velocity, torque = state.velocity[..., axis], state.torque[..., axis]
    level = state.drive.coulomb(axis, velocity)
    return lagged(state, torque - level, lag) + lagged(state, level, lag, velocity)


def _columns(state, axis, source, p):
    if state.record is None:
        return np.zeros((*np.shape(state.time), 1))
    late = _smoothed if p.get("lag") else _late
    return (late(state, axis, p["delay"]) - state.torque[..., axis])[..., None]


def _grid(state, axis):
    if state.record is None:
        return []
    return [{"delay": d, "lag": 0} for d in (0.004, 0.012, 0.02)] + [{"delay": d, "lag": 1} for d in (0.005, 0.015)]


EFFECT = Effect(
    identifier="actuation_delay",
    name="Actuation delay",
    equation="tau(t - d) - tau(t), or the same with a first-order lag of time constant d",
    parameters=(
        Parameter("delay", "s", 0.0, 0.06, "d"),
        Parameter("lag", "1", 0, 1, "0: a dead time, 1: a first-order lag", 0, fixed=True),
    ),
    confused_with=("presliding_hysteresis", "joint_flexibility"),
    excitation="fast changes of torque, with and without reversals",
    source="engineering judgement",
    argument="rate of torque",
    argument_unit="N m/s",
    torque=lambda state, axis, source, p: _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    # To first order the effect is -d times the rate of torque, so the coefficient scales the delay.
    parameters_of=lambda p, c: {**p, "delay": float(p["delay"] * c[0])},
    grid=_grid,
    sequential=True,
)
