"""A gear that twists under load, so that the motor moves differently from the link."""

import numpy as np

from jointwear.effects.bends import timing_bend
from jointwear.effects.effect import Derived, Effect, Parameter
from jointwear.effects.order import first_derivative, second_derivative, up_to
from jointwear.effects.swing import drag_of, torque_of, torque_on_own, wind_up

#: Jm G^2 / K [s^2] to start from, for drives of 2 to 23 Hz; reversals of the motor move with it.
_SHARES = (5e-5, 1.3e-4, 3.2e-4, 8e-4, 2e-3, 5e-3)
#: J / K [s^2] to start from, for links that swing at 60 to 4 Hz, that of a heavy arm stretched out with its load. A
#: swing is sharp: in steps of a seventh of the stiffness none is passed by.
_SWINGS = tuple(float(x) for x in (2 * np.pi * np.geomspace(60.0, 4.0, 39)) ** -2.0)
#: Damping of that swing to start from, over that at which it ends. Inertia that is a few per cent off puts a swing out
#: of step within some turns, and then nothing of it fits: a swing that ends soon is looked for too, in wider steps.
_DAMPING = 0.05
_DAMPED, _STRIDE = 0.25, 3


def _friction(state, axis, velocity):
    return state.drive.coulomb(axis, velocity) + state.drive.viscous[axis] * velocity


def _spreads(p):
    return bool(p.get("side")) and p.get("inertia", 0.0) > 0


def _spread(state, axis, source, p):
    """Return the torques (..., n) that a link lacks which lags behind its motor by the wind-up."""
    if state.record is None:
        return np.zeros(np.shape(state.position))
    return -torque_of(_twist(state, axis, p), state.wind_up_regressor(axis), axis)


def _twist(state, axis, p):
    """Return the wind-up of a gear in states that have an order."""
    by_acceleration, _, by_angle = state.wind_up_regressor(axis)
    stiffness = p["inertia"] / p["inertia_over_stiffness"]
    load, inertia = state.load[..., axis], by_acceleration[..., axis]
    drag = drag_of(stiffness, p["inertia"], p.get("damping", _DAMPING))
    key = "wind-up", axis, stiffness, drag
    keep = p["inertia_over_stiffness"] in _SWINGS
    return state.once(key, lambda: wind_up(state, load, inertia, stiffness, drag, by_angle[..., axis]), keep)


def _columns(state, axis, source, p):
    """Return what the wind-up load / K of the gear adds to the torque: inertia and friction are those of the motor."""
    load, velocity = state.load[..., axis], state.velocity[..., axis]
    share, inertia = p["inertia_over_stiffness"], p.get("inertia", 0.0)
    if _spreads(p) and state.wind_up_regressor is not None:
        if state.record is None:
            return np.zeros((*np.shape(load), 1))
        return -torque_on_own(_twist(state, axis, p), state.wind_up_regressor(axis), axis)[:, None]
    if p.get("band", 0.0) > 0:
        load = up_to(state, load, p["band"])
    torque = share * second_derivative(state, load)
    if p.get("side"):
        # Motor and friction move as recorded; the link behind the gear lags by the wind-up, and its inertia with it.
        return -torque[..., None]
    if inertia > 0:
        # The motor reverses earlier or later than the link. At rest it is at rest too.
        turning = velocity + np.where(velocity == 0, 0.0, share / inertia * first_derivative(state, load))
        torque = torque + _friction(state, axis, turning) - _friction(state, axis, velocity)
    return torque[..., None]


def _grid(state, axis):
    of_motor = [{"inertia_over_stiffness": x, "inertia": 0.0, "side": 1} for x in _SHARES]
    if state.wind_up_regressor is not None and state.encoder_side != "link":
        link = float(np.mean(state.wind_up_regressor(axis)[0][..., axis]))
        if link > 0:
            of_motor = [
                {"inertia_over_stiffness": x, "inertia": link, "side": 1, "damping": damping}
                for damping, swings in ((_DAMPING, _SWINGS), (_DAMPED, _SWINGS[::_STRIDE]))
                for x in swings
            ]
    if state.torque_kind == "link_sensor":
        # Behind the gear the motor is not felt: only the positions may be its own.
        return of_motor
    # The stiffness follows from the motor inertia of the model; where that is unknown, so is how the motor turns.
    of_link = [{"inertia_over_stiffness": x, "inertia": float(state.drive.armature[axis]), "side": 0} for x in _SHARES]
    if state.encoder_side == "link":
        return of_link
    return of_link + of_motor


def _parameters_of(p, c):
    # The size of a swing is in its parameters. Else inertia enters in proportion; the reversals of the motor do not,
    # so that the search moves the parameter too.
    return {**p, "inertia_over_stiffness": float(p["inertia_over_stiffness"] * (1.0 if _spreads(p) else c[0]))}


def _stiffness(p):
    """Return K [N m/rad] behind the gear, None where the inertia that it follows from is not known."""
    inertia, share = p.get("inertia", 0.0), p["inertia_over_stiffness"]
    return inertia / share if inertia > 0 and share > 0 else None


EFFECT = Effect(
    identifier="joint_flexibility",
    name="Joint flexibility",
    equation="(Jm G^2/K) d2(tau_load)/dt2, friction at v + d(tau_load)/dt / K; "
    "motor side: -M d2w/dt2 - (dtau/dv) dw/dt - (dtau/dq) w, of its own axis -d(J dw/dt)/dt - (dg/dq) w, with "
    "d(J dw/dt)/dt + D dw/dt + (K + dg/dq) w = tau_load",
    parameters=(
        Parameter(
            "inertia_over_stiffness", "s2", 0.0, 1.0, "Jm G^2/K, or J/K with the inertia of the link: (period / 2 pi)^2"
        ),
        Parameter(
            "inertia",
            "kg m2",
            0.0,
            1e4,
            "Jm G^2 or mean J from which K follows; 0: friction as of the link, or a link that does not swing",
            0.0,
            True,
        ),
        Parameter("side", "1", 0, 1, "0: positions are those of the link, 1: of the motor", 0, fixed=True),
        Parameter("damping", "1", 0.0, 1.0, "damping of the swing of the link, 1: it does not swing", _DAMPING),
        Parameter(
            "band", "Hz", 0.0, 1e6, "up to where the load is known from the motion; 0: everywhere", 0.0, fixed=True
        ),
    ),
    confused_with=("actuation_delay",),
    excitation="motion with much jerk, and different loads",
    source="Gautier, Janot and Vandanjon 2013; Spong 1987",
    argument="second derivative of the load",
    argument_unit="N m/s2",
    torque=lambda state, axis, source, p: _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=_parameters_of,
    grid=_grid,
    needs=("order", "gear between"),
    scaled="inertia_over_stiffness",
    spreads=_spreads,
    spread=_spread,
    timing=True,
    as_wound=True,
    of_load=True,
    band="band",
    bend=timing_bend(),
    sequential=True,
    derived=(
        Derived(
            "stiffness",
            "N m/rad",
            "K = inertia / inertia_over_stiffness, of the gear at the joint; as right as that inertia, which is of the "
            "robot file: a payload that is missing there is missing here",
            _stiffness,
        ),
    ),
)
