"""A joint that counts from a zero a few degrees off, as an encoder does that was mounted or taught anew.

Readings of the axes ask for quarter turns, which conventions differ by. A smaller angle fits torques that are wrong by
less, and so do wrong centres of mass: it refuses nothing by itself, and is told where the torque stays unexplained
without it. What it does to the joints behind looks like other axes, too: where these would refuse, it is the reason.
"""

from __future__ import annotations

import numpy as np

from jointwear.measurement.checks.axes_check import FAVOURS, RIGHT, check_axes, explained
from jointwear.measurement.checks.axis_readings import Likelihood, Reading
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.checks.turned_signs import Nats
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.stated import Stated
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Largest angle [rad] that is looked for, half of the step to the next convention, and how closely it is found.
LARGEST, CLOSELY = 0.25 * np.pi, np.radians(0.1)


def other_zero(measured: Measured, robot: Robot, least: float = 0.0) -> Reading | None:
    """Return the reading of the joint that seems to count from another zero, None where none does.

    The angle has to be as much likelier than none as a quarter turn has to be, and to leave of no axis more than a
    right reading does: of a hose or the wind an angle explains a part.

    Parameters
    ----------
    least : share of the squared torque of some joint that the model has to leave as it is, for anything to be asked.
    """
    from scipy.optimize import minimize_scalar

    thin, dynamics = thinned(measured), Dynamics(robot)
    parts, usable = thin.parts, thin.usable
    if np.nanmax(explained(dynamics, parts, usable), initial=0.0) < least:
        return None
    likelihood = Likelihood(dynamics, FEWEST_OF_JOINT)

    def unlikely(angle: float, axis: int) -> float:
        return -likelihood(*Reading("zero", (axis,), angle).read(parts, usable, robot))

    bounds, found = (-LARGEST, LARGEST), []
    for axis in range(robot.joints):
        best = minimize_scalar(unlikely, bounds=bounds, args=(axis,), method="bounded", options={"xatol": CLOSELY})
        found.append((-float(best.fun), Reading("zero", (axis,), float(best.x))))
    nats, reading = max(found, key=lambda one: one[0])
    if nats - likelihood(parts, usable) < FAVOURS["zero"]:
        return None
    if not np.nanmax(explained(dynamics, *reading.read(parts, usable, robot)), initial=0.0) < RIGHT:
        return None
    return reading


def zero_in_words(measured: Measured, robot: Robot, least: float = 0.0) -> list[str]:
    """Return :func:`other_zero` in words, nothing where there is none."""
    reading = other_zero(measured, robot, least)
    return [] if reading is None else [f"{reading.reason}: {reading.remedy} if so"]


def check_axes_and_zero(
    name: str, robot: Robot, measured: Measured, stated: Stated | None = None, signs: Nats | None = None
) -> bool:
    """Check the axes as :func:`check_axes` does, which returns whether there was enough motion to ask.

    Raises
    ------
    Refused : as there; for another zero where one explains all joints, which no exchange or sign of others does beside
        it.
    """
    try:
        return check_axes(name, robot, measured, stated, signs)
    except Refused:
        reading = other_zero(measured, robot)
        if reading is None:
            raise
        reason = f"{name}: {reading.reason}; from there it fits the model"
        raise Refused(reason, reading.remedy, by_keys=True, readings=[reading.kind]) from None
