"""Torque constant, or gain of the torque measurement, that changes as magnets and electronics warm."""

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.temperature import reference_temperature, temperature_shape, warming


def _columns(state, axis, source, p):
    return (warming(state, axis, p["reference"]) * state.torque[..., axis])[..., None]


def _grid(state, axis):
    reference = reference_temperature(state, axis)
    return [] if reference is None else [{"reference": reference}]


_SHAPE = temperature_shape(lambda state, axis: state.torque[..., axis])

EFFECT = Effect(
    identifier="torque_constant_temperature",
    name="Temperature-dependent torque constant",
    equation="a (T - T0) tau; a torque constant that falls makes a torque computed from current rise, a > 0",
    parameters=(
        Parameter("slope", "1/K", -0.1, 0.1, "a, growth of the measured torque per kelvin"),
        Parameter("reference", "degC", -50.0, 200.0, "T0, at which the gain is right", 25.0, fixed=True),
    ),
    confused_with=("temperature_dependent_viscous_friction", "temperature_dependent_coulomb_friction"),
    excitation="gravity load with little motion, cold and warm",
    source="engineering judgement: remanence of magnets falls by about 0.1 to 0.2 % per kelvin",
    argument="temperature",
    argument_unit="degC",
    torque=lambda state, axis, source, p: p["slope"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "slope": float(c[0])},
    grid=_grid,
    needs=("temperature",),
    shape=_SHAPE,
    bend=table_bend(_SHAPE, 4),
    vanishes_at="reference",
    floats=True,
)
