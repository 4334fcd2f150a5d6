"""Coulomb friction that grows as the joint wears: equation (7) of the paper."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.unequal_levels import carrier, forms, unequal_parameter


def _growth(state, p):
    x = np.maximum(state.time - p["start"], 0.0) * p["rate"]
    # 1/(1 + exp(-x^m)) - 1/2, written so that small x keeps its digits.
    return 0.5 * np.tanh(0.5 * x ** p["exponent"])


def _columns(state, axis, source, p):
    return (_growth(state, p) * carrier(state, axis, p))[..., None]


def _grid(state, axis):
    start, span = float(np.min(state.time)), float(np.ptp(state.time))
    if span <= 0:
        return []
    shapes = [(0.7, 4.0), (1.2, 4.0), (1.7, 4.0), (3.0, 4.0), (0.5, 1.0), (2.0, 1.0), (5.0, 1.0), (1.0, 2.0)]
    return [{"start": start, "rate": x / span, "exponent": m, **form} for form in forms(state, axis) for x, m in shapes]


def _plain(state, axis):
    # Growth in proportion to time.
    start, span = float(np.min(state.time)), float(np.ptp(state.time))
    return [{"start": start, "rate": 0.3 / span, "exponent": 1.0, **forms(state, axis)[0]}] if span > 0 else []


def _courses(state, axis):
    # From a power of time, far from its end, to a growth that ends early.
    start, span = float(np.min(state.time)), float(np.ptp(state.time))
    rates, exponents = (0.03, 0.5, 0.8, 1.2, 1.8, 2.7, 4.0), np.geomspace(0.5, 6.0, 12)
    courses = [{"start": start, "rate": x / span, "exponent": float(m)} for x in rates for m in exponents]
    return [{**course, **form} for form in forms(state, axis) for course in courses]


def _shape(state, axis, p):
    return carrier(state, axis, p), state.time


EFFECT = Effect(
    identifier="wear_drift",
    name="Wear: growing Coulomb friction",
    equation="c1 (1/(1 + exp(-(c2 t)^m)) - 1/2) (sign(v) + u), m = 4 in the paper",
    parameters=(
        Parameter("level", "N m", 0.0, 1e9, "c1, twice the growth in the end"),
        Parameter("rate", "1/s", 0.0, 1e6, "c2", 1e-6),
        Parameter("exponent", "1", 0.5, 6.0, "m", 4.0),
        unequal_parameter("growth"),
        Parameter("start", "s", -1e10, 1e10, "time at which wear starts", 0.0, fixed=True),
    ),
    confused_with=("temperature_dependent_coulomb_friction", "torque_offset_drift"),
    excitation="the same motion again and again at temperatures that do not follow time",
    source="equation (7) of the paper",
    argument="time x direction",
    argument_unit="s",
    torque=lambda state, axis, source, p: p["level"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "level": float(c[0])},
    grid=_grid,
    plain=_plain,
    courses=_courses,
    shape=_shape,
    bend=table_bend(_shape, 5),
    needs=("time", "friction"),
    floats=True,
)
