"""Torque of all runs of a task from one simulation: the worn runs share the noise of the normal one.

Wear changes the torque of a run in two places only: the Coulomb friction of the worn axis and, because the
disturbance is a share of the mean torque, the size of that axis' disturbance. Both are added to the torque of
the normal run as the full simulation would have them, but for the product of the disturbance's growth with the
measurement noise (some 1e-7 N m), so that one simulation serves all axes, all increases and all wear shapes.
Each worn run takes another stretch of the normal hours, which are exchangeable.

Samples are the first dimension here, because everything that follows reduces over them: numpy then adds and
compares whole rows at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointwear.reproduction.readings import (
    coulomb_direction,
    disturbance_mean,
    disturbance_return,
    noise_draws,
    noise_level,
    select,
    training_length,
)
from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.trajectory import Task
from jointwear.statistics.randomness import generator


@dataclass(frozen=True)
class SharedExperiment:
    """What all readings share: sampling, noise, seed and number of replicates.

    `samples` instants every `interval` [s] from the start of every hour; `wear_hours` and `normal_hours` [h] are
    the lengths of worn and normal runs; `disturbance_share`, `encoder` [rad] and `time_step` [s] as in
    :class:`jointwear.reproduction.simulation.Noise`.
    """

    seed: int
    replicates: int
    disturbance_share: float = 0.01
    encoder: float = 1e-4
    time_step: float = 0.5
    interval: float = 10.0
    samples: int = 60
    wear_hours: int = 120
    normal_hours: int = 168


class SharedTask:
    """One task of one pose set under one reading of the stages "simulation" and "training".

    Parameters
    ----------
    dynamics, task : the robot and the task.
    experiment : what all readings share.
    reading : alternatives of the two stages.
    key : name of pose set and task in the streams of random numbers.

    Attributes
    ----------
    training : (samples, r, hours, n) torque of the training period [N m], single precision as on disk.
    normal : (samples, r, normal_hours, n) torque of normal operation after training [N m].
    leaks : whether wear of one axis changes the noise of the others.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        task: Task,
        experiment: SharedExperiment,
        reading: Mapping[str, str],
        key: tuple[str | int, ...],
    ) -> None:
        self.dynamics, self.experiment, e = dynamics, experiment, experiment
        self._motion = task.samples(e.interval, e.samples)
        self._cycle = task.grid(e.time_step)
        self._mean = select(disturbance_mean, reading["disturbance_mean"])
        self._return = select(disturbance_return, reading["disturbance_return"])
        self._draws = select(noise_draws, reading["noise_draws"])
        self._direction = select(coulomb_direction, reading["coulomb_direction"])
        self._encoder = select(noise_level, reading["noise_level"])(e.encoder)
        self.leaks = reading["disturbance_return"] != "coupled"
        self._mass = dynamics.mass_matrix(self._motion.position)
        motions = (self._motion, self._cycle)
        self._commanded = [dynamics.inverse_dynamics(m.position, m.velocity, m.acceleration) for m in motions]
        self._share = e.disturbance_share * self._mean(*self._commanded)
        length = select(training_length, reading["training_length"])()
        n = dynamics.robot.joints
        self.training = np.empty((e.samples, e.replicates, length, n), dtype=np.float32)
        self.normal = np.empty((e.samples, e.replicates, e.normal_hours, n), dtype=np.float32)
        self._unit = np.empty_like(self.normal)
        # The sign of the velocity that decides Coulomb friction, kept only where noise can turn it.
        follows_noise = reading["coulomb_direction"] != "commanded_velocity"
        self._sign = np.sign(self._motion.velocity)[:, None, None]
        if follows_noise:
            self._sign = np.empty(self.normal.shape, dtype=np.int8)
        for r in range(e.replicates):
            random = generator(e.seed, "multiverse", "training", *key, replicate=r)
            self.training[:, r] = self._measure(random, length)[0].swapaxes(0, 1)
            random = generator(e.seed, "multiverse", "normal", *key, replicate=r)
            torque, unit, direction = (a.swapaxes(0, 1) for a in self._measure(random, e.normal_hours))
            self.normal[:, r], self._unit[:, r] = torque, unit
            if follows_noise:
                self._sign[:, r] = np.sign(direction)

    def _measure(self, random: np.random.Generator, hours: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return torque, standard normal disturbance and the velocity that decides Coulomb friction.

        The same draws in the same order as :meth:`jointwear.reproduction.simulation.RepeatedTask.measure`.
        """
        motion, step = self._motion, self.experiment.time_step
        shape = (hours, *motion.velocity.shape)

        def normal() -> np.ndarray:
            return random.standard_normal(shape, dtype=np.float32)

        unit = normal()
        noise = self._draws(lambda: self._encoder * normal().astype(float))
        velocity = motion.velocity + noise[1] / step
        acceleration = motion.acceleration + self._return(self._share * unit, self._mass)
        acceleration += noise[2] / step**2
        direction = self._direction(motion.velocity, velocity)
        torque = self.dynamics.inverse_dynamics(motion.position + noise[0], velocity, acceleration, direction=direction)
        return torque, unit, np.broadcast_to(direction, shape)

    def worn(self, axis: int, increase_percent: float, shape: float, offset: int) -> np.ndarray:
        """Return the torque of a worn run, (samples, r, wear_hours, k) [N m].

        Parameters
        ----------
        axis : 1-based axis that wears.
        increase_percent, shape : of :class:`jointwear.reproduction.wear.Wear`.
        offset : hour of normal operation whose noise the first hour of the run has.

        Notes
        -----
        The last dimension holds all axes where wear leaks into the others, else the worn axis alone: the other
        axes then have the torque of the normal hours :meth:`hours_from`.
        """
        e, j, robot = self.experiment, axis - 1, self.dynamics.robot
        hour = np.arange(1, e.wear_hours + 1)
        growth = Wear(increase_percent, shape, e.wear_hours).growth(hour)
        chosen = self.hours_from(offset)

        def friction(sign: np.ndarray) -> np.ndarray:
            level = np.where(sign > 0, np.float32(robot.coulomb_positive[j]), np.float32(0))
            return level + np.where(sign < 0, np.float32(robot.coulomb_negative[j]), np.float32(0))

        commanded = [
            torque[:, j] + growth[:, None] * friction(motion.velocity[:, j])
            for torque, motion in zip(self._commanded, (self._motion, self._cycle), strict=True)
        ]
        # Means are over samples and cycle: (hours, 1), or one value for all hours.
        share = e.disturbance_share * self._mean(*(c[:, :, None] for c in commanded))[:, 0]
        extra = (share - self._share[j]).astype(np.float32) * self._unit[..., j][:, :, chosen]
        sign = self._sign[..., j]
        rise = growth.astype(np.float32) * friction(sign if sign.shape[2] == 1 else sign[:, :, chosen])
        if not self.leaks:
            return (self.normal[..., j][:, :, chosen] + extra + rise)[..., None]
        # Axis by axis, the acceleration extra / M_jj of axis j needs the torque M_ij extra / M_jj of axis i.
        spread = (self._mass[:, :, j] / self._mass[:, j, j, None]).astype(np.float32)
        torque = self.normal[:, :, chosen] + extra[..., None] * spread[:, None, None, :]
        torque[..., j] += rise
        return torque

    def hours_from(self, offset: int) -> np.ndarray:
        """Return the indices (wear_hours,) of the normal hours that a run with this offset shares."""
        return (offset + np.arange(self.experiment.wear_hours)) % self.experiment.normal_hours


CELL_STEP = 14  # hours between the stretches of normal hours of successive cells: 12 cells share a week


def cell_offset(axis: int, column: int, axes: int) -> int:
    """Return the offset [h] of the run of a 1-based `axis` in a 0-based column of increase."""
    return (column * axes + axis - 1) * CELL_STEP
