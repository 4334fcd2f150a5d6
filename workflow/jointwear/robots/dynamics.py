"""Rigid-body dynamics and friction of a robot, on Pinocchio.

Pinocchio does the mechanics. Arrays have shape (..., n) for n joints: position [rad], velocity
[rad/s], acceleration [rad/s2], torque [N m], all on the joint side.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from jointwear.files.errors import InputError
from jointwear.robots.robot import Link, Robot
from jointwear.robots.urdf_file import moving_mass, text_of
from jointwear.robots.urdf_tree import MOVING

_BLOCK = 4096  # states
#: Name of the frame at the tip of the arm; a URDF may have frames of any ordinary name.
TIP = "jointwear/tip"
#: Relative difference of the moving mass between URDF and model that is round-off.
MASS_TOLERANCE = 1e-9


def _pin_inertia(link: Link) -> pin.Inertia:
    return pin.Inertia(link.mass, link.com, link.inertia)


def build_model(robot: Robot) -> pin.Model:
    """Return the Pinocchio model of the unloaded or loaded robot; friction is not part of it.

    In the standard DH convention joint i turns about z of frame i-1, so the constant part of row i,
    Tz(d) Tx(a) Rx(alpha), places both the body of link i and the next joint.

    Raises
    ------
    InputError : if a URDF cannot be read or has other joints than the robot file.
    """
    if robot.urdf is not None:
        model = _model_of_urdf(robot)
        frame = pin.SE3.Identity()
    else:
        model = pin.Model()
        parent, placement = 0, pin.SE3.Identity()
        for row, link, name in zip(robot.dh, robot.links, robot.joint_names, strict=True):
            # An offset turns the frame before the joint does: the two rotations share the axis.
            placement = placement * pin.SE3(pin.utils.rotate("z", row.offset), np.zeros(3))
            joint = model.addJoint(parent, pin.JointModelRZ(), placement, name)
            frame = pin.SE3(np.eye(3), np.array([0.0, 0.0, row.d])) * pin.SE3(
                pin.utils.rotate("x", row.alpha), np.array([row.a, 0.0, 0.0])
            )
            model.appendBodyToJoint(joint, _pin_inertia(link), frame)
            parent, placement = joint, frame
        model.addFrame(pin.Frame(TIP, parent, 0, frame, pin.FrameType.OP_FRAME))
    if robot.payload is not None:
        model.appendBodyToJoint(model.njoints - 1, _pin_inertia(robot.payload), frame)
    model.armature = robot.armature
    model.gravity.linear = robot.gravity
    return model


def _model_of_urdf(robot: Robot) -> pin.Model:
    try:
        full = pin.buildModelFromXML(text_of(robot.urdf))
    except (ValueError, RuntimeError) as error:
        raise InputError(f"{robot.urdf}: Pinocchio cannot read it ({error})") from None
    if full.nq != full.nv:
        # Continuous joints have a (cos, sin) pair as position; the project's positions are angles.
        root = pin.Model()
        for joint in range(1, full.njoints):
            model = _turning_by_angle(full.joints[joint])
            index = root.addJoint(full.parents[joint], model, full.jointPlacements[joint], full.names[joint])
            root.appendBodyToJoint(index, full.inertias[joint], pin.SE3.Identity())
        for candidate in full.frames:
            if candidate.type == pin.FrameType.BODY:
                root.addFrame(pin.Frame(candidate.name, candidate.parentJoint, 0, candidate.placement, candidate.type))
        full = root
    strange = [
        f"'{full.names[k]}' ({full.joints[k].shortname()})" for k in range(1, full.njoints) if full.joints[k].nq != 1
    ]
    if strange:
        told = f"Pinocchio has no single angle for joint {', '.join(strange)}"
        raise InputError(f"{robot.urdf}: {told} (allowed: {' and '.join(MOVING)})")
    names = list(full.names)[1:]
    if names != list(robot.joint_names):
        raise InputError(f"{robot.urdf}: joints are {names}, the robot file has {list(robot.joint_names)}")
    mass, told = sum(body.mass for body in list(full.inertias)[1:]), moving_mass(robot.urdf)
    if abs(mass - told) > MASS_TOLERANCE * told:
        raise InputError(f"{robot.urdf}: Pinocchio reads {mass:g} kg of moving links, the file holds {told:g} kg")
    last = [f for f in full.frames if f.type == pin.FrameType.BODY and f.parentJoint == full.njoints - 1]
    tip = last[-1].placement if last else pin.SE3.Identity()
    full.addFrame(pin.Frame(TIP, full.njoints - 1, 0, tip, pin.FrameType.OP_FRAME))
    return full


def _turning_by_angle(joint: pin.JointModel) -> pin.JointModel:
    """Return a joint that turns about the same axis by an angle; any other than an unbounded one as it is."""
    if joint.nv != 1 or joint.nq != 2:
        return joint
    aligned = {
        "JointModelRUBX": pin.JointModelRX,
        "JointModelRUBY": pin.JointModelRY,
        "JointModelRUBZ": pin.JointModelRZ,
    }
    if joint.shortname() in aligned:
        return aligned[joint.shortname()]()
    # About any other axis, of which Pinocchio shows the direction in what the joint does alone.
    data = joint.createData()
    joint.calc(data, np.array([1.0, 0.0]))
    return pin.JointModelRevoluteUnaligned(data.S[3:].ravel())


class Dynamics:
    """Torques, accelerations and positions of one robot.

    Parameters
    ----------
    robot : the robot; payload, motor inertia and friction are taken from it.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = build_model(robot)
        self.data = self.model.createData()
        self._pool: pin.ModelPool | None = None
        self._tip = self.model.getFrameId(TIP)

    def rigid_body_torque(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, threads: int = 1
    ) -> np.ndarray:
        """Return the torque without friction: M(q) a + C(q, v) v + G(q), motor inertia included. Shape (..., n)."""
        n = self.robot.joints
        shape = np.broadcast_shapes(position.shape, velocity.shape, acceleration.shape)
        columns = [
            np.ascontiguousarray(np.broadcast_to(a, shape), dtype=float).reshape(-1, n).T
            for a in (position, velocity, acceleration)
        ]
        torque = np.empty((int(np.prod(shape[:-1], dtype=int)), n))
        if self._pool is None or self._pool.size() < threads:
            self._pool = pin.ModelPool(self.model, threads)
        pin.rneaInParallel(threads, self._pool, *columns, torque.T)
        return torque.reshape(shape)

    def friction_torque(
        self,
        velocity: np.ndarray,
        coulomb: tuple[np.ndarray, np.ndarray] | None = None,
        direction: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return Coulomb and viscous friction, equation (8). Shape (..., n).

        Parameters
        ----------
        velocity : (..., n) [rad/s].
        coulomb : positive and negative Coulomb levels [N m], each broadcastable to velocity; default the robot's.
        direction : (..., n) velocity whose sign decides the Coulomb level; default `velocity`. At exactly
            zero there is no Coulomb friction, as in the toolbox.
        """
        positive, negative = (self.robot.coulomb_positive, self.robot.coulomb_negative) if coulomb is None else coulomb
        # sign * half the span + sign^2 * the middle is the level of that sign, and 0 at 0; several times as fast as
        # choosing element by element.
        sign = np.sign(velocity if direction is None else direction)
        level = sign * ((positive - negative) / 2)
        level = level + np.square(sign, out=sign) * ((positive + negative) / 2)
        return velocity * self.robot.viscous + level

    def inverse_dynamics(
        self,
        position: np.ndarray,
        velocity: np.ndarray,
        acceleration: np.ndarray,
        coulomb: tuple[np.ndarray, np.ndarray] | None = None,
        direction: np.ndarray | None = None,
        threads: int = 1,
    ) -> np.ndarray:
        """Return the motor torque of equation (1) on the joint side, friction included. Shape (..., n)."""
        torque = self.rigid_body_torque(position, velocity, acceleration, threads)
        if coulomb is None and direction is None:
            # In blocks that stay in the cache.
            n = self.robot.joints
            rows, out = np.broadcast_to(velocity, torque.shape).reshape(-1, n), torque.reshape(-1, n)
            for start in range(0, len(out), _BLOCK):
                out[start : start + _BLOCK] += self.friction_torque(rows[start : start + _BLOCK])
        else:
            torque += self.friction_torque(velocity, coulomb, direction)
        return torque

    def gravity_torque(self, position: np.ndarray) -> np.ndarray:
        """Return the torque that holds the arm at rest. Shape (..., n)."""
        rest = np.zeros_like(position, dtype=float)
        return self.rigid_body_torque(position, rest, rest)

    def torque_slopes(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return what an angle and what a velocity (last axis) change of the torque without friction of each joint.

        Shape (m, n, n) each for states (m, n), [N m/rad] and [N m s/rad].
        """
        slopes = np.empty((2, *position.shape, position.shape[-1]))
        for i, state in enumerate(zip(position, velocity, acceleration, strict=True)):
            slopes[:, i] = pin.computeRNEADerivatives(self.model, self.data, *state)[:2]
        return slopes[0], slopes[1]

    def mass_matrix(self, position: np.ndarray) -> np.ndarray:
        """Return M(q) with motor inertia, shape (..., n, n) [kg m2]."""
        n = self.robot.joints
        flat = np.asarray(position, dtype=float).reshape(-1, n)
        matrices = np.empty((len(flat), n, n))
        for i, q in enumerate(flat):
            matrices[i] = pin.crba(self.model, self.data, q)
        matrices = np.triu(matrices) + np.triu(matrices, 1).transpose(0, 2, 1)
        return matrices.reshape(*np.shape(position), n)

    def forward_kinematics(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return translation (..., 3) [m] and rotation (..., 3, 3) of the last link frame in the base frame."""
        flat = np.asarray(position, dtype=float).reshape(-1, self.robot.joints)
        translation, rotation = np.empty((len(flat), 3)), np.empty((len(flat), 3, 3))
        for i, q in enumerate(flat):
            pin.forwardKinematics(self.model, self.data, q)
            placement = pin.updateFramePlacement(self.model, self.data, self._tip)
            translation[i], rotation[i] = placement.translation, placement.rotation
        lead = np.shape(position)[:-1]
        return translation.reshape(*lead, 3), rotation.reshape(*lead, 3, 3)
