"""Friction that varies along the travel of the joint."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter


def _columns(state, axis, source, p):
    angle = p["order"] * state.position[..., axis]
    return np.stack([np.sin(angle), np.cos(angle)], axis=-1) * state.direction[..., axis, None]


def _torque(state, axis, source, p):
    angle = p["order"] * state.position[..., axis] + p["phase"]
    return p["amplitude"] * np.sin(angle) * state.direction[..., axis]


def _shape(state, axis, p):
    return state.direction[..., axis], state.position[..., axis]


EFFECT = Effect(
    identifier="position_dependent_friction",
    name="Position-dependent friction",
    equation="A sin(n q + phi) sign(v)",
    parameters=(
        Parameter("amplitude", "N m", 0.0, 1e4, "A"),
        Parameter("order", "1", 0.8, 40.0, "n, waves in one turn of the joint", 1.0),
        Parameter("phase", "rad", -6.3, 6.3, "phi"),
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
    grid=lambda state, axis: [{"order": float(n)} for n in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)],
    shape=_shape,
    as_seen=True,
    bend=table_bend(_shape, per_wave=8),
    # On a short travel a slow wave of large amplitude looks like a fast one of small amplitude.
    alike=lambda p: [{**p, "order": order} for order in (1.0, 1.5, 2.0, 3.0, 4.0)],
)
