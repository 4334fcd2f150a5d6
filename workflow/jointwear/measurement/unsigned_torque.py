"""Torques of which only the size was recorded: no joint has a negative one, whichever way it has to push."""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import numbered
from jointwear.measurement.checks import FEWEST, Refused
from jointwear.measurement.motion import Measured
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot


def check_torque_has_sign(measured: Measured, robot: Robot, name: str) -> None:
    """Check that torques were recorded with their sign.

    They were not where no joint that moves has a negative torque, and on every joint whose model needs both signs the
    size of the model goes with the torque more closely than the model does. A preload of a spring or a weight keeps a
    torque on one side too, but then the torque goes with the model itself.

    Raises
    ------
    Refused : where only sizes were recorded, with the joints that need both signs.
    """
    moving = np.flatnonzero(measured.usable.sum(axis=0) >= FEWEST)
    if not len(moving) or np.nanmin(measured.torque[:, moving]) < 0:
        return
    q, v, a = measured.position, measured.velocity, measured.acceleration
    # Friction of the file is in the model: it is what turns the sign of a wrist.
    model = Dynamics(robot).rigid_body_torque(q, v, a) + robot.viscous * v + robot.coulomb(v)
    both = [j for j in moving if np.ptp(np.sign(model[measured.usable[:, j], j])) == 2.0]
    for j in both:
        used = measured.usable[:, j]
        torque, of_model = measured.torque[used, j], model[used, j]
        if not _goes_with(torque, np.abs(of_model)) > _goes_with(torque, of_model):
            return
    if both:
        raise Refused(
            f"{name}: no torque is negative, though {numbered('joint', np.array(both) + 1)} of robot '{robot.name}' "
            "must push both ways, and the torques go with the size of those of the model: they were recorded "
            "without their sign",
            "record torques, or currents, with their sign",
        )


def _goes_with(torque: np.ndarray, other: np.ndarray) -> float:
    """Return the correlation of two series (m,), 0 where one of them keeps one value."""
    if np.ptp(torque) == 0.0 or np.ptp(other) == 0.0:
        return 0.0
    return float(np.corrcoef(torque, other)[0, 1])
