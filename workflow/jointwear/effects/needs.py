"""What an effect needs of the data before it can be tried, each with the words that say what is missing."""

from __future__ import annotations

import numpy as np

from jointwear.effects.state import State
from jointwear.effects.temperature import reference_temperature

#: Below this ratio a drive counts as known on the joint side: the angle of its motor is unknown.
DIRECT = 1.5
#: Smallest travel [rad] over which a torque can be seen to depend on the position.
SMALLEST_TRAVEL = 0.02


def _temperature(state: State, axis: int) -> str:
    if not np.isfinite(state.temperature[..., axis]).any():
        return "no temperature was recorded"
    return "" if reference_temperature(state, axis) is not None else "the temperature hardly varies"


def _time(state: State, axis: int) -> str:
    return "" if np.ptp(state.time) > 0 else "the samples have no time"


def _order(state: State, axis: int) -> str:
    return "" if state.record is not None else "the samples have no order in time"


def _gear(state: State, axis: int) -> str:
    if abs(state.drive.gear_ratio[axis]) > DIRECT:
        return ""
    return "the gear ratio is 1 in the robot file: the angle of the motor is unknown"


def _travel(state: State, axis: int) -> str:
    return "" if np.ptp(state.position[..., axis]) > SMALLEST_TRAVEL else "the joint hardly moves"


def _tip(state: State, axis: int) -> str:
    return "" if state.tip_regressor is not None else "the torque of a body at the last link is not at hand"


def _gravity(state: State, axis: int) -> str:
    if state.gravity_regressor is None:
        return "the torque of gravity is not at hand"
    return "" if np.any(state.drive.gravity) else "the robot file has no gravity"


def _motor_torque(state: State, axis: int) -> str:
    if state.torque_kind == "link_sensor":
        return "the torque was measured behind the gear, where the waves of the motor do not arrive"
    return ""


def _friction(state: State, axis: int) -> str:
    drive = state.drive
    levels = (drive.coulomb_positive[axis], drive.coulomb_negative[axis], drive.viscous[axis])
    if state.torque_kind == "link_sensor" and not any(levels):
        return "the torque was measured behind the gear, and the robot file has no friction there"
    return ""


def _gear_between(state: State, axis: int) -> str:
    if state.torque_kind == "link_sensor" and state.encoder_side == "link":
        return "torque and position were both measured behind the gear, where its twist does not show"
    return ""


#: Name of a need -> (state, axis) -> why it is not met, or nothing.
ALL = {
    "temperature": _temperature,
    "time": _time,
    "order": _order,
    "gear": _gear,
    "travel": _travel,
    "tip": _tip,
    "gravity": _gravity,
    "motor torque": _motor_torque,
    "friction": _friction,
    "gear between": _gear_between,
}
