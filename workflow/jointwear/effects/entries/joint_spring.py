"""A torque that depends on the position of the joint alone: a spring, a hose, a counterbalance."""

import numpy as np

from jointwear.effects.bends import table_bend
from jointwear.effects.effect import Effect, Parameter
from jointwear.effects.travel import ENDS, ends_of

_NAMES = ("stiffness", "quadratic", "cubic", "preload")


def _powers(position, p):
    # Beyond the travel that it was found on a polynomial says nothing, but a spring pulls to where it rests: it goes on
    # straight, as far again as it was seen, and stays then.
    inside = np.clip(position, p["low"], p["high"])
    reach = p["high"] - p["low"]
    beyond = np.clip(position - inside, -reach, reach)
    x = inside - p["centre"]
    return np.stack([x + beyond, x**2 + 2 * x * beyond, x**3 + 3 * x**2 * beyond, np.ones(np.shape(x))], axis=-1)


def _columns(state, axis, source, p):
    return _powers(state.position[..., axis], p)


def _law(p, position):
    return _powers(position, p) @ np.array([p[name] for name in _NAMES])


def _grid(state, axis):
    travel = ends_of(state, axis)
    return [{"centre": round(0.5 * sum(travel.values()), 4), **travel}]


def _shape(state, axis, p):
    return np.ones(state.position.shape[:-1]), state.position[..., axis]


EFFECT = Effect(
    identifier="joint_spring",
    name="Joint spring",
    equation="p + k1 x + k2 x^2 + k3 x^3 with x = q - qc, which is c + k (q - q0) + k3 (q - q0)^3",
    parameters=(
        Parameter("stiffness", "N m/rad", -1e6, 1e6, "k1"),
        Parameter("quadratic", "N m/rad2", -1e6, 1e6, "k2"),
        Parameter("cubic", "N m/rad3", -1e6, 1e6, "k3"),
        Parameter("preload", "N m", -1e6, 1e6, "p, torque in the middle of the travel"),
        Parameter("centre", "rad", -100.0, 100.0, "qc, middle of the travel", 0.0, fixed=True),
        *ENDS,
    ),
    confused_with=("payload", "position_dependent_friction"),
    excitation="the whole travel in both directions, with and without payload",
    source="engineering judgement; counterbalances of heavy robots",
    argument="position",
    argument_unit="rad",
    torque=lambda state, axis, source, p: _law(p, state.position[..., axis]),
    columns=_columns,
    parameters_of=lambda p, c: {**p, **dict(zip(_NAMES, map(float, c), strict=True))},
    grid=_grid,
    needs=("travel",),
    # A constant is also a Coulomb friction that differs with the direction. Friction of a drive is known far better
    # than the preload of a spring, so that a spring takes its preload before friction has to change its sign.
    widths=(1.0, 1.0, 1.0, 10.0),
    shape=_shape,
    as_wound=True,
    as_seen=True,
    bend=table_bend(_shape, 6, law=_law),
)
