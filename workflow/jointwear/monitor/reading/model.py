"""Torque of the (augmented) model along a measured motion, with the parts that the regression needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.effects import check_effects, effect_torque, make_state
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import wind_up_regressor
from jointwear.robots.robot import Robot


@dataclass(frozen=True)
class ModelTorque:
    """Torques [N m], (m, n): `total` with friction and effects; `gravity`; `inertial`, what moves the rigid bodies, and
    gravity too where nobody asked for it apart."""

    total: np.ndarray
    gravity: np.ndarray
    inertial: np.ndarray


class TorqueModel:
    """The model of a robot, nominal friction and effects included.

    Raises
    ------
    InputError : if an effect of the robot file is wrong, or a URDF cannot be read.
    """

    def __init__(self, robot: Robot) -> None:
        check_effects(robot)
        self.robot = robot
        self.dynamics = Dynamics(robot)

    def __call__(
        self,
        position: np.ndarray,
        velocity: np.ndarray,
        acceleration: np.ndarray,
        time: np.ndarray | None = None,
        temperature: np.ndarray | None = None,
        record: np.ndarray | None = None,
        apart: np.ndarray | None = None,
    ) -> ModelTorque:
        """Return the torques along a motion (m, n).

        Parameters
        ----------
        time : (m,) [s]. temperature : (m, n) [degC], NaN where unknown.
        record : (m,) label of the uninterrupted stretch that a sample belongs to, for effects that remember.
        apart : (m,) bool, samples whose gravity is told apart from what moves the bodies; default all. It takes as long
            as all the rest.
        """
        rigid = self.dynamics.rigid_body_torque(position, velocity, acceleration)
        gravity = np.zeros_like(rigid)
        asked = slice(None) if apart is None else apart
        gravity[asked] = self.dynamics.gravity_torque(position[asked])
        if self.robot.effects:
            state = make_state(
                self.robot,
                position,
                velocity,
                acceleration,
                rigid,
                time=time,
                temperature=temperature,
                record=record,
                wind_up_regressor=wind_up_regressor(self.dynamics, position, velocity, acceleration),
            )
            total = state.torque + effect_torque(self.robot, state)
        else:
            total = rigid + self.dynamics.friction_torque(velocity)
        return ModelTorque(total=total, gravity=gravity, inertial=rigid - gravity)
