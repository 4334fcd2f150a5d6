"""What else may be wrong where a first log contradicts the model: a load, a scale of the torque, degrees.

An axis turned around or two exchanged are looked for as discovery does. What it believes is looked at again, because
other causes resemble it: a load at the flange that the robot file does not have, a torque in another unit or as a
current, and positions in degrees. The cause that leaves least of the torque is told, with the key that mends it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from jointwear.measurement.checks import FEWEST, Refused, explained
from jointwear.measurement.motion import Measured
from jointwear.monitor.carried import LoadsOnMotion, least_mass, with_loads
from jointwear.monitor.model import TorqueModel
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot

#: Factor on the torque of the bodies beyond which it is another unit or a current, and no wrong mass.
FACTOR = 2.0
#: Standard errors by which the factor of an axis must stand out; fewest axes that must have one; share of the squared
#: torque that may be left once it is applied.
CLEAR, FEWEST_AXES, LEFT = 10.0, 2, 0.1
#: Share of the squared torque, a median over the axes, that reading degrees may leave, and that rad leaves at least.
DEGREES_LEFT, RADIANS_LEFT = 0.05, 0.3
#: Factor by which friction may differ from the robot file beside the factor of the torque.
FRICTION = 2.5
#: Multiple of the reach of a joint that no position can have.
BEYOND = 4.0
#: Units of torque that a common factor stands for, and how far (ratio) it may lie from one.
UNITS, ALIKE = {"mN m": 1e3, "kN m": 1e-3}, 1.3
#: Samples that are compared with the model.
THINNED = 1500
#: Ratios of a velocity to the change of position that mean degrees in one of them.
_PER_DEGREE = 180 / np.pi


#: What discovery advises, and the key of the config that does it.
_KEYS = {
    "turn the sign of position and torque": "'sign' with -1 for it",
    "turn the sign of the torque": "'scale' with -1 for it",
    "exchange the columns": "'variables' with the columns in order of the axes",
}


def with_key(suggestion: str) -> str:
    """Return a suggestion with the key of a robot's entry that follows it."""
    key = next((key for words, key in _KEYS.items() if suggestion.startswith(words)), None)
    return suggestion if key is None else f"{suggestion}: {key}"


def velocity_remedy(ratio: float) -> tuple[str, str]:
    """Return what the ratio of a velocity to the change of its position looks like, and the remedy."""
    if 0.8 < ratio / _PER_DEGREE < 1.25:
        return "; it looks like degrees", "state units: {velocity: deg/s}"
    if 0.8 < ratio * _PER_DEGREE < 1.25:
        return "; the positions look like degrees", "state units: {position: deg}"
    return "", "mend the units or the sign of the velocity, or leave it out: it is then derived"


def check_torque_moves(measured: Measured, name: str) -> None:
    """Check that some axis changes its torque while it moves.

    Raises
    ------
    Refused : where none does.
    """
    moving = [measured.torque[measured.usable[:, j], j] for j in range(measured.torque.shape[1])]
    moving = [x for x in moving if len(x) >= FEWEST]
    if moving and all(np.ptp(x) == 0 for x in moving):
        raise Refused(
            f"{name}: the torque keeps one value while the axes move",
            "name the column that holds the torque under 'variables'",
        )


def check_readings(measured: Measured, robot: Robot, check: Callable[[Measured], None], name: str) -> None:
    """Check how the axes of a first log are read.

    Parameters
    ----------
    check : raises :class:`Refused` where samples look turned around, exchanged, or of the motor's side.

    Raises
    ------
    Refused : with the cause that leaves least of the torque.
    """
    thin = _thinned(measured)
    check_reach(thin, robot, name)
    scale, degrees = wrong_scale(thin, robot), left_in_degrees(thin, robot)
    if degrees is not None and (scale is None or degrees < scale.left):
        raise Refused(
            f"{name}: read as degrees the positions fit the torque, read as rad they do not; they look like degrees",
            "state units: {position: deg}",
        )
    if scale is not None and not scale.unit:
        scale = _or_a_load(scale, measured, robot)
    try:
        check(measured)
    except Refused as refusal:
        if scale is not None and "motor" not in refusal.reason:
            raise Refused(f"{name}: {scale.reason}", scale.remedy) from None
        lighter = without_load(measured, robot)
        if lighter is None:
            raise
        check(lighter)
    if scale is not None:
        raise Refused(f"{name}: {scale.reason}", scale.remedy)


def _or_a_load(scale: WrongScale, measured: Measured, robot: Robot) -> WrongScale:
    """Return a wrong scale with the load at the flange as another cause, where one takes it away.

    A heavy load multiplies the bodies of all axes, as a current does; which it is only the user knows.
    """
    lighter = without_load(measured, robot)
    if lighter is None or wrong_scale(_thinned(lighter), robot) is not None:
        return scale
    reason = f"{scale.reason}; or the robot carries a load that its file does not have"
    remedy = f"give the load as 'payload' of the robot file where it carries one; else {scale.remedy}"
    return replace(scale, reason=reason, remedy=remedy)


def _thinned(measured: Measured) -> Measured:
    step = max(1, len(measured.time) // THINNED)
    names = ("time", "trajectory", "position", "velocity", "acceleration", "torque", "temperature", "usable")
    return replace(measured, **{n: getattr(measured, n)[::step] for n in names})


@dataclass(frozen=True)
class WrongScale:
    """The torque of most axes is another multiple of the model's than one; `reason` and `remedy` in words, `left`:
    share of the squared torque that is left once it is applied, a median over the axes; `unit` that it looks like."""

    reason: str
    remedy: str
    left: float
    unit: str = ""


def wrong_scale(measured: Measured, robot: Robot) -> WrongScale | None:
    """Return what the scale of the torque looks like where it is not that of the model, else None.

    Each axis is regressed on the torque of its bodies and friction of free size; its factor counts where it is clear
    and leaves little. A wrong robot file leaves factors near one, or much of the torque.
    """
    rigid = Dynamics(robot).rigid_body_torque(measured.position, measured.velocity, measured.acceleration)
    n = rigid.shape[1]
    factor, left = np.full(n, np.nan), np.full(n, np.nan)
    for j in range(n):
        used = measured.usable[:, j]
        if used.sum() < FEWEST:
            continue
        v, torque = measured.velocity[used, j], measured.torque[used, j]
        design = np.stack([rigid[used, j], np.sign(v), v, np.ones(len(v))], axis=1)
        size = np.maximum(np.sqrt((design**2).mean(axis=0)), 1e-12)
        inverse = np.linalg.pinv((design / size).T @ (design / size), rcond=1e-9)
        fit = inverse @ ((design / size).T @ torque)
        error = torque - (design / size) @ fit
        spread = np.sqrt(max(float(error @ error) / max(len(v) - 4, 1) * inverse[0, 0], 0.0))
        clear = abs(fit[0]) > CLEAR * spread and error @ error < LEFT * float(torque @ torque)
        # A load at the flange multiplies the bodies of a wrist and leaves its friction; a wrong unit scales both.
        nominal = np.abs([robot.coulomb_positive[j], robot.coulomb_negative[j]]).mean()
        rubbed = abs(fit[1] / size[1]) / nominal if nominal > 0 else abs(fit[0] / size[0])
        alike = rubbed > 0 and abs(np.log(rubbed * size[0] / abs(fit[0]))) < np.log(FRICTION)
        if clear and alike:
            factor[j], left[j] = fit[0] / size[0], error @ error / float(torque @ torque)
    known = np.flatnonzero(np.isfinite(factor))
    off = np.abs(np.log(np.abs(factor[known]))) > np.log(FACTOR)
    if len(known) < FEWEST_AXES or off.mean() <= 0.5:
        return None
    middle, remains = float(np.median(np.abs(factor[known]))), float(np.median(left[known]))
    for unit, size in UNITS.items():
        if np.all(np.abs(np.log(np.abs(factor[known]) / size)) < np.log(ALIKE)):
            reason = f"the torque is about {middle:.3g} times that of the model; it looks like {unit}"
            return WrongScale(reason, f"state units: {{torque: {unit}}}", remains, unit)
    told = ", ".join(f"{abs(factor[j]):.3g} on joint {j + 1}" for j in known)
    reason = (
        f"the torque is another multiple of the model's than one ({told}); it looks like a current, a share of a "
        "rating or a torque of the motor's side"
    )
    remedy = (
        "give 'torque_constant' in N m/A on the joint side and 'units: {torque: A}', or 'scale' in N m of one unit, "
        "for each axis (what is read now times about "
        + ", ".join(f"{1 / abs(factor[j]):.3g} for joint {j + 1}" for j in known)
        + ")"
    )
    return WrongScale(reason, remedy, remains)


def left_in_degrees(measured: Measured, robot: Robot) -> float | None:
    """Return the share of the squared torque that the motion read as degrees leaves, a median over the axes; None where
    it fits no better than rad, or the positions are too small to tell."""
    parts = [measured.position, measured.velocity, measured.acceleration, np.nan_to_num(measured.torque)]
    if np.abs(parts[0]).max(initial=0.0) < 1.0:
        return None
    dynamics = Dynamics(robot)
    left = explained(dynamics, np.stack(parts, axis=1), measured.usable)
    if not np.isfinite(left).any() or np.nanmedian(left) < RADIANS_LEFT:
        return None
    turned = [np.radians(x) for x in parts[:3]]
    other = explained(dynamics, np.stack([*turned, parts[3]], axis=1), measured.usable)
    return float(np.nanmedian(other)) if np.nanmedian(other) < DEGREES_LEFT else None


def check_reach(measured: Measured, robot: Robot, name: str) -> None:
    """Check that positions lie somewhere near the limits of their joints.

    Raises
    ------
    Refused : where those of most joints go far beyond.
    """
    reach = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    largest = np.nanmax(np.abs(measured.position), axis=0, initial=0.0)
    over = largest > BEYOND * reach
    if over.mean() > 0.5:
        axis = int(np.argmax(np.where(over, largest / np.where(over, reach, 1.0), 0.0)))
        raise Refused(
            f"{name}: positions of joint {axis + 1} reach {largest[axis]:.4g}, its limits are "
            f"{robot.lower[axis]:.3g} to {robot.upper[axis]:.3g} rad; they are in another unit, or another quantity",
            "state units: {position: deg} where they are degrees, or name the right columns under 'variables'",
        )


def without_load(measured: Measured, robot: Robot) -> Measured | None:
    """Return samples with the torque of the load at the flange that they show taken off; None where they show none."""
    q, v, a = measured.position, measured.velocity, measured.acceleration
    steps = np.diff(measured.time)[np.diff(measured.trajectory) == 0]
    if not len(steps) or not np.median(steps) > 0:
        return None
    model = TorqueModel(robot)(q, v, a)
    cuts = [0, *(np.flatnonzero(np.diff(measured.trajectory)) + 1).tolist(), len(q)]
    pieces = [slice(begin, end) for begin, end in pairwise(cuts)]
    residual = np.nan_to_num(measured.torque - model.total)
    loads, least = LoadsOnMotion(FlangeLoad(robot), q, v, a), least_mass(robot)
    loaded, clear = with_loads(model, residual, v, measured.usable, pieces, float(np.median(steps)), loads, least)
    torque = loaded.total - model.total
    if not torque.any():
        return None
    return replace(measured, torque=measured.torque - torque, usable=measured.usable & clear)
