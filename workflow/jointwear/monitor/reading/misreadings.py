"""What else may be wrong where a first log contradicts the model: a load, a scale of the torque, degrees.

An axis turned around or two exchanged are looked for as discovery does. What it believes is looked at again, because
other causes resemble it: a load at the flange that the robot file does not have, a torque in another unit or as a
current, and positions in degrees. The cause that leaves least of the torque is told, with the key that mends it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from jointwear.measurement.checks.mounting import check_mounting
from jointwear.measurement.checks.position_unit import better_unit, check_reach, left_as_read, refusal_of
from jointwear.measurement.checks.time_scale import check_time_scale, keeps_time
from jointwear.measurement.checks.torque_scale import WrongScale, a_load_explains, check_size, thinned, wrong_scale
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.measurement.stated import Stated
from jointwear.monitor.reading.carried import LoadsOnMotion, least_mass, with_loads
from jointwear.monitor.reading.load_groups import together
from jointwear.monitor.reading.model import TorqueModel
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot

#: Share of the squared torque, a median over the axes, that reading degrees may leave, and that rad leaves at least.
DEGREES_LEFT, RADIANS_LEFT = 0.05, 0.3
#: Factor by which revolutions must leave less of two axes than rad.
FAR_LESS = 10.0
#: Share of the positions whose largest counts, and times the limit of its joint that it may be as revolutions.
NEARLY_ALL, WITHIN = 0.99, 1.1


def check_readings(
    measured: Measured,
    robot: Robot,
    check: Callable[[Measured], None],
    name: str,
    stated: Stated | None = None,
) -> None:
    """Check how the axes of a first log are read.

    Parameters
    ----------
    check : raises :class:`Refused` where samples look turned around, exchanged, or of the motor's side.
    stated : what the configuration says already, default nothing.

    Raises
    ------
    Refused : with the cause that leaves least of the torque.
    """
    thin = thinned(measured)
    check_reach(thin.position, robot, name)
    given = stated or Stated()
    units = given.units
    scale = wrong_scale(thin, robot, units.get("torque", "N m"), given.factors.get("torque_constant", ()))
    read_as = units.get("position", "rad")
    unit = _read_as_rad(thin, robot) if read_as == "rad" else better_unit(thin, robot, read_as)
    if unit is not None and (scale is None or unit[1] < scale.left):
        raise refusal_of(name, unit[0], read_as)
    if scale is None:
        check_mounting(name, robot, thin.parts, thin.usable, given)
        _check_clock(measured, robot, name)
    loaded = False
    if scale is not None and not scale.unit:
        scale = _or_a_load(scale, measured, robot)
        loaded = a_load_explains(thin, robot, units.get("torque", "N m"))
    try:
        check(measured)
    except Refused as refusal:
        lighter = without_load(measured, robot)
        # What a load does to the torques of a light arm looks like other axes too; without it nothing is left to mend.
        saved = loaded and lighter is not None and wrong_scale(thinned(lighter), robot) is None
        if scale is not None and not saved and "motor" not in refusal.readings:
            raise Refused(f"{name}: {scale.reason}", scale.remedy, by_keys=True) from None
        if lighter is None:
            raise
        check(lighter)
    # A heavy load multiplies the bodies of a wrist: a log is not refused for a load that nobody has to state.
    if scale is not None and not loaded:
        raise Refused(f"{name}: {scale.reason}", scale.remedy, by_keys=True)
    check_size(thin, robot, name)


def _check_clock(measured: Measured, robot: Robot, name: str) -> None:
    """Check that time passed as fast as the log says.

    A part that is carried on some moves changes inertial torques as another clock does: the clock is right where it is
    without the load that shows.

    Raises
    ------
    Refused : with the factor by which time runs too fast or too slow.
    """
    thin = thinned(measured)
    try:
        check_time_scale(name, robot, thin.parts, thin.usable)
    except Refused:
        lighter = without_load(measured, robot)
        if lighter is None or not keeps_time(robot, thinned(lighter).parts, thinned(lighter).usable):
            raise


def _or_a_load(scale: WrongScale, measured: Measured, robot: Robot) -> WrongScale:
    """Return a wrong scale with the load at the flange as another cause, where one takes it away.

    A heavy load multiplies the bodies of all axes, as a current does; which it is only the user knows.
    """
    lighter = without_load(measured, robot)
    if lighter is None or wrong_scale(thinned(lighter), robot) is not None:
        return scale
    reason = f"{scale.reason}; or the robot carries a load that its file does not have"
    remedy = f"give the load as 'payload' of the robot file where it carries one; else {scale.remedy}"
    return replace(scale, reason=reason, remedy=remedy)


def _read_as_rad(measured: Measured, robot: Robot) -> tuple[str, float] | None:
    """Return the unit that positions read as rad seem to have, and what it leaves of the torque; None if rad fits."""
    degrees, turns = left_in_degrees(measured, robot), left_in_turns(measured, robot)
    if degrees is not None:
        return "deg", degrees
    return None if turns is None else ("rev", turns)


def left_in_degrees(measured: Measured, robot: Robot) -> float | None:
    """Return the share of the squared torque that the motion read as degrees leaves, a median over the axes; None where
    it fits no better than rad, or the positions are too small to tell."""
    if np.abs(measured.position).max(initial=0.0) < 1.0:
        return None
    rad = left_as_read(measured, robot)
    if not np.isfinite(rad).any() or np.nanmedian(rad) < RADIANS_LEFT:
        return None
    degrees = left_as_read(measured, robot, np.pi / 180)
    return float(np.nanmedian(degrees)) if np.nanmedian(degrees) < DEGREES_LEFT else None


def left_in_turns(measured: Measured, robot: Robot) -> float | None:
    """Return the share of the squared torque that the motion read as revolutions leaves, a median over the axes; None
    where it leaves much of any axis, leads out of the limits of a joint, or fits not far better than rad.

    Most of the torque of a slow axis is friction, which tells nothing of the unit: two axes have to.
    """
    reach = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    if np.any(2 * np.pi * np.quantile(np.abs(measured.position), NEARLY_ALL, axis=0) > WITHIN * reach):
        return None
    rad = left_as_read(measured, robot)
    if not np.isfinite(rad).any() or np.nanmax(rad) < RADIANS_LEFT:
        return None
    turns = left_as_read(measured, robot, 2 * np.pi)
    if np.nanmax(turns) > DEGREES_LEFT:
        return None
    return float(np.nanmedian(turns)) if np.sum(rad > FAR_LESS * turns) >= 2 else None


def without_load(measured: Measured, robot: Robot) -> Measured | None:
    """Return samples with the torque of the load at the flange that they show taken off; None where they show none."""
    q, v, a = measured.position, measured.velocity, measured.acceleration
    steps = np.diff(measured.time)[np.diff(measured.trajectory) == 0]
    if not len(steps) or not np.median(steps) > 0:
        return None
    model = TorqueModel(robot)(q, v, a)
    cuts = [0, *(np.flatnonzero(np.diff(measured.trajectory)) + 1).tolist(), len(q)]
    pieces = [slice(begin, end) for begin, end in pairwise(cuts)]
    groups = together(pieces, np.zeros(len(q)), measured.trajectory, float(np.median(steps)))
    residual = np.nan_to_num(measured.torque - model.total)
    loads, least = LoadsOnMotion(FlangeLoad(robot), q, v, a), least_mass(robot)
    loaded, clear = with_loads(model, residual, v, measured.usable, groups, float(np.median(steps)), loads, least)
    torque = loaded.total - model.total
    if not torque.any():
        return None
    return replace(measured, torque=measured.torque - torque, usable=measured.usable & clear)
