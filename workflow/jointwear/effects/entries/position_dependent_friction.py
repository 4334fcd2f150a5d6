"""Friction that varies along the travel of the joint."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.travel import ENDS, FAR, ends_of
from jointwear.effects.unequal_levels import carrier, forms, unequal_parameter

#: Waves on the travel from which on they are a law.
REPEATED = 2


def _columns(state, axis, source, p):
    angle = p["order"] * state.position[..., axis]
    return np.stack([np.sin(angle), np.cos(angle)], axis=-1) * carrier(state, axis, p)[..., None]


def _torque(state, axis, source, p):
    return _friction(p, state.position[..., axis]) * carrier(state, axis, p)


def _friction(p, position):
    """Return the friction that is added at positions (...,) [N m].

    A wave that was seen twice is a law. Else it is a curve through the travel that was seen: beyond, it goes on to
    where it is nothing, and nothing is known from there on.
    """
    low, high = p.get("low", -FAR), p.get("high", FAR)
    wave = p["amplitude"] * np.sin(p["order"] * position + p["phase"])
    if p["order"] * (high - low) >= 2 * np.pi * REPEATED:
        return wave
    ends = np.array([low, high])
    turns = (p["order"] * ends + p["phase"]) / np.pi
    first, last = (np.array([np.floor(turns[0]), np.ceil(turns[1])]) * np.pi - p["phase"]) / p["order"]
    return np.where((position >= first) & (position <= last), wave, 0.0)


def _grid(state, axis):
    travel = ends_of(state, axis)
    orders = (1, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
    return [{"order": float(n), **form, **travel} for form in forms(state, axis) for n in orders]


def _shape(state, axis, p):
    return carrier(state, axis, p), state.position[..., axis]


EFFECT = Effect(
    identifier="position_dependent_friction",
    name="Position-dependent friction",
    equation="A sin(n q + phi) (sign(v) + u)",
    parameters=(
        Parameter("amplitude", "N m", 0.0, 1e4, "A"),
        Parameter("order", "1", 0.8, 40.0, "n, waves in one turn of the joint", 1.0),
        Parameter("phase", "rad", -6.3, 6.3, "phi"),
        unequal_parameter("friction"),
        *ENDS,
    ),
    confused_with=("joint_spring",),
    excitation="the whole travel in both directions",
    source="Tuttle 1992; Armstrong 1988 on the PUMA",
    argument="position x direction",
    argument_unit="rad",
    needs=("friction",),
    torque=_torque,
    columns=_columns,
    parameters_of=lambda p, c: {
        **p,
        "amplitude": float(np.hypot(c[0], c[1])),
        "phase": float(np.arctan2(c[1], c[0])),
    },
    grid=_grid,
    shape=_shape,
    as_seen=True,
    bend=table_bend(_shape, per_wave=8),
    # On a short travel a slow wave of large amplitude looks like a fast one of small amplitude.
    alike=lambda p: [{**p, "order": order} for order in (1.0, 1.5, 2.0, 3.0, 4.0)],
)
