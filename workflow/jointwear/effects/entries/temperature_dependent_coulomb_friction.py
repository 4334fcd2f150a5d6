"""Coulomb friction that falls with temperature."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.temperature import reference_temperature, temperature_shape, warming
from jointwear.effects.unequal_levels import carrier, forms, unequal_parameter

#: Scale [K] beyond which the fall counts as a straight line.
_STRAIGHT = 1e4


def _columns(state, axis, source, p):
    scale = p["scale"]
    fall = scale * np.expm1(-warming(state, axis, p["reference"]) / scale)
    return (fall * carrier(state, axis, p))[..., None]


def _grid(state, axis):
    reference = reference_temperature(state, axis)
    if reference is None:
        return []
    scales = (_STRAIGHT, 100.0, 40.0)
    return [{"reference": reference, "scale": s, **form} for form in forms(state, axis) for s in scales]


_SHAPE = temperature_shape(carrier)

EFFECT = Effect(
    identifier="temperature_dependent_coulomb_friction",
    name="Temperature-dependent Coulomb friction",
    equation="a Fc Tc (exp(-(T - T0)/Tc) - 1) (sign(v) + u), which is -a Fc (T - T0) (sign(v) + u) for a large Tc",
    parameters=(
        Parameter("slope", "N m/K", 0.0, 1e3, "a Fc, fall of Coulomb friction per kelvin at T0"),
        Parameter("scale", "K", 10.0, _STRAIGHT, "Tc, warming over which the fall bends", _STRAIGHT),
        Parameter(
            "reference", "degC", -50.0, 200.0, "T0, at which the robot file's Coulomb friction holds", 25.0, fixed=True
        ),
        unequal_parameter("fall"),
    ),
    confused_with=("torque_constant_temperature", "wear_drift"),
    excitation="slow motion, cold and warm, at times that do not follow the temperature",
    source="Park et al. 2022; Bittencourt and Gunnarsson 2012",
    argument="temperature",
    argument_unit="degC",
    torque=lambda state, axis, source, p: p["slope"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "slope": float(c[0])},
    grid=_grid,
    plain=lambda state, axis: _grid(state, axis)[:1],
    needs=("temperature", "friction"),
    shape=_SHAPE,
    bend=table_bend(_SHAPE, 4),
    vanishes_at="reference",
    floats=True,
)
