"""Torques that a unit load at the flange asks of the joints, for many samples at once.

A mass m with its centre at c (frame of the payload) adds (m, m c) . u to the torques as long as its inertia about the
flange is left out: u are the torques of a unit mass at the frame's origin and of unit first moments along its axes
(linear, see Khalil and Dombre 2002, chapter 12). Positions, velocities and accelerations of the frames come from the
recursion of Luh, Walker and Paul (1980) outwards; inwards only the last body has a mass. Arrays have the components
first, (3, m).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from jointwear.robots.dynamics import TIP, build_model
from jointwear.robots.robot import Robot

#: Samples worked on at once: what they need stays in the cache.
BLOCK = 2048


class FlangeLoad:
    """Unit torques of a load in the frame of a robot's payload."""

    def __init__(self, robot: Robot) -> None:
        model = build_model(robot)
        data = model.createData()
        still = np.zeros(model.nq)
        pin.computeJointJacobians(model, data, still)
        self._steps, base = [], np.eye(3)
        for joint in range(1, model.njoints):
            place = model.jointPlacements[joint]
            # Of a robot with one joint, Pinocchio gives a vector.
            twist = pin.getJointJacobian(model, data, joint, pin.LOCAL).reshape(6, -1)[:, joint - 1]
            own = _with_third_axis(twist[3:])
            self._steps.append((base.T @ place.rotation @ own, base.T @ place.translation))
            base = own
        tip = pin.SE3.Identity() if robot.urdf is not None else model.frames[model.getFrameId(TIP)].placement
        self._tip = (base.T @ tip.rotation, base.T @ tip.translation)
        self._gravity = np.asarray(robot.gravity, dtype=float)[:, None]

    def axes(self, position: np.ndarray) -> np.ndarray:
        """Return the directions (m, n, 3) about which the joints turn, in the base frame."""
        still = np.zeros(np.shape(position))
        joints, _ = self._frames(np.asarray(position, dtype=float), still, still)
        return np.stack([joint.way.T for joint in joints], axis=1)

    def pull(self, position: np.ndarray) -> np.ndarray:
        """Return what gravity on a unit mass at the frame's origin, by its components in the base frame, asks of the
        joints, (m, n, 3) [m]."""
        still = np.zeros(np.shape(position))
        joints, tip = self._frames(np.asarray(position, dtype=float), still, still)
        return np.stack([-joint.reach(tip.place).T for joint in joints], axis=1)

    def unit(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Return gravity and inertial torque (2, m, 4, n) of unit mass [N m/kg] and unit first moments [N m/(kg m)]
        along a motion (m, n)."""
        return self._unit(position, velocity, acceleration, apart=True)

    def unit_sum(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Return what :meth:`unit` does, gravity and inertial torque in one, (m, 4, n)."""
        return self._unit(position, velocity, acceleration, apart=False)[0]

    def _unit(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, apart: bool) -> np.ndarray:
        """Return unit torques (f, m, 4, n): gravity and inertial torque `apart` (f = 2) or in one (f = 1)."""
        out = np.empty((2 if apart else 1, 4, position.shape[1], len(position)))
        for part in _blocks(len(position)):
            joints, tip = self._frames(position[part], velocity[part], acceleration[part])
            held = np.broadcast_to(-self._gravity, tip.place.shape)
            forces = [held, tip.pushed] if apart else [tip.pushed + held]
            edges = [tip.turn[:, k] for k in range(3)]
            swung = [tip.swung(edge) for edge in edges]
            couples = [[_cross(edge, force) for edge in edges] for force in forces]
            for j, joint in enumerate(joints):
                reach = joint.reach(tip.place)
                for f, force in enumerate(forces):
                    out[f, 0, j, part] = _dot(reach, force)
                    for k in range(3):
                        out[f, k + 1, j, part] = joint.couple(couples[f][k])
                for k in range(3):
                    # What turns with the frame is inertia, the last of the forces.
                    out[-1, k + 1, j, part] += _dot(reach, swung[k])
        return out.transpose(0, 3, 1, 2)

    def torque(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, moments: np.ndarray
    ) -> np.ndarray:
        """Return gravity and inertial torque (2, m, n) [N m] of loads `moments` (m, 4), mass [kg] and first moments
        [kg m] of each sample."""
        out = np.empty((2, position.shape[1], len(position)))
        for part in _blocks(len(position)):
            out[..., part] = self._torque(position[part], velocity[part], acceleration[part], moments[part])
        return out.transpose(0, 2, 1)

    def _torque(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, moments: np.ndarray
    ) -> np.ndarray:
        joints, tip = self._frames(position, velocity, acceleration)
        held = np.broadcast_to(-self._gravity, tip.place.shape)
        mass, centre = moments[:, 0], np.einsum("ikm,mk->im", tip.turn, moments[:, 1:])
        forces = (mass * held, mass * tip.pushed + tip.swung(centre))
        couples = (_cross(centre, held), _cross(centre, tip.pushed))
        out = np.empty((2, len(joints), len(position)))
        for j, joint in enumerate(joints):
            reach = joint.reach(tip.place)
            for k in range(2):
                out[k, j] = _dot(reach, forces[k]) + joint.couple(couples[k])
        return out

    def _frames(
        self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
    ) -> tuple[list[_Joint], _Frame]:
        """Return the joints as they lie, and the frame of the payload."""
        m = len(position)
        q, v, a = (np.ascontiguousarray(x.T) for x in (position, velocity, acceleration))
        sine, cosine = np.sin(q), np.cos(q)
        frame = _Frame(np.broadcast_to(np.eye(3)[:, :, None], (3, 3, m)), *(np.zeros((3, m)) for _ in range(4)))
        joints = []
        for k, (fixed, offset) in enumerate(self._steps):
            frame = frame.placed(fixed, offset)
            way = frame.turn[:, 2]
            joints.append(_Joint(way, frame.place))
            spun = frame.spun + way * a[k]
            spun += _cross(frame.spin, way) * v[k]
            turn = _turned(frame.turn, sine[k], cosine[k])
            frame = replace(frame, turn=turn, spin=frame.spin + way * v[k], spun=spun)
        return joints, frame.placed(*self._tip)


@dataclass(frozen=True)
class _Frame:
    """A frame that moves: rotation (3, 3, m), place, angular velocity and acceleration, acceleration (3, m)."""

    turn: np.ndarray
    place: np.ndarray
    spin: np.ndarray
    spun: np.ndarray
    pushed: np.ndarray

    def swung(self, arm: np.ndarray) -> np.ndarray:
        """Return the acceleration that a point fixed to the frame has beyond that of its origin."""
        out = _cross(self.spun, arm)
        out += _cross(self.spin, _cross(self.spin, arm))
        return out

    def placed(self, rotation: np.ndarray, offset: np.ndarray) -> _Frame:
        """Return a frame fixed to this one."""
        turn = rotation.T @ self.turn
        if not offset.any():
            return replace(self, turn=turn)
        arm = _along(self.turn, offset)
        return replace(self, turn=turn, place=self.place + arm, pushed=self.pushed + self.swung(arm))


@dataclass(frozen=True)
class _Joint:
    """Direction and place (3, m) of the axis of a joint."""

    way: np.ndarray
    centre: np.ndarray

    def reach(self, place: np.ndarray) -> np.ndarray:
        """Return what a force at a place is multiplied with."""
        return _cross(self.way, place - self.centre)

    def couple(self, couple: np.ndarray) -> np.ndarray:
        """Return the torque of a couple."""
        return _dot(self.way, couple)


def _blocks(count: int) -> list[slice]:
    return [slice(start, start + BLOCK) for start in range(0, count, BLOCK)]


def _along(turn: np.ndarray, vector: np.ndarray) -> np.ndarray:
    out = turn[:, 0] * vector[0]
    for k in (1, 2):
        if vector[k]:
            out += turn[:, k] * vector[k]
    return out


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        np.multiply(a[i], b[j], out=out[k])
        out[k] -= a[j] * b[i]
    return out


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _with_third_axis(axis: np.ndarray) -> np.ndarray:
    """Return a rotation (3, 3) whose third column is a unit vector; the identity where it is the third axis."""
    if axis[2] == 1.0:
        return np.eye(3)
    other = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    other /= np.linalg.norm(other)
    return np.stack([other, np.cross(axis, other), axis], axis=1)


def _turned(turn: np.ndarray, sine: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Return rotations (3, 3, m) times a turn about the third axis."""
    out = np.empty_like(turn)
    out[:, 0] = cosine * turn[:, 0]
    out[:, 0] += sine * turn[:, 1]
    out[:, 1] = cosine * turn[:, 1]
    out[:, 1] -= sine * turn[:, 0]
    out[:, 2] = turn[:, 2]
    return out
