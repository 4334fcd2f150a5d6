"""Viscous friction that does not grow in proportion to speed."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter


def _columns(state, axis, source, p):
    return (np.abs(state.velocity[..., axis]) ** p["exponent"] * state.direction[..., axis])[..., None]


def _shape(state, axis, p):
    return state.direction[..., axis], np.abs(state.velocity[..., axis])


def _agree(p):
    # Friction that falls with the speed, the steeper the slower, is what Stribeck described.
    return p["coefficient"] >= 0.0 or p["exponent"] >= 1.0


EFFECT = Effect(
    identifier="nonlinear_viscous_friction",
    name="Nonlinear viscous friction",
    equation="c |v|^alpha sign(v)",
    parameters=(
        Parameter("coefficient", "N m (s/rad)^alpha", -1e4, 1e4, "c, torque at 1 rad/s"),
        Parameter("exponent", "1", 0.3, 4.0, "alpha", 2.0),
    ),
    confused_with=("stribeck_friction",),
    excitation="a wide range of speeds, held long enough",
    source="Wolf and Iskandar 2018",
    argument="velocity",
    argument_unit="rad/s",
    needs=("friction",),
    torque=lambda state, axis, source, p: p["coefficient"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "coefficient": float(c[0])},
    agree=_agree,
    grid=lambda state, axis: [{"exponent": a} for a in (0.45, 0.6, 0.75, 1.4, 1.7, 2.0, 2.5, 3.0)],
    shape=_shape,
    bend=table_bend(_shape),
    regime=lambda state, axis, source, p: state.velocity[..., axis],
)
