"""What a judgement needs to know of robot and user."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.monitor.events import Event, events_of
from jointwear.robots.robot import Robot

#: Limit [%] that counts where the user sets none.
DEFAULT_LIMIT = 20.0


@dataclass(frozen=True)
class JudgeSettings:
    """What the judgement needs to know of robot and user.

    coulomb : (n, 2) nominal Coulomb levels [N m], both positive. viscous : (n,) [N m s/rad].
    limit_percent : growth of the Coulomb friction that the forecast counts down to [%].
    false_alarms_per_1000_h : of one detector, all axes of the robot together.
    events : what was done to the robot.
    """

    coulomb: np.ndarray
    viscous: np.ndarray
    limit_percent: float = DEFAULT_LIMIT
    false_alarms_per_1000_h: float = 1.0
    events: tuple[Event, ...] = ()


def settings_of(robot: Robot, entry: Mapping[str, Any]) -> JudgeSettings:
    """Return the settings of a robot and its entry in the config."""
    return JudgeSettings(
        coulomb=np.stack([np.abs(robot.coulomb_positive), np.abs(robot.coulomb_negative)], axis=1),
        viscous=np.abs(robot.viscous),
        limit_percent=float(entry.get("limits", {}).get("coulomb_increase_percent", DEFAULT_LIMIT)),
        false_alarms_per_1000_h=float(entry.get("false_alarms_per_1000_h", 1.0)),
        events=events_of(entry),
    )
