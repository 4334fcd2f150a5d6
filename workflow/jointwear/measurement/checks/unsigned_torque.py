"""Torques of which only the size was recorded: a joint pushes one way, whichever way it has to push."""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import numbered
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: By how much the size of the torque of one joint alone must go more closely with that of the model than its torque
#: with the model, as correlations: a preload that the file lacks keeps a torque on one side too. Of 508 torques of 81
#: plants of the tiers (drawing 1300) none keeps one side; without their sign three in four come to that, 0.78 in the
#: median.
OF_ONE = 0.5


def check_torque_has_sign(logged: np.ndarray, measured: Measured, robot: Robot, name: str) -> None:
    """Check that torques were recorded with their sign.

    They were not where no joint that moves ever pushes both ways, and the sizes of the torques go with those of the
    model more closely than the torques with the model, in the mean over the joints whose model needs both signs; nor
    that of one joint where this is far so, :data:`OF_ONE`, though others push both ways. A preload of a spring or a
    weight keeps a torque on one side too, but then the torque goes with the model itself.

    Parameters
    ----------
    logged : (m, n) torques as they were recorded, before any filter, which may swing through zero.

    Raises
    ------
    Refused : where only sizes were recorded, with the joints that need both signs.
    """
    moving = np.flatnonzero(measured.usable.sum(axis=0) >= FEWEST_OF_JOINT)
    known = np.where(np.isfinite(logged), logged, 0.0)[:, moving]
    one_sided = moving[(known.min(axis=0, initial=0.0) >= 0) | (known.max(axis=0, initial=0.0) <= 0)]
    if not len(one_sided):
        return
    # Friction of the file is in the model: it is what turns the sign of a wrist.
    model = Dynamics(robot).inverse_dynamics(measured.position, measured.velocity, measured.acceleration)
    signed, sizes = {}, {}
    for j in one_sided:
        used = measured.usable[:, j]
        torque, of_model = measured.torque[used, j], model[used, j]
        if np.ptp(np.sign(of_model)) == 2.0:
            signed[int(j) + 1] = _goes_with(torque, of_model)
            sizes[int(j) + 1] = _goes_with(np.abs(torque), np.abs(of_model))
    if len(one_sided) == len(moving) and sum(sizes.values()) > sum(signed.values()):
        raise _refusal(name, robot, list(signed), "no torque changes its sign")
    # A torque that is turned around goes with the model too.
    alone = [joint for joint, size in sizes.items() if size - abs(signed[joint]) > OF_ONE]
    if alone:
        raise _refusal(name, robot, alone, f"the torque of {numbered('joint', alone)} keeps its sign")


def _refusal(name: str, robot: Robot, joints: list[int], seen: str) -> Refused:
    """Return the refusal of torques of 1-based joints that were recorded without their sign; `seen`: what shows it."""
    its, it_was, size_goes = ("their", "they were", "sizes go") if len(joints) > 1 else ("its", "it was", "size goes")
    return Refused(
        f"{name}: {seen}, though {numbered('joint', joints)} of robot '{robot.name}' must push both ways, and {its} "
        f"{size_goes} with the model's: {it_was} recorded without {its} sign",
        "record torques, or currents, with their sign",
    )


def _goes_with(torque: np.ndarray, other: np.ndarray) -> float:
    """Return the correlation of two series (m,), 0 where one of them keeps one value."""
    if np.ptp(torque) == 0.0 or np.ptp(other) == 0.0:
        return 0.0
    return float(np.corrcoef(torque, other)[0, 1])
