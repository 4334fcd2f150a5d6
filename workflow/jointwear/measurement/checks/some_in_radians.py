"""Some joints in radians among others in degrees: stated as degrees all of them lie within their limits.

Friction does not tell it: where it is not known how it rises from rest, that of a joint which moves by a degree is as
well that of one which moves by a radian. What the bodies do to each other does: a joint moves the load of those before
it, so that the torque of two axes or more fits far better.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from jointwear.files.wording import numbered
from jointwear.measurement.checks.position_unit import (
    RIGHT,
    farthest_positions,
    fits_far_better,
    largest_positions,
    left_as_read,
    unlikely,
)
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.measurement.units import POSITION_WORDS, size_of
from jointwear.robots.robot import Robot


def joints_in_radians(measured: Measured, robot: Robot, stated: str) -> tuple[int, ...]:
    """Return the joints, 0-based, whose positions look like radians among others in the stated unit; empty where none
    do.

    Parameters
    ----------
    measured : samples, thinned, read in the unit `stated`, a key of the units of a position. Of one that is no smaller
        than a radian nothing is asked.
    """
    factor = 1.0 / size_of("position", stated)
    if factor <= 1.0:
        return ()
    as_read: np.ndarray | None = None
    found: list[tuple[float, tuple[int, ...]]] = []
    for joints in _possible(largest_positions(measured), factor, robot):
        as_read = left_as_read(measured, robot) if as_read is None else as_read
        left = left_as_read(measured, robot, np.where(np.isin(np.arange(robot.joints), joints), factor, 1.0))
        if fits_far_better(left, as_read) and np.nanmedian(left) < RIGHT:
            found.append((unlikely(left), joints))
    return min(found)[1] if found else ()


def _possible(largest: np.ndarray, factor: float, robot: Robot) -> Iterator[tuple[int, ...]]:
    """Yield the joints, one by one and all together, that stay within their limits in the larger unit.

    Where all that move do, one key is wrong and no joint is odd: that is asked of the unit as a whole.
    """
    moved = largest > 0
    joints = np.flatnonzero(moved & (factor * largest <= farthest_positions(robot))).tolist()
    if len(joints) == moved.sum():
        return
    yield from ((joint,) for joint in joints)
    if len(joints) > 1:
        yield tuple(joints)


def check_units_alike(measured: Measured, robot: Robot, name: str, stated: str) -> None:
    """Check that no joints are in radians where the others are in the stated unit; see :func:`joints_in_radians`.

    Raises
    ------
    Refused : with these joints. No key has a unit for each of them.
    """
    joints = joints_in_radians(measured, robot, stated or "rad")
    if not joints:
        return
    named, what = numbered("joint", [j + 1 for j in joints]), f"radians taken for {POSITION_WORDS.get(stated, stated)}"
    one = len(joints) == 1
    where = f"{'position' if one else 'positions'} of {named}"
    raise Refused(
        f"{name}: the {where} {'looks' if one else 'look'} like {what}, those of the others do not; read so "
        f"{'it fits' if one else 'they fit'} the model",
        f"write the {where} in the unit of the others: {'it is' if one else 'they are'} {what} as read",
        readings=["unit"],
    )
