"""Torque at the sampled instants under a candidate, from parts in which most of its parameters are linear."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, Robot
from jointwear.studies.recovery.candidates import Coefficients, Explanation
from jointwear.studies.recovery.sampled_motion import States


class RigidBodyParts:
    """Rigid-body torque of the unloaded arm and of a point payload of unit mass, as polynomials.

    A point mass at c adds a torque quadratic in c, so ten evaluations give it for every c.
    """

    def __init__(self, robot: Robot, candidate: Explanation, known: Coefficients | None = None) -> None:
        """`known`: one set of coefficients (S = 1) that will not change; a payload then becomes part of the arm."""
        load = None
        if known is not None and known.payload[0, 0] > 0:
            load = Link(known.payload[0, 0], known.payload[0, 1:4] / known.payload[0, 0], np.zeros((3, 3)))
        robot = replace(robot, payload=load)
        names = {c.name for c in candidate.components}
        self._arm = Dynamics(robot)
        # What a candidate does not touch need not be told apart.
        self._weightless = (
            Dynamics(replace(robot, gravity=np.zeros(3))) if names & {"gravity_scale", "mass_scale"} else None
        )
        self._loaded: list[Dynamics] = []
        if "payload" in names and known is None:
            e = np.eye(3)
            offsets = [np.zeros(3), *e, *-e, *(e[i] + e[j] for i, j in combinations(range(3), 2))]
            self._loaded = [Dynamics(replace(robot, payload=Link(1.0, c, np.zeros((3, 3))))) for c in offsets]
        self.armature = robot.armature

    def torque(self, states: States, coefficients: Coefficients) -> np.ndarray:
        """Return the torque (S, ..., n) without friction [N m]; `coefficients` hold one set for each of S."""
        return self.combine(self.parts(states), states.acceleration, coefficients)

    def parts(self, states: States) -> list[np.ndarray]:
        """Return what `combine` weights: total or inertial and gravity torque, then payload terms, each (..., n)."""
        q, v, a = states.position, states.velocity, states.acceleration
        full = self._arm.rigid_body_torque(q, v, a)
        parts = [full]
        if self._weightless is not None:
            inertial = self._weightless.rigid_body_torque(q, v, a)
            parts = [inertial, full - inertial]
        if self._loaded:
            f = [d.rigid_body_torque(q, v, a) - full for d in self._loaded]
            linear = [(f[1 + k] - f[4 + k]) / 2 for k in range(3)]
            square = [(f[1 + k] + f[4 + k]) / 2 - f[0] for k in range(3)]
            cross = [
                f[7 + m] - f[0] - linear[i] - linear[j] - square[i] - square[j]
                for m, (i, j) in enumerate(combinations(range(3), 2))
            ]
            parts += [f[0], *linear, *square, *cross]
        return parts

    def combine(self, parts: list[np.ndarray], acceleration: np.ndarray, coefficients: Coefficients) -> np.ndarray:
        """Return the weighted sum of `parts`; the first axis of every array counts the sets of coefficients."""
        extra = acceleration.ndim - 1

        def spread(value: np.ndarray) -> np.ndarray:
            return value.reshape(value.shape[:1] + (1,) * (extra - value.ndim + 1) + value.shape[1:])

        def each(value: np.ndarray) -> np.ndarray:
            return value.reshape((-1,) + (1,) * extra)

        if self._weightless is not None:
            # The motor inertia belongs to the drives, not to the masses that are scaled.
            motor = self.armature * acceleration
            torque = each(coefficients.inertial) * (parts[0] - motor) + motor + each(coefficients.gravity) * parts[1]
            rest = parts[2:]
        else:
            torque, rest = parts[0].copy(), parts[1:]
        for k, part in enumerate(rest):
            torque += each(coefficients.payload[:, k]) * part
        if np.any(coefficients.armature != 1):
            torque += spread(coefficients.armature - 1) * self.armature * acceleration
        return torque
