"""The arm that really moves: the nominal one with wrong parameters, and its rigid-body and friction torque."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.files.errors import InputError
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, Robot


class Arm:
    """Torques of one robot without any hidden effect; arrays (m, n)."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._dynamics = Dynamics(robot)

    @property
    def coulomb(self) -> np.ndarray:
        """Mean of the two Coulomb levels (n,) [N m]."""
        return (self.robot.coulomb_positive - self.robot.coulomb_negative) / 2

    def torque(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Return the motor torque on the joint side: rigid body, motor inertia, Coulomb and viscous friction."""
        return self._dynamics.inverse_dynamics(position, velocity, acceleration)

    def load(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Return the torque that the gears pass on to the links: neither motor inertia nor friction."""
        return self._dynamics.rigid_body_torque(position, velocity, acceleration) - self.robot.armature * acceleration

    def friction(self, velocity: np.ndarray) -> np.ndarray:
        """Return Coulomb and viscous friction of the drives."""
        return self._dynamics.friction_torque(velocity)

    def mass_matrix(self, position: np.ndarray) -> np.ndarray:
        """Return the mass matrix with motor inertia, (m, n, n) [kg m2]."""
        return self._dynamics.mass_matrix(position)


def _links(robot: Robot) -> tuple[Link, ...]:
    if robot.links is None:
        raise InputError(f"robot '{robot.name}': the hidden-effect test needs a robot given by 'dh' and 'links'")
    return robot.links


def with_wrong_parameters(robot: Robot, rng: np.random.Generator, inertial: float, drive: float) -> Robot:
    """Return the robot with every parameter off by a fixed share, up or down at random.

    Parameters
    ----------
    inertial : share by which mass, each coordinate of the centre of mass and each moment of inertia are off.
    drive : share by which each Coulomb level, viscous coefficient and motor inertia are off.

    Raises
    ------
    InputError : if the robot is given by a URDF.
    """

    def off(share: float, shape: tuple[int, ...]) -> np.ndarray:
        return 1 + share * rng.choice([-1.0, 1.0], shape)

    links = []
    for link in _links(robot):
        moments = np.triu(off(inertial, (3, 3)))
        moments = moments + np.triu(moments, 1).T
        links.append(Link(float(link.mass * off(inertial, ())), link.com * off(inertial, (3,)), link.inertia * moments))
    n = (robot.joints,)
    return replace(
        robot,
        links=tuple(links),
        armature=robot.armature * off(drive, n),
        viscous=robot.viscous * off(drive, n),
        coulomb_positive=robot.coulomb_positive * off(drive, n),
        coulomb_negative=robot.coulomb_negative * off(drive, n),
    )


def with_one_wrong_parameter(robot: Robot, parameter: str, axis: int, share: float) -> Robot:
    """Return the robot with one parameter of one axis (0-based) multiplied by 1 + share.

    Parameters
    ----------
    parameter : "coulomb_friction" (both directions), "viscous_friction", "motor_inertia" or "link_inertia" (mass of
        the link behind the axis; its moments of inertia scale with it).

    Raises
    ------
    InputError : for another parameter, and for "link_inertia" of a robot that is given by a URDF.
    """
    factor = np.ones(robot.joints)
    factor[axis] += share
    if parameter == "coulomb_friction":
        return replace(
            robot, coulomb_positive=robot.coulomb_positive * factor, coulomb_negative=robot.coulomb_negative * factor
        )
    if parameter == "viscous_friction":
        return replace(robot, viscous=robot.viscous * factor)
    if parameter == "motor_inertia":
        return replace(robot, armature=robot.armature * factor)
    if parameter != "link_inertia":
        raise InputError(f"challenge: there is no parameter '{parameter}'")
    links = list(_links(robot))
    old = links[axis]
    links[axis] = Link(old.mass * factor[axis], old.com, old.inertia * factor[axis])
    return replace(robot, links=tuple(links))


def inertial_columns(
    robot: Robot,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
) -> np.ndarray:
    """Return the change of torque for a relative change of each inertial parameter that is not 0, (p, m, n) [N m]."""
    base = Dynamics(robot).rigid_body_torque(position, velocity, acceleration)
    links, columns = _links(robot), []

    def change(index: int, link: Link, share: float) -> None:
        changed = replace(robot, links=(*links[:index], link, *links[index + 1 :]))
        columns.append((Dynamics(changed).rigid_body_torque(position, velocity, acceleration) - base) / share)

    share = 1e-3
    for index, link in enumerate(links):
        if link.mass:
            change(index, replace(link, mass=link.mass * (1 + share)), share)
        for k in np.flatnonzero(link.com) if link.mass else ():
            com = link.com.copy()
            com[k] *= 1 + share
            change(index, replace(link, com=com), share)
        for k, j in zip(*np.nonzero(np.triu(link.inertia)), strict=True):
            inertia = link.inertia.copy()
            inertia[k, j] *= 1 + share
            inertia[j, k] = inertia[k, j]
            change(index, replace(link, inertia=inertia), share)
    # Parameters that this arm cannot feel (a body that never turns about that line) give nothing but round-off.
    return np.array([c for c in columns if np.abs(c).max() > 1e-9])
