"""Scales of a case from which the sizes of hidden effects are drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.studies.challenge.arms import rated_load
from jointwear.studies.challenge.world import World


@dataclass(frozen=True)
class Scene:
    """Per axis (n,): Coulomb level [N m], largest speed [rad/s], lowest and highest position [rad], root mean square
    of load and torque [N m]; `span` is the time from the first sample to the last [s],
    `rated` the load [kg] that the arm is made for."""

    coulomb: np.ndarray
    viscous: np.ndarray
    speed: np.ndarray
    low: np.ndarray
    high: np.ndarray
    load: np.ndarray
    torque: np.ndarray
    gear: np.ndarray
    armature: np.ndarray
    span: float
    rated: float

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.coulomb)


def scene_of(world: World) -> Scene:
    """Return the scales of the motion and arm of a world."""
    state, robot = world.state, world.arm.robot
    return Scene(
        coulomb=world.arm.coulomb,
        viscous=robot.viscous,
        speed=np.abs(state.velocity).max(axis=0),
        low=state.position.min(axis=0),
        high=state.position.max(axis=0),
        load=np.sqrt(np.mean(state.load**2, axis=0)),
        torque=np.std(state.torque, axis=0),
        gear=robot.gear_ratio,
        armature=robot.armature,
        span=float(state.time[-1] - state.time[0]),
        rated=rated_load(robot.name),
    )


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a value whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def either(rng: np.random.Generator) -> float:
    """Draw +1 or -1."""
    return float(rng.choice([-1.0, 1.0]))
