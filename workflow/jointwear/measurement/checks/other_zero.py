"""A joint that counts from a zero a few degrees off, as an encoder does that was mounted or taught anew.

Readings of the axes ask for quarter turns, which conventions differ by. A smaller angle fits torques that are wrong by
less, and so do wrong centres of mass: it refuses nothing, and is told where the torque stays unexplained without it.
"""

from __future__ import annotations

import numpy as np

from jointwear.measurement.checks.axes_check import FAVOURS, RIGHT, explained
from jointwear.measurement.checks.axis_readings import Likelihood, Reading
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Largest angle [rad] that is looked for, half of the step to the next convention, and how closely it is found.
LARGEST, CLOSELY = 0.25 * np.pi, np.radians(0.1)


def zero_in_words(measured: Measured, robot: Robot) -> list[str]:
    """Return in words which joint seems to count from another zero, nothing where none does.

    The angle has to be as much likelier than none as a quarter turn has to be, and to leave of no axis more than a
    right reading does: of a hose or the wind an angle explains a part.
    """
    from scipy.optimize import minimize_scalar

    thin, dynamics = thinned(measured), Dynamics(robot)
    parts, usable = thin.parts, thin.usable
    likelihood = Likelihood(dynamics, FEWEST_OF_JOINT)

    def unlikely(angle: float, axis: int) -> float:
        return -likelihood(*Reading("zero", (axis,), angle).read(parts, usable, robot))

    bounds, found = (-LARGEST, LARGEST), []
    for axis in range(robot.joints):
        best = minimize_scalar(unlikely, bounds=bounds, args=(axis,), method="bounded", options={"xatol": CLOSELY})
        found.append((-float(best.fun), Reading("zero", (axis,), float(best.x))))
    nats, reading = max(found, key=lambda one: one[0])
    if nats - likelihood(parts, usable) < FAVOURS["zero"]:
        return []
    if not np.nanmax(explained(dynamics, *reading.read(parts, usable, robot)), initial=0.0) < RIGHT:
        return []
    return [f"{reading.reason}: {reading.remedy} if so"]
