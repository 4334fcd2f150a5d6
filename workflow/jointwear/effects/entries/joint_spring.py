"""A torque that depends on the position of the joint alone: a spring, a hose, a counterbalance."""

import numpy as np

from jointwear.effects.effect import Effect, Parameter

#: Share of the travel over which the torque goes on straight beyond either end.
_BEYOND = 0.15


def _columns(state, axis, source, p):
    # Beyond the travel that it was found on a polynomial says nothing: it goes on straight for a while, then stays.
    inside = np.clip(state.position[..., axis], p["low"], p["high"])
    reach = _BEYOND * (p["high"] - p["low"])
    beyond = np.clip(state.position[..., axis] - inside, -reach, reach)
    x = inside - p["centre"]
    return np.stack([x + beyond, x**2 + 2 * x * beyond, x**3 + 3 * x**2 * beyond], axis=-1)


def _grid(state, axis):
    q = state.position[..., axis]
    low, high = float(np.round(q.min(), 3)), float(np.round(q.max(), 3))
    return [{"centre": round(0.5 * (low + high), 4), "low": low, "high": high}] if high - low > 0.02 else []


EFFECT = Effect(
    identifier="joint_spring",
    name="Joint spring",
    equation="k1 x + k2 x^2 + k3 x^3 with x = q - qc, which is k (q - q0) + k3 (q - q0)^3 up to a constant",
    parameters=(
        Parameter("stiffness", "N m/rad", -1e6, 1e6, "k1"),
        Parameter("quadratic", "N m/rad2", -1e6, 1e6, "k2"),
        Parameter("cubic", "N m/rad3", -1e6, 1e6, "k3"),
        Parameter("centre", "rad", -100.0, 100.0, "qc, middle of the travel", 0.0, fixed=True),
        Parameter("low", "rad", -100.0, 100.0, "end of the travel on which it was found", -100.0, fixed=True),
        Parameter("high", "rad", -100.0, 100.0, "the other end", 100.0, fixed=True),
    ),
    confused_with=("payload", "position_dependent_friction"),
    excitation="the whole travel in both directions, with and without payload",
    source="engineering judgement; counterbalances of heavy robots",
    argument="position",
    argument_unit="rad",
    torque=lambda state, axis, source, p: (
        _columns(state, axis, source, p) @ np.array([p["stiffness"], p["quadratic"], p["cubic"]])
    ),
    columns=_columns,
    parameters_of=lambda p, c: {**p, "stiffness": float(c[0]), "quadratic": float(c[1]), "cubic": float(c[2])},
    grid=_grid,
    shape=lambda state, axis, p: (np.ones(state.position.shape[:-1]), state.position[..., axis]),
)
