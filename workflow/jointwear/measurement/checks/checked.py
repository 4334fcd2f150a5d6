"""A recording with its derivatives, or the reason why it must not be judged."""

from __future__ import annotations

from dataclasses import dataclass

from jointwear.measurement.checks.axes_check import RIGHT, signs_in_doubt, signs_of
from jointwear.measurement.checks.checks import check_recording
from jointwear.measurement.checks.clipped_torque import clipped_torques
from jointwear.measurement.checks.copied_columns import check_columns_differ
from jointwear.measurement.checks.derivative_checks import check_derivatives, check_rate
from jointwear.measurement.checks.held_rows import check_rows_are_new, check_torques_are_new
from jointwear.measurement.checks.lasting_jumps import check_rows_follow
from jointwear.measurement.checks.late_torque import check_delay
from jointwear.measurement.checks.left_over import left_in_words
from jointwear.measurement.checks.model_size import check_model_size, unusual_parameters
from jointwear.measurement.checks.mounting import check_mounting
from jointwear.measurement.checks.other_zero import check_axes_and_zero, zero_in_words
from jointwear.measurement.checks.position_unit import check_position_unit, check_reach
from jointwear.measurement.checks.silent_joints import moving_torques, silence_in_words
from jointwear.measurement.checks.some_in_radians import check_units_alike
from jointwear.measurement.checks.time_scale import check_time_scale
from jointwear.measurement.checks.torque_follows import check_follows
from jointwear.measurement.checks.torque_scale import check_scale, check_scale_of_one, thinned, torque_factors
from jointwear.measurement.checks.unsigned_torque import check_torque_has_sign
from jointwear.measurement.derived.jumps import jumps_in_words
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.derived.torque_spikes import spikes_in_words
from jointwear.measurement.recording import Recording
from jointwear.measurement.stated import Stated
from jointwear.robots.robot import Robot

#: What is told where the motion is too little for the question.
UNASKED = "too little motion to tell whether sign, order, zero and side of the axes are those of the robot"


@dataclass(frozen=True)
class Checked:
    """A recording that is not refused.

    Attributes
    ----------
    measured : what :func:`~.motion.measure` makes of it. restrictions : what it cannot show, in words.
    axes_asked : whether there was enough motion to ask how its axes are read. signs_sure : whether no other signs would
        fit a little better. zero_told : whether the restrictions tell a joint that counts from another zero.
    """

    measured: Measured
    restrictions: list[str]
    axes_asked: bool
    signs_sure: bool
    zero_told: bool


def checked(recording: Recording, robot: Robot) -> Checked:
    """Return a recording with its derivatives and restrictions.

    Raises
    ------
    Refused : with the first reason why the recording cannot belong to the robot as it stands; see the checks.
    """
    name = f"data set '{recording.name}'"
    check_derivatives(recording, recording.trajectory, name)
    check_rows_are_new(recording, recording.trajectory, name)
    restrictions = [*unusual_parameters(robot), *check_recording(recording, robot)]
    check_reach(recording.position, robot, name)
    check_rows_follow(recording)
    check_rate(recording, name)
    measured = moving_torques(recording)
    restrictions += [*jumps_in_words(measured.jumped), *spikes_in_words(measured.spiked), *silence_in_words(measured)]
    check_columns_differ(measured, robot, name, records=True)
    check_torques_are_new(recording, measured, recording.trajectory, name, records=True)
    check_torque_has_sign(recording.torque, measured, robot, name)
    thin = thinned(measured)
    check_position_unit(thin, robot, name, recording.units.get("position", ""))
    check_units_alike(thin, robot, name, recording.units.get("position", ""))
    # A torque in another unit looks like that of a motor or of another joint, which is asked next.
    factors = torque_factors(recording, robot, measured)
    restrictions += check_scale(factors)
    stated = Stated(recording.units, recording.factors)
    check_mounting(name, robot, thin.parts, thin.usable, stated)
    check_time_scale(name, robot, thin.parts, thin.usable)
    signs = signs_of(robot, measured)
    axes_asked = check_axes_and_zero(name, robot, measured, stated, signs)
    doubts = signs_in_doubt(robot, measured, signs, stated)
    restrictions += [*([] if axes_asked else [UNASKED]), *doubts]
    check_scale_of_one(factors)
    check_model_size(measured, robot, name, behind_gears=recording.torque_kind == "link_sensor")
    check_follows(measured, robot, name)
    # Parameters that are somewhat wrong leave no more than a right file does: nothing asks for another zero then.
    zero = zero_in_words(measured, robot, RIGHT)
    restrictions += zero or left_in_words(measured, robot)
    restrictions += [*check_delay(measured, robot, name), *clipped_torques(recording)]
    return Checked(measured, restrictions, axes_asked, not doubts, bool(zero))
