"""Torque constant, or gain of the torque measurement, that changes as magnets and electronics warm."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.temperature import reference_temperature, temperature_shape, warming


def _torque(state, axis, source, p):
    return p["slope"] * warming(state, axis, p["reference"]) * state.torque[..., axis]


def _columns(state, axis, source, p):
    # At which temperature the gain is right is read off the data: no number of the drive could take over the rest.
    known = np.isfinite(state.temperature[..., axis])
    torque = state.torque[..., axis] * known
    return np.stack([warming(state, axis, p["reference"]) * torque, torque], axis=-1)


def _parameters_of(p, c):
    slope = float(c[0]) or 1e-12
    return {"slope": slope, "reference": p["reference"] - float(c[1]) / slope}


def _grid(state, axis):
    reference = reference_temperature(state, axis)
    return [] if reference is None else [{"reference": reference}]


_SHAPE = temperature_shape(lambda state, axis, p: state.torque[..., axis])

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
    torque=_torque,
    columns=_columns,
    parameters_of=_parameters_of,
    grid=_grid,
    needs=("temperature",),
    shape=_SHAPE,
    bend=table_bend(_SHAPE, 4),
    of_torque=True,
)
