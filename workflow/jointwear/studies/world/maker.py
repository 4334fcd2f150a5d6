"""The wanted motion of a case, its controllers, and the plant that is run with given hidden things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.studies.challenge.motion import fourier_path, transfer_paths
from jointwear.studies.challenge.surroundings import Temperatures
from jointwear.studies.world.chains import Chain
from jointwear.studies.world.control import Controller, Reader, Reference
from jointwear.studies.world.hidden import Channel, Hidden, Scales
from jointwear.studies.world.plant import DriveParameters, compile_plant, draft
from jointwear.studies.world.run import SETTLE, Log, run
from jointwear.studies.world.setting import Setting


@dataclass(frozen=True)
class Wanted:
    """The wanted motion of one recording at simulation steps, from the settling on; arrays (m, n)."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def wanted_motion(setting: Setting, robot: Robot, rng: np.random.Generator) -> list[Wanted]:
    """Draw the motion of every recording: Fourier series, one in three slow throughout, or pick and place."""
    count = setting.recordings
    if setting.motion == "transfer":
        paths = transfer_paths(robot, rng, count, setting.duration)
        settle = 0.0
    else:
        pace = setting.arm.drives.speed
        paths = [
            fourier_path(robot, rng, pace * np.exp(rng.uniform(-0.7, 0.5, robot.joints)) * rng.choice([0.3, 1, 1]))
            for _ in range(count)
        ]
        settle = SETTLE
    samples = round(setting.duration * setting.rate) * setting.sub
    clock = setting.step * np.arange(-round(SETTLE / setting.step), samples)
    # A pick-and-place starts at rest, a periodic motion has no start.
    return [Wanted(*p.at(clock if settle else np.maximum(clock, 0.0))) for p in paths]


def controllers_of(setting: Setting, robot: Robot, gear: np.ndarray, references: Sequence[Wanted]) -> list[Controller]:
    """Return a controller for every recording, which knows the nominal robot; `gear` (n,) are the true ratios."""
    dynamics = Dynamics(robot)
    result = []
    for wanted in references:
        if setting.controller == "pd_gravity":
            feed = dynamics.gravity_torque(wanted.position)
        else:
            feed = dynamics.rigid_body_torque(wanted.position, wanted.velocity, wanted.acceleration)
        inertia = np.diag(dynamics.mass_matrix(wanted.position.mean(axis=0)))
        reference = Reference(wanted.position, wanted.velocity, feed)
        reader = Reader(setting.encoder_step(setting.bits_read, gear), setting.step)
        result.append(Controller(setting.controller, reference, inertia, setting.bandwidth, setting.step, reader))
    return result


def scales_of(setting: Setting, robot: Robot, chain: Chain, drives: DriveParameters, references, starts) -> Scales:
    """Return from what the sizes of hidden things are drawn."""
    q, v, a = (
        np.concatenate([getattr(w, x)[::20] for w in references]) for x in ("position", "velocity", "acceleration")
    )
    dynamics = Dynamics(robot)
    load = dynamics.rigid_body_torque(q, v, a) - robot.armature * a
    return Scales(
        chain=chain,
        drives=drives,
        kind=setting.arm.drives,
        gear=np.array(setting.arm.drives.gear, dtype=float),
        low=q.min(axis=0),
        high=q.max(axis=0),
        speed=np.abs(v).max(axis=0),
        load=np.sqrt(np.mean(load**2, axis=0)),
        inertia=np.diag(dynamics.mass_matrix(q.mean(axis=0))),
        span=float(starts[-1] + setting.duration),
        starts=starts,
        duration=setting.duration,
        rate=float(setting.rate),
    )


@dataclass(frozen=True)
class Maker:
    """Runs the plant of a case with given hidden things."""

    setting: Setting
    chain: Chain
    drives: DriveParameters
    controllers: list[Controller]
    starts: np.ndarray
    heat: Temperatures

    def logs(self, hidden: Sequence[Hidden]) -> list[Log]:
        """Return what happens, one log a recording."""
        drafted = draft(self.chain, self.drives, self.setting.step)
        for item in hidden:
            if item.build is not None:
                item.build(drafted)
        plant = compile_plant(drafted)
        return run(plant, self.controllers, hidden, self.drives, self.starts, self.heat, self.setting.link_side)

    def answer_to_steps(self, logs: Sequence[Log]) -> np.ndarray:
        """Return the standard deviation (n,) [N m] of what the controllers command because encoders have steps.

        It is in the torque of a sample, and too fast for what is derived from the positions of a log.
        """
        told = [c.answer_to_steps(log.position) for c, log in zip(self.controllers, logs, strict=True)]
        return np.concatenate(told).std(axis=0)

    def channel(self, logs: Sequence[Log], hidden: Sequence[Hidden]) -> list[np.ndarray]:
        """Return the torque (m, n) that the recorder gets of each log, without noise."""
        result = []
        for log in logs:
            torque = {"motor": log.applied, "command": log.command, "link_sensor": log.sensed}[self.setting.torque]
            # A drive that lags shows in what is asked of it.
            for item in hidden:
                if item.facts.get("command") and self.setting.torque == "motor":
                    torque = torque.copy()
                    torque[:, item.axis] = log.command[:, item.axis]
            for item in hidden:
                if item.channel is not None:
                    seen = Channel(self.setting.step, log.time, log.position, log.velocity, log.temperature, torque)
                    torque = item.channel(seen)
            result.append(torque)
        return result
