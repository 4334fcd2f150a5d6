"""Positions whose stated unit is not theirs: radians read as degrees make a motion too small for its torque."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.checks.axes_check import explained
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.measurement.turns import turns_on
from jointwear.measurement.units import POSITION_WORDS, size_of, sizes_of
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Share of the squared torque, a median over the axes, that the right unit may leave. The right one of measured arms
#: leaves 0.09 (Kinova) and 0.007 (Staubli).
RIGHT = 0.15
#: Share below which no unit is better than another.
LEAST = 1e-3
#: Factor by which the right unit must leave less, and axes of which it must: most of the torque of a slow axis is
#: friction, which tells nothing of the unit. Radians read as degrees leave 5 and 6 times as much (Kinova), 12 and 16
#: (Staubli).
FAR_LESS, TELLING = 4.0, 2
#: Share of the samples that must lie within the limits in the right unit, and how far beyond these may reach.
NEARLY_ALL, BEYOND = 0.99, 1.1
#: Multiple of the reach of a joint that no position can have.
NONE_BEYOND = 4.0


def check_reach(position: np.ndarray, robot: Robot, name: str) -> None:
    """Check that positions (m, n) [rad] lie somewhere near the limits of their joints.

    Raises
    ------
    Refused : where those of most joints go far beyond.
    """
    reach = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    largest = np.nanmax(np.abs(position), axis=0, initial=0.0)
    over = largest > NONE_BEYOND * reach
    if over.mean() > 0.5:
        axis = int(np.argmax(np.where(over, largest / np.where(over, reach, 1.0), 0.0)))
        raise Refused(
            f"{name}: positions of joint {axis + 1} reach {largest[axis]:.4g}, its limits are "
            f"{robot.lower[axis]:.3g} to {robot.upper[axis]:.3g} rad; they are in another unit, or another quantity",
            "state units: {position: deg} where they are degrees, or name the right columns under 'variables'; counts "
            "of an encoder have to be written as angles",
            by_keys=True,
        )


def left_as_read(measured: Measured, robot: Robot, unit: float | np.ndarray = 1.0) -> np.ndarray:
    """Return the share of the squared torque of each axis (n,) that the motion in a unit [rad] leaves; or in one for
    each joint, (n,)."""
    motion = [unit * x for x in (measured.position, measured.velocity, measured.acceleration)]
    return explained(Dynamics(robot), np.stack([*motion, np.nan_to_num(measured.torque)], axis=1), measured.usable)


def largest_positions(measured: Measured) -> np.ndarray:
    """Return the size of the position of each axis (n,) that nearly all samples keep to."""
    if not len(measured.position):
        return np.zeros(measured.position.shape[1])
    return np.quantile(np.nan_to_num(np.abs(measured.position)), NEARLY_ALL, axis=0)


def fits_far_better(left: np.ndarray, as_read: np.ndarray) -> bool:
    """Return whether a reading that leaves shares (n,) fits far better than one that leaves `as_read` (n,)."""
    return bool(np.sum(as_read > FAR_LESS * left) >= TELLING and not np.any(left > FAR_LESS * as_read))


def unlikely(left: np.ndarray) -> float:
    """Return what readings that leave shares (n,) are compared by: axes that friction turns fit in any unit, and what
    all leave together tells the right one."""
    return float(np.nansum(np.log(np.maximum(left, LEAST))))


def farthest_positions(robot: Robot) -> np.ndarray:
    """Return how far from zero positions (n,) [rad] can be, infinite where a joint turns on."""
    return np.where(turns_on(robot), np.inf, BEYOND * np.maximum(np.abs(robot.lower), np.abs(robot.upper)))


def better_unit(measured: Measured, robot: Robot, stated: str) -> tuple[str, float] | None:
    """Return the unit that the positions look like in place of the stated one, and the share of the squared torque that
    it leaves, a median over the axes; None where none fits far better.

    Parameters
    ----------
    measured : samples, thinned, read in the unit `stated`, a key of the units of a position.
    """
    sizes = sizes_of("position")
    reach = farthest_positions(robot)
    largest = largest_positions(measured)
    as_stated: np.ndarray | None = None
    found: list[tuple[float, str, float]] = []
    for unit, size in sizes.items():
        factor = size / size_of("position", stated)
        if unit == stated or np.any(factor * largest > reach):
            continue
        as_stated = left_as_read(measured, robot) if as_stated is None else as_stated
        if not np.isfinite(as_stated).any():
            return None
        left = left_as_read(measured, robot, factor)
        if fits_far_better(left, as_stated) and np.nanmedian(left) < RIGHT:
            found.append((unlikely(left), unit, float(np.nanmedian(left))))
    return min(found)[1:] if found else None


def refusal_of(name: str, unit: str, stated: str) -> Refused:
    """Return the refusal of positions that look like `unit` and are stated, or read, as `stated`."""
    looks, read = POSITION_WORDS[unit], POSITION_WORDS.get(stated, stated)
    return Refused(
        f"{name}: read as {looks} the positions fit the torque, read as {read} they do not; they look like {looks}",
        f"state units: {{position: {unit}}}",
        by_keys=True,
    )


def check_position_unit(measured: Measured, robot: Robot, name: str, stated: str) -> None:
    """Check that no other unit of the positions than the stated one fits the torque far better.

    What is read as rad, or without a unit, is asked only where a joint lies beyond its limits: degrees are told from
    these, but for a joint that turns on and on.

    Raises
    ------
    Refused : with the unit to state.
    """
    stated = stated or "rad"
    largest = largest_positions(measured)
    if stated == "rad" and not np.any(largest > BEYOND * np.maximum(np.abs(robot.lower), np.abs(robot.upper))):
        return
    found = better_unit(measured, robot, stated)
    if found is not None:
        raise refusal_of(name, found[0], stated)
