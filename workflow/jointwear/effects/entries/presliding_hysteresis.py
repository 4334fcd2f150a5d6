"""Friction that builds up over a short travel after each reversal: Dahl's model, or a spring that slips.

The spring may creep: what built up then falls at rest, as in seals and grease.
"""

import numpy as np
from scipy.optimize import nnls

from jointwear.effects.bristle import bristle, relaxing_bristle
from jointwear.effects.effect import Bend, Effect, Parameter
from jointwear.effects.state import record_slices
from jointwear.effects.unequal_levels import forms, unequal_parameter

#: Travels [rad] over which friction may build up.
DISTANCES = (4e-4, 0.3)
#: States in which records may begin: settled in the sense of the first motion, at ease, settled in the other sense.
STARTS = (1, 0, -1)
#: Time [s] from which that of a spring that creeps is searched: seals and grease do so within seconds.
RELAXATION = 1.0


def _columns(state, axis, source, p):
    if state.record is None:
        return np.zeros((*np.shape(state.position)[:-1], 1))
    distance, spring, start = p["distance"], p.get("spring", 0), p.get("start", 1)
    relaxation = p.get("relaxation", 0)

    def column():
        made = np.zeros(len(state.position))
        for part in record_slices(state):
            position, direction = state.position[part, axis], state.direction[part, axis]
            if spring and relaxation:
                z = relaxing_bristle(position, state.time[part], distance, relaxation, start)
            else:
                z = bristle(position, direction, distance, spring, start)
            made[part] = z - direction
        return made[:, None]

    key = ("presliding", axis, distance, spring, start, relaxation)
    made = state.of_motion(key, column, state.position, state.velocity, state.time, state.record)
    unequal = p.get("unequal", 0.0)
    # Either level builds up over its own travel: 1 + u of it forward, 1 - u backward.
    return made * (1.0 + unequal * state.direction[..., axis, None]) if unequal else made


def _other_spring(p):
    return [{**_lasting(p), "spring": 1 - p.get("spring", 0)}]


def _lasting(p):
    return {name: value for name, value in p.items() if name != "relaxation"}


def _begins(p):
    others = [{**p, "start": start} for start in STARTS if start != p.get("start", 1)]
    if p.get("relaxation", 0) or not p.get("spring", 0):
        return others
    # What relaxes is at ease after a rest.
    return [*others, *({**p, "start": start, "relaxation": RELAXATION} for start in (1, 0))]


def _without_relaxation(state, axis, p):
    if not p.get("relaxation", 0):
        return []
    return [{**_lasting(p), "spring": spring, "start": start} for spring in (0, 1) for start in STARTS]


def _grid(state, axis):
    distances = np.geomspace(6e-4, 0.16, 11)
    return [{"distance": float(x), "spring": 0, "start": 1, **form} for form in forms(state, axis) for x in distances]


def _relaxing(state, axis):
    return [{**p, "spring": 1, "start": 0, "relaxation": RELAXATION} for p in _grid(state, axis)]


#: Distances of further loops, as shares of that of the first, that bend the form together.
_FACTORS = (0.3, 0.6, 1.7, 3.5)


def _bent(state, axis, source, p, knots):
    loops = [_columns(state, axis, source, {**p, "distance": f * p["distance"]}) for f in _FACTORS]
    return np.concatenate(loops, axis=1)


def _written(parameters, knots, coefficients):
    """Return the loops, none of which may drive, whose sum builds up most like that of the fit."""
    distances = parameters["distance"] * np.array([1.0, *_FACTORS])
    allowed = np.clip(distances, DISTANCES[0], DISTANCES[1])
    travel = np.linspace(0.0, 3.0 * distances.max(), 400)[:, None]

    def left(distance):
        return np.maximum(1 - travel / (2 * distance), 0) if parameters.get("spring") else np.exp(-travel / distance)

    wanted = left(distances) @ np.array([parameters["level"], *coefficients])
    levels, _ = nnls(left(allowed), wanted)
    found = [
        {**parameters, "level": float(level), "distance": float(distance)}
        for level, distance in zip(levels, allowed, strict=True)
        if level > 0
    ]
    return found or [{**parameters, "level": 0.0}]


EFFECT = Effect(
    identifier="presliding_hysteresis",
    name="Pre-sliding hysteresis",
    equation="Fc (z - sign(v)) (1 + u sign(v)), dz/dq = (1 - sign(v) z)/x0, or dz/dt = v/x0 - z/tr until z = sign(v)",
    parameters=(
        Parameter("level", "N m", 0.0, 1e4, "Fc, friction that builds up"),
        Parameter("distance", "rad", *DISTANCES, "x0, travel over which it builds up", 0.03),
        unequal_parameter("level"),
        Parameter("spring", "1", 0, 1, "0: Dahl's model, 1: a spring that slips", 0, fixed=True),
        Parameter(
            "start", "1", -1, 1, "state of a record's start: 1 settled, 0 at ease, -1 as moved back", 1, fixed=True
        ),
        Parameter("relaxation", "s", 0.0, 1e4, "tr, in which the z of a spring falls to 1/e at rest; 0: 1/tr is 0"),
    ),
    confused_with=("actuation_delay", "stribeck_friction"),
    excitation="many reversals at different accelerations",
    source="Dahl 1968; Canudas de Wit et al. 1995 (LuGre); relaxation: Maxwell 1867",
    argument="travel since reversal",
    argument_unit="rad",
    torque=lambda state, axis, source, p: p["level"] * _columns(state, axis, source, p)[..., 0],
    columns=_columns,
    parameters_of=lambda p, c: {**p, "level": float(c[0])},
    grid=_grid,
    further=_relaxing,
    alternatives=_other_spring,
    begins=_begins,
    slower=_without_relaxation,
    needs=("order", "friction"),
    bend=Bend(_bent, None, _written),
    sequential=True,
)
