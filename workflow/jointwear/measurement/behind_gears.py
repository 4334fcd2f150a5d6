"""The robot that a torque sensor behind the gears feels: its motors turn before the sensor."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.recording import Recording
from jointwear.robots.robot import Robot

#: Share of the samples that may lie beyond what counts as the largest torque, and travel [rad] of a joint that moves.
BEYOND, MOVES = 0.01, 0.01


def felt_robot(recording: Recording, robot: Robot) -> tuple[Robot, list[str]]:
    """Return the robot whose torque a recording holds, and in words what of its file is not felt there.

    Bearings have friction behind the sensor, and a file does not say which it means: it is kept unless that of some
    joint alone is more than the largest torque that was measured there.
    """
    if recording.torque_kind != "link_sensor":
        return robot, []
    if _is_of_motors(recording, robot):
        told = "neither friction nor inertia of motors and gears is felt: those of the robot file are"
        felt = robot.without_drives()
    elif robot.armature.any():
        told, felt = "no motor inertia is felt: that of the robot file is", robot.without_motor_inertia()
    else:
        return robot, []
    return felt, [f"the torque was measured behind the gear, where {told} set to 0"]


def _is_of_motors(recording: Recording, robot: Robot) -> bool:
    """Return whether the Coulomb friction of some joint that moves is more than all torque that it shows."""
    if recording.torque.shape[1] != robot.joints:
        return False
    level = np.minimum(robot.coulomb_positive, -robot.coulomb_negative)
    for own, q, torque in zip(level, recording.position.T, recording.torque.T, strict=True):
        known = np.isfinite(q) & np.isfinite(torque)
        if known.any() and np.ptp(q[known]) > MOVES and own > np.quantile(np.abs(torque[known]), 1.0 - BEYOND):
            return True
    return False
