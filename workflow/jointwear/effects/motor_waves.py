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


def waves_per_turn(state: State, axis: int, parameters: Mapping[str, float]) -> float:
    """Return the waves in one turn of the joint."""
    return parameters["order"] * abs(float(state.drive.gear_ratio[axis]))


def motor_wave(
    height: Callable[[State, int], np.ndarray], left: Callable[[State, int, float], np.ndarray | float]
) -> dict[str, Any]:
    """Return the fields of an effect with parameters `amplitude`, `order` and `phase`.

    Parameters
    ----------
    height : (state, axis) -> (...,) torque at an amplitude of one.
    left : (state, axis, waves in one radian) -> (...,) share of the wave that the filters of a recording leave.
    """

    def share(state: State, axis: int, p: Mapping[str, float]) -> np.ndarray | float:
        return left(state, axis, waves_per_turn(state, axis, p))

    def angle(state: State, axis: int, p: Mapping[str, float]) -> np.ndarray:
        return p["order"] * state.drive.gear_ratio[axis] * state.position[..., axis]

    def tall(state: State, axis: int, p: Mapping[str, float]) -> np.ndarray:
        return height(state, axis) * share(state, axis, p)

    def wave(state: State, axis: int, p: Mapping[str, float], high: np.ndarray) -> np.ndarray:
        return state.waves_of(axis, p["order"] * state.drive.gear_ratio[axis]) * high[..., None]

    def columns(state: State, axis: int, source: int | None, p: Mapping[str, float]) -> np.ndarray:
        return wave(state, axis, p, tall(state, axis, p))

    def answered(state: State, axis: int, source: int | None, p: Mapping[str, float], knots: None) -> np.ndarray:
        passed = state.passed(axis, waves_per_turn(state, axis, p))
        return wave(state, axis, p, height(state, axis) * (passed - share(state, axis, p)))

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
        "grid": lambda state, axis: [{"order": float(k)} for k in ORDERS],
        # A wave that shakes the joint is answered by its controller, at a phase of its own: where filters take the
        # shaking off the acceleration, this answer alone is in the torque.
        "bend": harmonics_bend(columns, beside=answered),
        "waves": waves_per_turn,
        "left": share,
        "shape": lambda state, axis, p: (tall(state, axis, p), np.mod(angle(state, axis, p), 2 * np.pi)),
    }
