"""Viscous friction that falls as the lubricant warms."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.temperature import reference_temperature, temperature_shape, warming

#: Warming [K] that lowers it to 37 % where the data do not tell.
_USUAL = 30.0


def _columns(state, axis, source, p):
    fall = np.expm1(-warming(state, axis, p["reference"]) / p["scale"])
    return (fall * state.velocity[..., axis])[..., None]


def _grid(state, axis):
    reference = reference_temperature(state, axis)
    return [] if reference is None else [{"reference": reference, "scale": s} for s in (12.0, _USUAL, 90.0)]


def _plain(state, axis):
    # What the data leave open would grow without bounds below the temperatures that were recorded.
    return [p for p in _grid(state, axis) if p["scale"] == _USUAL]


_SHAPE = temperature_shape(lambda state, axis, p: state.velocity[..., axis])

EFFECT = Effect(
    identifier="temperature_dependent_viscous_friction",
    name="Temperature-dependent viscous friction",
    equation="b (exp(-(T - T0)/Tv) - 1) v",
    parameters=(
        Parameter("coefficient", "N m s/rad", 0.0, 1e4, "b, viscous friction at T0 that follows the temperature"),
        Parameter("scale", "K", 3.0, 300.0, "Tv, warming that lowers it to 37 %", _USUAL),
        Parameter(
            "reference", "degC", -50.0, 200.0, "T0, at which the robot file's viscous friction holds", 25.0, fixed=True
        ),
    ),
    confused_with=("temperature_dependent_coulomb_friction", "torque_constant_temperature"),
    excitation="fast and slow motion, each cold and warm",
    source="Wolf and Iskandar 2018; Simoni et al. 2015",
    argument="temperature",
    argument_unit="degC",
    torque=lambda state, axis, source, p: p["coefficient"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "coefficient": float(c[0])},
    grid=_grid,
    plain=_plain,
    needs=("temperature", "friction"),
    shape=_SHAPE,
    bend=table_bend(_SHAPE, 4),
    vanishes_at="reference",
    floats=True,
)
