"""Torque that holds an arm at rest, for many samples at once.

What gravity asks of a joint is the moment, about its axis, of the weights that it carries. Seen from a link that is

    n = s x g + sum over the next links of R n' (+ q z x w g where the next joint slides along z by q),

g the acceleration that holds against gravity, s what lies fixed to the link (its own first moment, and the masses
beyond at the places where the next joints are), w the mass beyond. So one vector goes outwards and one comes back, and
the whole is a sixth of an inverse dynamics by Pinocchio with velocity and acceleration zero, to which it is equal but
for round-off. Arrays have the components first, (3, m).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

#: Samples worked on at once: what they need stays in the cache.
BLOCK = 2048


@dataclass(frozen=True)
class _Joint:
    """`turn` (3, 3): fixed rotation to a frame whose third axis is that of the joint, seen from the parent's frame.

    `parent` : index, -1 for the base. `turning` : or sliding. `mass` : [kg] beyond the joint. `moment` (3,): `s` of the
    link [kg m].
    """

    parent: int
    turning: bool
    turn: np.ndarray
    mass: float
    moment: np.ndarray


class GravityTorque:
    """Gravity torques of a Pinocchio model whose joints turn about or slide along an axis each."""

    def __init__(self, model: pin.Model) -> None:
        data = model.createData()
        pin.computeJointJacobians(model, data, np.zeros(model.nq))
        self._up = -np.array(model.gravity.linear)[:, None]
        count = model.njoints - 1
        bases, turning = [np.eye(3)], []
        for joint in range(1, model.njoints):
            twist = pin.getJointJacobian(model, data, joint, pin.LOCAL).reshape(6, -1)[:, joint - 1]
            turning.append(not twist[:3].any())
            bases.append(with_third_axis(twist[3:] if turning[-1] else twist[:3]))
        mass = np.array([model.inertias[k].mass for k in range(1, model.njoints)])
        moment = [model.inertias[k].mass * np.array(model.inertias[k].lever) for k in range(1, model.njoints)]
        for k in reversed(range(count)):
            parent = model.parents[k + 1] - 1
            if parent >= 0:
                mass[parent] += mass[k]
                moment[parent] = moment[parent] + mass[k] * model.jointPlacements[k + 1].translation
        self._joints = [
            _Joint(
                model.parents[k + 1] - 1,
                turning[k],
                bases[model.parents[k + 1]].T @ model.jointPlacements[k + 1].rotation @ bases[k + 1],
                float(mass[k]),
                bases[k + 1].T @ moment[k],
            )
            for k in range(count)
        ]

    def __call__(self, position: np.ndarray) -> np.ndarray:
        """Return the torques (m, n) [N m] at positions (m, n) [rad]."""
        out = np.empty((position.shape[1], len(position)))
        for start in range(0, len(position), BLOCK):
            part = slice(start, start + BLOCK)
            self._block(np.ascontiguousarray(position[part].T), out[:, part])
        return out.T

    def _block(self, position: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` (n, m) for positions (n, m)."""
        joints = self._joints
        up, sine, cosine = [], np.sin(position), np.cos(position)
        for k, joint in enumerate(joints):
            before = up[joint.parent] if joint.parent >= 0 else np.broadcast_to(self._up, (3, position.shape[1]))
            seen = joint.turn.T @ before
            up.append(_turned(seen, -sine[k], cosine[k]) if joint.turning else seen)
        moments = [_crossed(joint.moment, here) for joint, here in zip(joints, up, strict=True)]
        for k in reversed(range(len(joints))):
            joint, inner = joints[k], moments[k]
            if joint.turning:
                out[k] = inner[2]
                inner = _turned(inner, sine[k], cosine[k])
            else:
                out[k] = joint.mass * up[k][2]
                inner = inner + joint.mass * position[k] * np.stack([-up[k][1], up[k][0], np.zeros(len(position[k]))])
            if joint.parent >= 0:
                moments[joint.parent] += joint.turn @ inner


def with_third_axis(axis: np.ndarray) -> np.ndarray:
    """Return a rotation (3, 3) whose third column is a unit vector; the identity where it is the third axis."""
    if axis[2] == 1.0:
        return np.eye(3)
    other = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    other /= np.linalg.norm(other)
    return np.stack([other, np.cross(axis, other), axis], axis=1)


def _turned(vector: np.ndarray, sine: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Return vectors (3, m) turned about the third axis."""
    out = np.empty_like(vector)
    np.multiply(cosine, vector[0], out=out[0])
    out[0] -= sine * vector[1]
    np.multiply(sine, vector[0], out=out[1])
    out[1] += cosine * vector[1]
    out[2] = vector[2]
    return out


def _crossed(fixed: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return a fixed vector (3,) times vectors (3, m)."""
    x, y, z = fixed
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) @ vector
