"""Torque of a repeated task as a real robot would log it: wear, disturbance, measurement noise (Table I)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, create_dataset
from jointwear.reproduction.readings import (
    coulomb_direction,
    disturbance_mean,
    disturbance_return,
    noise_draws,
    noise_level,
    select,
)
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot
from jointwear.robots.trajectory import HOUR, Motion, Task, load_task
from jointwear.statistics.randomness import generator


@dataclass(frozen=True)
class Noise:
    """Size and reading of what disturbs the torque.

    `disturbance_share` of the mean torque; `encoder` noise [rad]; `time_step` [s] by which the noise of
    velocity and acceleration is scaled, equation (9); `reading` one alternative for every ambiguity of the
    stage "simulation".
    """

    disturbance_share: float
    encoder: float
    time_step: float
    reading: Mapping[str, str]


class RepeatedTask:
    """A task that a robot repeats for `hours`, sampled at the same instants in every hour.

    Parameters
    ----------
    dynamics : the robot.
    task : the task; `samples` instants every `interval` [s] from the start of every hour.
    coulomb : Coulomb levels [N m] (hours, n) for positive and for negative velocity.
    noise : disturbance and measurement noise.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        task: Task,
        coulomb: tuple[np.ndarray, np.ndarray],
        noise: Noise,
        interval: float = 10.0,
        samples: int = 60,
    ) -> None:
        self.dynamics, self.noise = dynamics, noise
        self.motion = task.samples(interval, samples)
        self.coulomb = tuple(level[:, None, :] for level in coulomb)
        self.torque, self._effects = self._commanded(self.motion)
        cycle, _ = self._commanded(task.grid(noise.time_step))
        mean = select(disturbance_mean, noise.reading["disturbance_mean"])(self.torque, cycle)
        self._disturbance = (noise.disturbance_share * mean)[:, None, :]
        self._mass = dynamics.mass_matrix(self.motion.position)
        self._encoder = select(noise_level, noise.reading["noise_level"])(noise.encoder)
        self._return = select(disturbance_return, noise.reading["disturbance_return"])
        self._draws = select(noise_draws, noise.reading["noise_draws"])
        self._direction = select(coulomb_direction, noise.reading["coulomb_direction"])

    def _commanded(self, motion: Motion) -> tuple[np.ndarray, np.ndarray | float]:
        """Torque without noise in every hour, shape (hours, instants, n), and the part of the robot's effects."""
        rigid = self.dynamics.rigid_body_torque(motion.position, motion.velocity, motion.acceleration)
        effects = self._effects_of(motion, rigid)
        return rigid + self.dynamics.friction_torque(motion.velocity, self.coulomb) + effects, effects

    def _effects_of(self, motion: Motion, rigid: np.ndarray) -> np.ndarray | float:
        """Torque of the effects in the robot file, on the commanded motion: noise changes it in second order only."""
        robot = self.dynamics.robot
        if not robot.effects:
            return 0.0
        from jointwear.effects import check_effects, effect_torque, make_state

        check_effects(robot)
        start = HOUR * np.arange(len(self.coulomb[0]))[:, None]
        lead = (len(start), *motion.position.shape)
        parts = (np.broadcast_to(a, lead) for a in (motion.position, motion.velocity, motion.acceleration, rigid))
        return effect_torque(robot, make_state(robot, *parts, time=start + motion.time))

    def measure(self, random: np.random.Generator, threads: int = 1) -> np.ndarray:
        """Return one replicate of the measured torque, shape (hours, samples, n) [N m].

        The disturbed torque is turned into a motion by forward dynamics, noise is added to position, velocity
        and acceleration, and inverse dynamics of the noisy motion gives the measured torque (Table I, 2 to 5).
        """
        shape, motion, step = self.torque.shape, self.motion, self.noise.time_step

        def normal() -> np.ndarray:
            # Single precision is drawn four times as fast; its resolution is 1e-7 of the noise.
            return random.standard_normal(shape, dtype=np.float32)

        disturbance = self._disturbance * normal()
        jolt = self._return(disturbance, self._mass)
        noise = self._draws(lambda: self._encoder * normal().astype(float))
        position = motion.position + noise[0]
        velocity = motion.velocity + noise[1] / step
        acceleration = motion.acceleration + noise[2] / step**2
        acceleration += jolt
        direction = self._direction(motion.velocity, velocity)
        torque = self.dynamics.inverse_dynamics(
            position, velocity, acceleration, self.coulomb, direction, threads=threads
        )
        torque += self._effects
        return torque


def unworn_levels(dynamics: Dynamics, hours: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the Coulomb levels [N m] of a robot that does not wear, positive and negative, each (hours, n)."""
    robot = dynamics.robot
    return np.tile(robot.coulomb_positive, (len(hours), 1)), np.tile(robot.coulomb_negative, (len(hours), 1))


def exceedance(torque: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """Return the largest |torque| of each axis as a share of its limit, shape (n,); NaN where no limit is known."""
    return np.abs(torque).max(axis=tuple(range(torque.ndim - 1))) / limit


def simulate_run(
    robot: str | Path,
    task: str | Path,
    output: str | Path,
    *,
    key: tuple[str | int, ...],
    hours: int,
    settings: Mapping[str, Any],
    levels: Callable[[Dynamics, np.ndarray], tuple[np.ndarray, np.ndarray]] = unworn_levels,
    what: str = "normal operation",
    named: Mapping[str, Any] | None = None,
    threads: int = 1,
) -> None:
    """Simulate all replicates of one run and write their torque samples.

    Parameters
    ----------
    robot, task : robot file and task file.
    output : netCDF file with `torque` (replicate, hour, sample, axis).
    key : name of the run, which decides its random numbers.
    hours : length of the run [h].
    settings : `seed`, `replicates`, `sampling`, `noise`, `reading`.
    levels : Coulomb levels [N m] at the hours of the run, for positive and negative velocity, each (hours, n).
    what : what the run shows, for the title of the file.
    named : further global attributes, by which later stages know the run.

    Raises
    ------
    InputError : if a file is wrong.
    """
    dynamics, the_task = Dynamics(load_robot(robot)), load_task(task)
    n = dynamics.robot.joints
    hour = np.arange(1, hours + 1)
    noise = Noise(**settings["noise"], reading=settings["reading"])
    sampling = settings["sampling"]
    coulomb = levels(dynamics, hour)
    repeated = RepeatedTask(dynamics, the_task, coulomb, noise, sampling["interval"], sampling["samples"])
    replicates, samples = settings["replicates"], sampling["samples"]
    variables = {
        "replicate": Variable(("replicate",), np.arange(1, replicates + 1), "replicate", "1"),
        "hour": Variable(("hour",), hour, "time since the start of the run", "h"),
        "sample_time": Variable(
            ("sample",), sampling["interval"] * np.arange(samples), "time of the sample in its hour", "s"
        ),
        "axis": Variable(("axis",), np.arange(1, n + 1), "axis of the robot", "1"),
        "torque": Variable(
            ("replicate", "hour", "sample", "axis"), None, "measured joint torque", "N m", kind="f4", finite=True
        ),
        "commanded_torque": Variable(
            ("hour", "sample", "axis"), repeated.torque, "torque without disturbance and noise", "N m", kind="f4"
        ),
        "coulomb": Variable(("hour", "axis"), coulomb[0], "Coulomb friction for positive velocity", "N m"),
        "limit_share": Variable(
            ("axis",), None, "largest |torque| as a share of the robot's torque limit", "1", kind="f8"
        ),
    }
    sizes = {"replicate": replicates, "hour": hours, "sample": samples, "axis": n}
    title = f"torque of {the_task.name}, {what}"
    own = {"key": list(key), "hours": hours}
    described = {**provenance.attributes(title, settings, own=own), **(named or {})}
    with create_dataset(output, sizes, variables, described) as dataset:
        share = np.zeros(n)
        for replicate in range(replicates):
            torque = repeated.measure(generator(settings["seed"], *key, replicate=replicate), threads)
            if not np.isfinite(torque).all():
                raise InputError(
                    f"{robot}: its torques on {task} are not finite; a number of either is out of proportion"
                )
            share = np.fmax(share, exceedance(torque, dynamics.robot.torque_limit))
            dataset["torque"][replicate] = torque
        dataset["limit_share"][:] = np.where(np.isnan(dynamics.robot.torque_limit), np.nan, share)
