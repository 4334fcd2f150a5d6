"""What a base that gives way does to the joints of the arm on it: the moments that rock it, and the torques it causes.

The base turns about two directions through its origin, across the axis of the first joint; about that axis it would
turn as the gear of that joint does. It is two more joints before the first (floating-base dynamics: Featherstone 2008,
Rigid Body Dynamics Algorithms, chapter 9).
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad

#: Directions about which a base rocks.
WAYS = 2
#: Angle [rad] over which gravity is differenced.
STEP = 1e-4


class RockingBase:
    """The arm of a robot on a base that turns about two directions.

    Parameters
    ----------
    dynamics : of the robot on a firm base.
    """

    def __init__(self, dynamics: Dynamics) -> None:
        first = FlangeLoad(dynamics.robot).axes(np.zeros((1, dynamics.robot.joints)))[0, 0]
        across = np.linalg.svd(first[None])[2][1:]
        base, parent = pin.Model(), 0
        for way in across:
            joint = pin.JointModelRevoluteUnaligned(np.array(way))
            parent = base.addJoint(parent, joint, pin.SE3.Identity(), f"jointwear/rocks {parent}")
        self._model = _put_on(base, parent, dynamics.model)
        self._model.gravity = dynamics.model.gravity
        self._model.armature = np.concatenate([np.zeros(WAYS), dynamics.robot.armature])
        self._pool = pin.ModelPool(self._model, 1)

    def moments(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Return the moments (m, 2) [N m] about the two directions that hold a firm base along a motion (m, n)."""
        return self._torques(*(_on_base(x) for x in (position, velocity, acceleration)))[:, :WAYS]

    def pulls(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what a turn of the base about each direction asks for in poses (m, n), both (m, 2, 2 + n).

        That is the derivatives of the moments that hold the base and of the torques of the joints by the angular
        acceleration of the base [kg m2] and by its angle [N m/rad].
        """
        pose = _on_base(np.asarray(position, dtype=float))
        still = np.zeros_like(pose)
        held = self._torques(pose, still, still)
        by_acceleration, by_angle = [], []
        for way in range(WAYS):
            turned = still.copy()
            turned[:, way] = 1.0
            by_acceleration.append(self._torques(pose, still, turned) - held)
            by_angle.append((self._torques(pose + STEP * turned, still, still) - held) / STEP)
        return np.stack(by_acceleration, axis=1), np.stack(by_angle, axis=1)

    def _torques(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        torque = np.empty(position.shape)
        columns = [np.ascontiguousarray(x).T for x in (position, velocity, acceleration)]
        pin.rneaInParallel(1, self._pool, *columns, torque.T)
        return torque


def _put_on(base: pin.Model, place: int, arm: pin.Model) -> pin.Model:
    """Return a base with the joints and bodies of an arm on its joint `place`.

    `pin.appendModel` takes frames along and finds them by name: a URDF may name a link as it names a fixed joint.
    """
    base.appendBodyToJoint(place, arm.inertias[0], pin.SE3.Identity())
    for joint in range(1, arm.njoints):
        parent = place + arm.parents[joint]
        added = base.addJoint(parent, arm.joints[joint], arm.jointPlacements[joint], arm.names[joint])
        base.appendBodyToJoint(added, arm.inertias[joint], pin.SE3.Identity())
    return base


def _on_base(joints: np.ndarray) -> np.ndarray:
    """Return a motion (m, n) of the joints as that of base and joints (m, 2 + n), with a base that stands still."""
    return np.concatenate([np.zeros((len(joints), WAYS)), joints], axis=1)
