"""The robot that a torque sensor behind the gears feels: its motors turn before the sensor."""

from __future__ import annotations

from jointwear.measurement.recording import Recording
from jointwear.robots.robot import Robot


def felt_robot(recording: Recording, robot: Robot) -> tuple[Robot, list[str]]:
    """Return the robot whose torque a recording holds, and in words what of its file is not felt there.

    Friction is kept: bearings have theirs behind the sensor, and a file does not say which it means.
    """
    if recording.torque_kind != "link_sensor" or not robot.armature.any():
        return robot, []
    told = "the torque was measured behind the gear, where no motor inertia is felt: that of the robot file is set to 0"
    return robot.without_motor_inertia(), [told]
