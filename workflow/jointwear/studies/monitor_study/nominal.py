"""Nominal models that are wrong, as a maintenance engineer's are: every inertial parameter and friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.robots.robot import Link, Robot


def wrong_nominal(robot: Robot, random: np.random.Generator, inertial: float = 0.05, friction: float = 0.10) -> Robot:
    """Return the robot with every inertial parameter off by the share `inertial` and friction by `friction`.

    Masses, centres of mass, inertias and motor inertias, viscous coefficients and both Coulomb levels of every axis
    are each multiplied by one plus or minus the share; the signs are drawn.
    """

    def off(values: np.ndarray | float, share: float) -> np.ndarray:
        values = np.asarray(values, dtype=float)
        return values * (1 + share * random.choice([-1.0, 1.0], values.shape))

    def body(link: Link) -> Link:
        # One factor for a whole inertia keeps it that of a body.
        return Link(float(off(link.mass, inertial)), off(link.com, inertial), link.inertia * float(off(1.0, inertial)))

    return replace(
        robot,
        links=None if robot.links is None else tuple(body(link) for link in robot.links),
        payload=None if robot.payload is None else body(robot.payload),
        armature=off(robot.armature, inertial),
        viscous=off(robot.viscous, friction),
        coulomb_positive=off(robot.coulomb_positive, friction),
        coulomb_negative=off(robot.coulomb_negative, friction),
    )


def coulomb_levels_of(robot: Robot) -> np.ndarray:
    """Return both Coulomb levels (n, 2) [N m], positive."""
    return np.stack([np.abs(robot.coulomb_positive), np.abs(robot.coulomb_negative)], axis=1)
