"""Friction that rises towards low speed: the Stribeck curve."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.unequal_levels import carrier, forms, unequal_parameter

_SPEEDS = np.geomspace(0.025, 0.4, 8)


def _curve(state, axis, p):
    return np.exp(-((np.abs(state.velocity[..., axis]) / p["speed"]) ** p["exponent"]))


def _columns(state, axis, source, p):
    return (_curve(state, axis, p) * carrier(state, axis, p))[..., None]


def _grid(state, axis):
    curves = [{"speed": float(v), "exponent": d} for v in _SPEEDS for d in (1.0, 2.0)]
    return [{**curve, **form} for form in forms(state, axis) for curve in curves]


def _shape(state, axis, p):
    return carrier(state, axis, p), np.abs(state.velocity[..., axis])


EFFECT = Effect(
    identifier="stribeck_friction",
    name="Stribeck friction",
    equation="(Fs - Fc) exp(-(|v|/vs)^delta) (sign(v) + u)",
    parameters=(
        Parameter("excess", "N m", 0.0, 1e4, "Fs - Fc, friction at breakaway above Coulomb friction"),
        Parameter("speed", "rad/s", 1e-3, 5.0, "vs, speed at which the excess has decayed", 0.1),
        Parameter("exponent", "1", 0.3, 4.0, "delta", 1.0),
        unequal_parameter("excess"),
    ),
    confused_with=("nonlinear_viscous_friction", "presliding_hysteresis"),
    excitation="slow sweeps through every direction of motion",
    source="Armstrong-Helouvry, Dupont and Canudas de Wit 1994",
    argument="velocity",
    argument_unit="rad/s",
    needs=("friction",),
    torque=lambda state, axis, source, p: p["excess"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "excess": float(c[0])},
    grid=_grid,
    shape=_shape,
    bend=table_bend(_shape),
    regime=lambda state, axis, source, p: state.velocity[..., axis],
)
