"""Run a plant under its controller, recording after recording, and keep what sensors could see at every step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.studies.challenge.surroundings import Temperatures
from jointwear.studies.challenge.tracking import ArmLost, follows
from jointwear.studies.world.control import Controller
from jointwear.studies.world.hidden import Hidden, Instant
from jointwear.studies.world.packages import mujoco
from jointwear.studies.world.plant import DriveParameters, Plant

#: Time [s] before each recording in which the controller settles.
SETTLE = 0.4


@dataclass(frozen=True)
class Log:
    """One recording at simulation steps; arrays (m, n): motion of the encoders' side, `command`, `applied` and
    `sensed` torque [N m] (of the drive, and behind the gear), temperature [degC]; `clock`, `time` (m,) [s]."""

    clock: np.ndarray
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    command: np.ndarray
    applied: np.ndarray
    sensed: np.ndarray
    temperature: np.ndarray


def run(
    plant: Plant,
    controllers: Sequence[Controller],
    hidden: Sequence[Hidden],
    drives: DriveParameters,
    starts: np.ndarray,
    heat: Temperatures,
    link_side: bool,
) -> list[Log]:
    """Run the recordings.

    Parameters
    ----------
    controllers : one a recording, with references from `SETTLE` before its start.
    link_side : the encoders that are logged see the links, not the motors.

    Raises
    ------
    ArithmeticError : if a plant cannot be integrated with its time step; an `ArmLost` where its controller loses it.
    """
    return [
        _one(plant, controller, hidden, drives, k, float(starts[k]), heat, link_side)
        for k, controller in enumerate(controllers)
    ]


def _start(plant: Plant, controller: Controller, hidden: Sequence[Hidden]) -> None:
    engine, model, data = mujoco(), plant.model, plant.data
    engine.mj_resetData(model, data)
    data.qpos[plant.motor] = controller.reference.position[0]
    data.qvel[plant.motor] = controller.reference.velocity[0]
    for item in hidden:
        if "start_on_path" in item.facts:
            wheel = model.joint("wheel").qposadr[0]
            data.qpos[wheel] = data.qpos[model.joint(item.facts["start_on_path"]).qposadr[0]]


def _one(
    plant: Plant,
    controller: Controller,
    hidden: Sequence[Hidden],
    drives: DriveParameters,
    recording: int,
    start: float,
    heat: Temperatures,
    link_side: bool,
) -> Log:
    engine, model, data = mujoco(), plant.model, plant.data
    _start(plant, controller, hidden)
    controller.restart()
    step, motor = controller.step, plant.motor
    count, n = len(controller.reference.position), len(motor)
    clock = step * np.arange(count) - SETTLE
    temperature = heat.at(np.full(count, recording), np.maximum(clock, 0.0))
    # One block for all quantities keeps the loop to one assignment each.
    position, velocity, acceleration, command, applied, sensed = np.empty((6, count, n))
    elastic = np.flatnonzero(plant.elastic >= 0)
    hooks = [h.step for h in hidden if h.step is not None]
    lags = [(h.axis, *h.lag) for h in hidden if h.lag is not None]
    late = {axis: (np.exp(-step / lag) if lag else 0.0, round(dead / step)) for axis, lag, dead in lags}
    filtered: dict[int, float] = {}
    now = Instant(plant, 0.0, 0.0, recording, *np.zeros((7, n)))
    damping = model.dof_damping
    armature = model.dof_armature[motor]
    force = np.zeros(n)
    for k in range(count):
        q, v = data.qpos[motor], data.qvel[motor]
        if link_side and len(elastic):
            seen_q, seen_v = plant.link_position(), plant.link_velocity()
        else:
            seen_q, seen_v = q, v
        position[k], velocity[k] = seen_q, seen_v
        # Controllers close their loops on the motors: through a gear that swings they would not be stable.
        asked = controller.torque(k, q, v)
        command[k] = asked
        torque = asked
        for axis, (keep, dead) in late.items():
            torque = torque.copy()
            value = command[max(k - dead, 0), axis]
            filtered[axis] = value if k == 0 else keep * filtered[axis] + (1 - keep) * value
            torque[axis] = filtered[axis]
        applied[k] = torque
        if hooks:
            now.time, now.clock = start + max(clock[k], 0.0), clock[k]
            now.position, now.velocity, now.temperature = q, v, temperature[k]
            now.friction, now.damping, now.force = drives.coulomb.copy(), drives.viscous.copy(), np.zeros(n)
            for hook in hooks:
                hook(now)
            model.dof_frictionloss[motor] = np.maximum(now.friction, 1e-6)
            damping[motor] = np.maximum(now.damping, 0.0)
            force = now.force
        data.qfrc_applied[motor] = torque + force
        engine.mj_step(model, data)
        a = data.qacc[motor]
        acceleration[k] = a
        sensed[k] = torque + data.qfrc_constraint[motor] + data.qfrc_damper[motor] - armature * a
        now.load = sensed[k]
        if link_side and len(elastic):
            acceleration[k, elastic] += data.qacc[plant.elastic[elastic]]
    if any(warning.number for warning in data.warning):
        raise ArithmeticError(f"the plant of recording {recording} is unstable with a step of {step:g} s")
    if not follows(position, controller.reference.position):
        raise ArmLost(f"the controller loses the arm in recording {recording}")
    kept = slice(round(SETTLE / step), None)
    return Log(
        clock[kept],
        start + clock[kept],
        *(x[kept] for x in (position, velocity, acceleration, command, applied, sensed, temperature)),
    )
