"""A recording with its derivatives, or the reason why it must not be judged."""

from __future__ import annotations

from functools import cache

from jointwear.measurement.checks import check_recording
from jointwear.measurement.clipped_torque import clipped_torques
from jointwear.measurement.derivative_checks import check_derivatives, check_rate
from jointwear.measurement.motion import Measured
from jointwear.measurement.recording import Recording
from jointwear.measurement.silent_joints import moving_torques
from jointwear.measurement.torque_follows import check_follows
from jointwear.measurement.torque_scale import check_scale
from jointwear.robots.robot import Robot


def checked(recording: Recording, robot: Robot) -> tuple[Measured, list[str]]:
    """Return what :func:`~jointwear.measurement.motion.measure` makes of a recording, and restrictions in words.

    Raises
    ------
    Refused : with the first reason why the recording cannot belong to the robot as it stands; see the checks.
    """
    name = f"data set '{recording.name}'"

    @cache
    def measured() -> Measured:
        check_rate(recording, name)
        return moving_torques(recording)

    check_derivatives(recording, recording.trajectory, name)
    restrictions = check_recording(recording, robot, measured)
    check_scale(recording, robot, measured())
    check_follows(measured(), robot, name)
    return measured(), [*restrictions, *clipped_torques(recording)]
