"""Data sets with a hidden effect that are not part of the score: the small shipped one, and a task over many hours."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.reproduction.wear import Wear
from jointwear.robots.robot import Robot, load_robot
from jointwear.robots.trajectory import Task, load_task
from jointwear.statistics.randomness import generator
from jointwear.studies.challenge.arm import Arm, with_wrong_parameters
from jointwear.studies.challenge.case_files import write_case_data
from jointwear.studies.challenge.friction_forms import viscosity
from jointwear.studies.challenge.generate import CaseData
from jointwear.studies.challenge.hide import draw_hidden
from jointwear.studies.challenge.motion import fourier_path
from jointwear.studies.challenge.scene import scene_of
from jointwear.studies.challenge.sensors import encoder_steps, quantise, torque_noise
from jointwear.studies.challenge.surroundings import start_times, temperatures
from jointwear.studies.challenge.world import build_world, total_torque

#: What the shipped data set hides, and how: a PUMA 560 with every parameter off, sampled at 50 Hz.
EXAMPLE = {
    "seed": 560,
    "effect": "temperature_dependent_viscous_friction",
    "axis": 3,
    "recordings": 4,
    "held_out": 0,
    "duration_s": 10.0,
    "interval_s": 0.02,
    "inertial_error": 0.03,
    "drive_error": 0.08,
    "noise": 0.02,
    "colour": 0.8,
}


def hidden_example(nominal: Robot) -> tuple[CaseData, np.ndarray, dict[str, Any]]:
    """Make the shipped data set.

    Returns
    -------
    data : what is measured. torque : (m, n) [N m] without noise. facts : what is hidden.
    """
    e = EXAMPLE
    rng = generator(e["seed"], "challenge", "example", replicate=0)
    arm = Arm(with_wrong_parameters(nominal, rng, e["inertial_error"], e["drive_error"]))
    count, samples = e["recordings"], round(e["duration_s"] / e["interval_s"])
    paths = [fourier_path(nominal, rng, rng.uniform(0.6, 1.8, nominal.joints)) for _ in range(count)]
    heat = temperatures(rng, count, nominal.joints)
    world = build_world(arm, paths, start_times(rng, count, e["duration_s"]), heat, samples, e["interval_s"])
    hidden = draw_hidden(e["effect"], scene_of(world), rng, e["axis"] - 1)
    torque, _ = total_torque(world, [hidden])
    noise = torque_noise(rng, e["noise"] * torque.std(axis=0), e["colour"], count, samples)
    s = world.state
    data = CaseData(
        time=np.round(s.time, 6),
        trajectory=s.recording,
        position=quantise(s.position, encoder_steps(rng, nominal.gear_ratio)),
        torque=(torque + noise).astype("f4"),
        temperature=quantise(s.temperature, 0.1).astype("f4"),
        velocity=None,
        acceleration=None,
        train=tuple(k for k in range(count) if k != e["held_out"]),
        test=(e["held_out"],),
    )
    return data, torque, {"effect": hidden.name, "axis": e["axis"], "form": hidden.form, "size": hidden.size}


def write_hidden_example(robot: str, output: str | Path) -> None:
    """Write the shipped data set; the file says how it was made but not what it hides."""
    data, _, _ = hidden_example(load_robot(robot))
    told = {k: v for k, v in EXAMPLE.items() if k not in ("effect", "axis")}
    write_case_data(output, data, "Simulated PUMA 560 with a hidden effect", {**told, "robot": Path(robot).name})


@dataclass(frozen=True)
class WarmTask:
    """A task that repeats for `hours` while the motors follow the day, and one axis wears.

    Attributes
    ----------
    every : hours between recordings of one cycle. interval : of the samples [s].
    axis : 1-based axis whose viscous friction follows the temperature; None: all axes.
    fall : share of the viscous friction that is lost per 20 K.
    mean, swing : of the daily temperature [degC], [K]; each motor lags behind the day by hours of its own.
    wear : growth of the Coulomb friction of `wear_axis` (1-based), or None.
    noise : standard deviation of the white torque noise over that of the axis's torque.
    """

    hours: float = 120.0
    every: float = 4.0
    interval: float = 0.1
    axis: int | None = 1
    fall: float = 0.45
    mean: float = 32.0
    swing: float = 9.0
    wear: Wear | None = None
    wear_axis: int = 1
    noise: float = 0.01


def warm_task_data(robot: Robot, task: Task, settings: WarmTask, seed: int) -> tuple[CaseData, np.ndarray]:
    """Make the torque log of a task with a temperature dependence that the nominal model lacks.

    Parameters
    ----------
    robot : the nominal robot, whose parameters are right but for what is hidden.

    Returns
    -------
    data : one trajectory a recording; every third is held out. torque : (m, n) [N m] without noise.
    """
    rng = generator(seed, "challenge", "warm", task.name, replicate=0)
    arm, n = Arm(robot), robot.joints
    hours = np.arange(0.0, settings.hours, settings.every)
    # Each recording starts at its own hour and some minutes, so that it is not bound to one time of the day.
    hours = hours + rng.uniform(0, 0.8 * settings.every, len(hours))
    clock = settings.interval * np.arange(round(task.cycle / settings.interval))
    motion = task.motion(clock)
    q, v, a = (np.tile(x, (len(hours), 1)) for x in (motion.position, motion.velocity, motion.acceleration))
    recording = np.repeat(np.arange(len(hours)), len(clock))
    time = (3600 * hours)[recording] + np.tile(clock, len(hours))
    heat = _daily_temperature(time / 3600, rng, n, settings)
    torque = arm.torque(q, v, a)
    ratio = viscosity("vogel", settings.fall)(heat)
    chosen = np.ones(n) if settings.axis is None else np.eye(n)[settings.axis - 1]
    torque = torque + chosen * robot.viscous * (ratio - 1) * v
    if settings.wear is not None:
        k = settings.wear_axis - 1
        level = np.where(v[:, k] > 0, robot.coulomb_positive[k], np.where(v[:, k] < 0, robot.coulomb_negative[k], 0.0))
        torque[:, k] += level * settings.wear.growth(time / 3600)
    noise = torque_noise(rng, settings.noise * torque.std(axis=0), 0.0, len(hours), len(clock))
    labels = range(len(hours))
    data = CaseData(
        time=np.round(time, 6),
        trajectory=recording,
        position=q,
        torque=torque + noise,
        temperature=quantise(heat, 0.1),
        velocity=v,
        acceleration=a,
        train=tuple(k for k in labels if k % 3 != 1),
        test=tuple(k for k in labels if k % 3 == 1),
    )
    return data, torque


def _daily_temperature(hour: np.ndarray, rng: np.random.Generator, joints: int, settings: WarmTask) -> np.ndarray:
    """Return motor temperatures (m, n) [degC]: the day's wave, and a slower one for the weather."""
    lag, own = rng.uniform(0, 4, joints), rng.uniform(0.8, 1.2, joints)
    weather = 0.4 * np.sin(2 * np.pi * hour / 73.0 + rng.uniform(0, 2 * np.pi))
    day = np.sin(2 * np.pi * (hour[:, None] - lag) / 24.0)
    return settings.mean + settings.swing * own * (day + weather[:, None])


def write_warm_task(robot: str, task: str, output: str | Path, settings: dict[str, Any], seed: int) -> None:
    """Write the log of a task with a hidden temperature dependence in the native layout.

    Parameters
    ----------
    settings : fields of :class:`WarmTask`, with `wear_percent`, `wear_shape` and `wear_hours` in place of `wear`.
    """
    fields = dict(settings)
    percent = fields.pop("wear_percent", None)
    shape, length = fields.pop("wear_shape", 1.5), fields.pop("wear_hours", 120.0)
    wear = None if not percent else Wear(percent, shape, length)
    data, _ = warm_task_data(load_robot(robot), load_task(task), WarmTask(**fields, wear=wear), seed)
    # What changes in the arm is not told, as in the other data set.
    told = {k: v for k, v in settings.items() if not k.startswith("wear")}
    told |= {"seed": seed, "robot": Path(robot).name, "task": Path(task).name}
    single = ("position", "velocity", "acceleration", "torque", "temperature")
    data = replace(data, **{k: getattr(data, k).astype("f4") for k in single})
    write_case_data(output, data, "Torque log of a task over many hours", told)
