"""Friction and inertia of another axis's motor that act on this axis, as in coupled wrists."""

import numpy as np

from jointwear.effects.effect import Bend, Effect, Parameter
from jointwear.effects.rests import sense_of
from jointwear.effects.state import record_slices
from jointwear.effects.tables import hats, knots_of


def _speed(state, axis, source, p):
    return p["own"] * state.velocity[..., axis] + p["other"] * state.velocity[..., source]


def _columns(state, axis, source, p):
    # Where the shared drive sticks its friction is anything up to Coulomb friction.
    # The share of this axis in viscous friction and inertia is part of its own parameters in the robot file.
    speed = _speed(state, axis, source, p)
    level = np.sign(speed) if state.record is None else sense_of(speed, record_slices(state))
    for rest in state.rests_of(axis, source, (p["own"], p["other"])):
        level[rest.samples] = rest.sense(state.time[rest.samples])
    return np.stack([level, state.velocity[..., source], state.acceleration[..., source]], axis=-1)


def _bent(state, axis, source, p, knots):
    speed = _speed(state, axis, source, p)
    return np.sign(speed)[:, None] * hats(np.abs(speed), knots)


EFFECT = Effect(
    identifier="drive_coupling",
    name="Drive coupling",
    equation="Fc sign(g v_own + h v_other) + b v_other + J dv_other/dt (a motor that turns with both axes: g = h = 1)",
    parameters=(
        Parameter("coulomb", "N m", 0.0, 1e4, "Fc, Coulomb friction of the shared drive"),
        Parameter("viscous", "N m s/rad", -1e4, 1e4, "b, viscous friction by the speed of the other axis"),
        Parameter("inertia", "kg m2", -1e4, 1e4, "J, inertia by the acceleration of the other axis"),
        Parameter("own", "1", -1.0, 1.0, "g, share of this axis in the motion of the drive", 1.0, fixed=True),
        Parameter("other", "1", -1.0, 1.0, "h, share of the other axis", 1.0, fixed=True),
    ),
    confused_with=("payload",),
    excitation="one axis moving while the other changes direction",
    source="identification of the Staubli TX40 wrist, Gautier and others",
    argument="velocity of the other axis",
    argument_unit="rad/s",
    needs=("friction",),
    torque=lambda state, axis, source, p: (
        _columns(state, axis, source, p) @ np.array([p["coulomb"], p["viscous"], p["inertia"]])
    ),
    columns=_columns,
    parameters_of=lambda p, c: {**p, "coulomb": float(c[0]), "viscous": float(c[1]), "inertia": float(c[2])},
    grid=lambda state, axis: [
        {"own": 0.0, "other": 1.0},
        {"own": 0.0, "other": -1.0},
        {"own": 1.0, "other": 1.0},
        {"own": 1.0, "other": -1.0},
    ],
    # Friction of a drive acts on every axis that turns it: on this one only if this one does.
    plain=lambda state, axis: [{"own": 1.0, "other": 1.0}, {"own": 1.0, "other": -1.0}],
    bend=Bend(_bent, lambda state, axis, source, p, used: knots_of(np.abs(_speed(state, axis, source, p))[used], 5)),
    regime=lambda state, axis, source, p: state.velocity[..., source],
    needs_source=True,
    # Motors that spin are felt by the joints before them, and links are not known exactly: inertia alone is no drive.
    rubs=2,
)
