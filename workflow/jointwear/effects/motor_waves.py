"""What the effects share whose torque is a wave over the angle of the motor: A h sin(k G q + phi)."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from jointwear.effects.bends import harmonics_bend
from jointwear.effects.effect import Parameter
from jointwear.effects.state import State

#: Waves in one turn of the motor that are tried.
ORDERS = range(1, 25)
ORDER = Parameter("order", "1", 0.05, 400.0, "k, waves in one turn of the motor", 1.0, searched=False)
PHASE = Parameter("phase", "rad", -6.3, 6.3, "phi")
HELD = Parameter(
    "held", "1", 0.0, 1.0, "1: the controller holds the joint still, 0: the wave shakes it", searched=False
)


def waves_per_turn(state: State, axis: int, parameters: Mapping[str, float]) -> float:
    """Return the waves in one turn of the joint."""
    return parameters["order"] * abs(float(state.drive.gear_ratio[axis]))


def motor_wave(
    height: Callable[[State, int], np.ndarray],
    left: Callable[[State, int, float], np.ndarray | float],
    may_be_held: bool = False,
) -> dict[str, Any]:
    """Return the fields of an effect with parameters `amplitude`, `order` and `phase`.

    Parameters
    ----------
    height : (state, axis) -> (...,) torque at an amplitude of one.
    left : (state, axis, waves in one radian) -> (...,) share of the wave that the filters of a recording leave.
    may_be_held : a stiff controller may keep the wave from shaking the joint (parameter `held`): then all of it is in
        the torque, and only filters of the torque take a part.
    """

    def share(state: State, axis: int, p: Mapping[str, float]) -> np.ndarray | float:
        waves = waves_per_turn(state, axis, p)
        return state.passed(axis, waves) if p.get("held", HELD.default) else left(state, axis, waves)

    def angle(state: State, axis: int, p: Mapping[str, float]) -> np.ndarray:
        return p["order"] * state.drive.gear_ratio[axis] * state.position[..., axis]

    def tall(state: State, axis: int, p: Mapping[str, float]) -> np.ndarray:
        return height(state, axis) * share(state, axis, p)

    def wave(state: State, axis: int, p: Mapping[str, float], high: np.ndarray) -> np.ndarray:
        return state.waves_of(axis, p["order"] * state.drive.gear_ratio[axis]) * high[..., None]

    def columns(state: State, axis: int, source: int | None, p: Mapping[str, float]) -> np.ndarray:
        return wave(state, axis, p, tall(state, axis, p))

    def answered(state: State, axis: int, source: int | None, p: Mapping[str, float], knots: None) -> np.ndarray:
        waves = waves_per_turn(state, axis, p)
        return wave(state, axis, p, height(state, axis) * (state.passed(axis, waves) - left(state, axis, waves)))

    def grid(state: State, axis: int) -> list[dict[str, float]]:
        shaken = [{"order": float(k)} for k in (*ORDERS, *state.orders_of_gears(axis))]
        # Where no filter has made the accelerations, what shakes the joint is in them, and the two are one.
        two = may_be_held and state.derives is not None
        return [*shaken, *({**p, "held": 1.0} for p in shaken)] if two else shaken

    return {
        "torque": lambda state, axis, source, p: (
            p["amplitude"] * tall(state, axis, p) * np.sin(angle(state, axis, p) + p["phase"])
        ),
        "columns": columns,
        "parameters_of": lambda p, c: {
            **p,
            "amplitude": float(np.hypot(c[0], c[1])),
            "phase": float(np.arctan2(c[1], c[0])),
        },
        "grid": grid,
        # A wave that shakes the joint is answered by its controller, at a phase of its own: where filters take the
        # shaking off the acceleration, this answer alone is in the torque.
        "bend": harmonics_bend(columns, beside=answered),
        "waves": waves_per_turn,
        "left": share,
        "shape": lambda state, axis, p: (tall(state, axis, p), np.mod(angle(state, axis, p), 2 * np.pi)),
    }
