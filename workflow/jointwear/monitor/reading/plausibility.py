"""Does the first log belong to the robot: degrees, swapped joints, flipped signs, torque of the motor side.

It is checked as discovery checks a recording. Later logs are compared with it: :mod:`.later_check`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jointwear.measurement.checks.axes_check import explained
from jointwear.measurement.checks.checks import check_recording
from jointwear.measurement.checks.clipped_torque import at_limit
from jointwear.measurement.checks.copied_columns import check_columns_differ
from jointwear.measurement.checks.derivative_checks import check_derivatives
from jointwear.measurement.checks.held_rows import check_rows_are_new, check_torques_are_new
from jointwear.measurement.checks.late_torque import check_delay
from jointwear.measurement.checks.other_zero import check_axes_and_zero
from jointwear.measurement.checks.silent_joints import check_torque_moves
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.checks.unsigned_torque import check_torque_has_sign
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.stated import Stated
from jointwear.measurement.turns import turns_on
from jointwear.monitor.reading.accumulate import moving
from jointwear.monitor.reading.derivation import Motion
from jointwear.monitor.reading.misfit import Misfit, misfit_of
from jointwear.monitor.reading.misreadings import check_readings
from jointwear.monitor.reading.other_time import at_its_rate
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Samples that a check looks at, in one piece: enough motion, quickly checked.
LOOK = 6000
#: Share, as a median over the axes, above which the model and the torque have nothing to do with each other: expecting
#: none would be better. Fewest axes that this may rest on.
MOST_LEFT, FEWEST_AXES = 1.0, 3
#: Multiple of the limits up to which a joint that turns on and on is believed: beyond lies a value gone wrong.
TURNS = 4.0
#: How far [rad] beyond its limits a position is still believed.
MARGIN = 0.5


def check_first(
    chunk: Chunk, stretch: np.ndarray, motion: Motion, robot: Robot, dead_band: np.ndarray, name: str
) -> tuple[list[float | None], Misfit]:
    """Check the first log; return for each axis the share of its squared torque that the model leaves, or None, and
    what of that a right robot file would not leave.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to. motion : along the samples.
    dead_band : (n,) [rad/s]. name : of the log, for messages.

    Raises
    ------
    Refused : names the axis and what it looks like, with a suggestion.
    """
    measured = busiest_piece(chunk, stretch, motion, dead_band)
    if len(measured.time) < FEWEST_OF_JOINT:
        return [None] * robot.joints, Misfit()
    check_units(measured, robot, name, chunk.units)
    stated = Stated(chunk.units, chunk.factors)
    check_derivatives(chunk, stretch, name)
    check_rows_are_new(chunk, stretch, name)
    check_columns_differ(measured, robot, name)
    check_torques_are_new(chunk, measured, stretch, name)
    if np.isfinite(measured.torque).any(axis=0).all():
        check_torque_moves(measured, name)
        check_torque_has_sign(measured.torque, measured, robot, name)
        check_delay(at_its_rate(measured), robot, name)
        check_readings(
            measured,
            robot,
            lambda samples: _as_discovery(samples, robot, name, samples, stated),
            name,
            stated,
        )
    thin = thinned(measured)
    left = explained(Dynamics(robot), thin.parts, thin.usable)
    known = left[np.isfinite(left)]
    if len(known) >= FEWEST_AXES and np.median(known) > MOST_LEFT:
        raise Refused(
            f"{name}: the model explains nothing of the torque of most axes (it leaves {np.median(known):.3g} times "
            "the squared torque); it looks like a current, a share of a rating or another unit",
            "give 'torque_constant' in N m/A, 'scale', or 'units: {torque: ...}', or another robot file",
            by_keys=True,
        )
    return [float(x) if np.isfinite(x) else None for x in left], misfit_of(measured, robot, left)


def busiest_piece(chunk: Chunk, stretch: np.ndarray, motion: Motion, dead_band: np.ndarray) -> Measured:
    """Return the busiest piece with its motion, as discovery takes it."""
    chosen = _busiest(motion.velocity * motion.usable, LOOK)
    usable = in_motion(chunk, stretch, motion, dead_band) & ~at_limit(chunk.torque, chunk.position, stretch)[0]
    return measured_in(chunk, stretch, motion, usable, dead_band, chosen)


def in_motion(chunk: Chunk, stretch: np.ndarray, motion: Motion, dead_band: np.ndarray) -> np.ndarray:
    """Return the samples (m, n) of joints that move, with a torque."""
    return motion.usable & moving(motion.velocity, stretch, dead_band, 1) & np.isfinite(chunk.torque)


def measured_in(
    chunk: Chunk,
    stretch: np.ndarray,
    motion: Motion,
    usable: np.ndarray,
    dead_band: np.ndarray,
    chosen: slice = slice(None),
) -> Measured:
    """Return chosen samples of a chunk with their motion, as discovery takes them; `usable` (m, n) of all samples."""
    n = usable.shape[1]
    return Measured(
        time=chunk.time[chosen],
        trajectory=stretch[chosen],
        position=motion.position[chosen],
        velocity=motion.velocity[chosen],
        acceleration=motion.acceleration[chosen],
        torque=chunk.torque[chosen],
        temperature=np.full((len(stretch[chosen]), n), np.nan),
        usable=usable[chosen],
        cutoff=np.full(n, np.nan),
        rate=1.0,
        speed_floor=dead_band,
    )


def check_units(measured: Measured, robot: Robot, name: str, units: Mapping[str, str]) -> None:
    """Check what was measured as discovery does, without the model.

    Raises
    ------
    Refused : where positions, times or torques are in another unit, or cannot be.
    """
    _as_discovery(measured, robot, name, measured.part(slice(0)), Stated(units))


def _as_discovery(measured: Measured, robot: Robot, name: str, against: Measured, stated: Stated) -> None:
    """Check what was measured as discovery does, comparing `against` with the model.

    Raises
    ------
    Refused : as :func:`check_units`, and for axes that are exchanged, turned or counted from another zero.
    """
    recording = Recording(
        time=measured.time,
        trajectory=measured.trajectory,
        position=measured.position,
        torque=np.nan_to_num(measured.torque),
        name=name,
        units=stated.units,
    )
    try:
        check_recording(recording, robot)
    except Refused as refusal:
        told = str(refusal).replace(f"data set '{name}'", name, 1)
        raise Refused(told, refusal.suggestion, refusal.by_keys, refusal.readings) from None
    check_axes_and_zero(name, robot, against, stated)


def _busiest(velocity: np.ndarray, most: int) -> slice:
    """Return the `most` samples in a row in which the axes move most, each measured by its own usual speed."""
    if len(velocity) <= most:
        return slice(0, len(velocity))
    speed = np.abs(velocity)
    usual = np.maximum(speed.mean(axis=0), 1e-9)
    total = np.cumsum(np.concatenate([[0.0], (speed / usual).sum(axis=1)]))
    start = int(np.argmax(total[most:] - total[:-most]))
    return slice(start, start + most)


def outside_limits(position: np.ndarray, robot: Robot) -> np.ndarray:
    """Return where positions lie further than :data:`MARGIN` outside the limits of the joint, (m, n).

    A joint that may turn on beyond its limits is given :data:`TURNS` times their width.
    """
    wider = np.where(turns_on(robot), TURNS, 1.0)
    with np.errstate(invalid="ignore"):
        return (position < wider * robot.lower - MARGIN) | (position > wider * robot.upper + MARGIN)
