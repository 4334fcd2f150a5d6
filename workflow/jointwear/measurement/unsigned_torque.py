"""Torques of which only the size was recorded: no joint pushes both ways, whichever way it has to push."""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import numbered
from jointwear.measurement.motion import Measured
from jointwear.measurement.refused import FEWEST, Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot


def check_torque_has_sign(logged: np.ndarray, measured: Measured, robot: Robot, name: str) -> None:
    """Check that torques were recorded with their sign.

    They were not where no joint that moves ever pushes both ways, and the sizes of the torques go with those of the
    model more closely than the torques with the model, in the mean over the joints whose model needs both signs. A
    preload of a spring or a weight keeps a torque on one side too, but then the torque goes with the model itself.

    Parameters
    ----------
    logged : (m, n) torques as they were recorded, before any filter, which may swing through zero.

    Raises
    ------
    Refused : where only sizes were recorded, with the joints that need both signs.
    """
    moving = np.flatnonzero(measured.usable.sum(axis=0) >= FEWEST)
    known = np.where(np.isfinite(logged), logged, 0.0)[:, moving]
    if not len(moving) or np.any((known.min(axis=0) < 0) & (known.max(axis=0) > 0)):
        return
    # Friction of the file is in the model: it is what turns the sign of a wrist.
    model = Dynamics(robot).inverse_dynamics(measured.position, measured.velocity, measured.acceleration)
    both = [j for j in moving if np.ptp(np.sign(model[measured.usable[:, j], j])) == 2.0]
    closer = 0.0
    for j in both:
        used = measured.usable[:, j]
        torque, of_model = measured.torque[used, j], model[used, j]
        closer += _goes_with(np.abs(torque), np.abs(of_model)) - _goes_with(torque, of_model)
    if closer > 0:
        raise Refused(
            f"{name}: no torque changes its sign, though {numbered('joint', np.array(both) + 1)} of robot "
            f"'{robot.name}' must push both ways, and their sizes go with those of the model: they were recorded "
            "without their sign",
            "record torques, or currents, with their sign",
        )


def _goes_with(torque: np.ndarray, other: np.ndarray) -> float:
    """Return the correlation of two series (m,), 0 where one of them keeps one value."""
    if np.ptp(torque) == 0.0 or np.ptp(other) == 0.0:
        return 0.0
    return float(np.corrcoef(torque, other)[0, 1])
