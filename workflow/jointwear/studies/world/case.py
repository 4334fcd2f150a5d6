"""Make one case: robot file and log as a user would have them, and apart from them the truth."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.measurement.recording import Recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.statistics.randomness import generator
from jointwear.studies.challenge.sensors import felt_noise, quantise, torque_noise
from jointwear.studies.challenge.surroundings import start_times, temperatures
from jointwear.studies.sieve import REST
from jointwear.studies.world.arms import chain_of
from jointwear.studies.world.draws import draw_hidden_things, real_arm, subjects_of
from jointwear.studies.world.maker import Maker, controllers_of, scales_of, wanted_motion
from jointwear.studies.world.plan import SEED, Case
from jointwear.studies.world.plant import DriveParameters
from jointwear.studies.world.robot_files import write_robot
from jointwear.studies.world.setting import TEST, Setting, draw_setting
from jointwear.studies.world.truth import Judge, describe

#: Every so many held-out samples keep their noise-free torque, as the predictions of discovery do.
TRUTH_STRIDE = 5
#: Samples at the ends of a recording [s] are not judged: a filter has nothing to lean on there.
EDGE = 0.25


@dataclass(frozen=True)
class WorldCase:
    """What discovery gets (`recording`, `robot`, `told`), and the truth: `facts`, and over every fifth held-out sample
    the torque without noise, the measured one, and that of the given robot on the true motion (k, n) [N m], NaN where
    an axis is not judged."""

    recording: Recording
    robot: Robot
    told: dict[str, Any]
    facts: dict[str, Any]
    torque: np.ndarray
    measured: np.ndarray
    given: np.ndarray


def generate(case: Case, folder: str | Path, seed: int = SEED) -> WorldCase:
    """Make one case; robot file and URDF go into `folder`. The same case and seed give the same arrays.

    Raises
    ------
    InputError : if the packages of the plants are not installed.
    """
    folder = Path(folder)
    rng = generator(seed, *case.key, replicate=case.index)
    subjects = subjects_of(case, rng)
    setting = draw_setting(rng, subjects)
    kind = setting.arm
    chain = chain_of(kind.name)
    nominal = (kind.drives.coulomb, kind.drives.viscous, kind.drives.armature)
    drives = DriveParameters(*(np.array(x, dtype=float) for x in nominal))
    gear = np.array(kind.drives.gear, dtype=float)
    told_drives = drives if setting.torque != "link_sensor" else DriveParameters(*np.zeros((3, chain.joints)))
    robot = write_robot(folder, case.name, chain, told_drives, gear if setting.gear_known else np.ones_like(gear))
    believed = write_robot(folder / "truth", "believed", chain, drives, gear)
    real_chain, real_drives, wrong = real_arm(case, setting, chain, drives, rng)
    real = write_robot(folder / "truth", "real", real_chain, real_drives, gear)
    references = wanted_motion(setting, believed, rng)
    starts = start_times(rng, setting.recordings, setting.duration)
    heat = temperatures(rng, setting.recordings, chain.joints)
    scales = scales_of(setting, believed, real_chain, real_drives, references, starts)
    hidden = draw_hidden_things(subjects, scales, rng) if case.kind in ("single", "two", "outside") else []
    controllers = controllers_of(setting, believed, references)
    make = Maker(setting, real_chain, real_drives, controllers, starts, heat)
    logs = make.logs(hidden)
    clean = make.channel(logs, hidden)
    sub = slice(None, None, setting.sub)
    position, velocity, acceleration, torque, temperature = (
        np.concatenate([x[sub] for x in parts])
        for parts in (
            [log.position for log in logs],
            [log.velocity for log in logs],
            [log.acceleration for log in logs],
            clean,
            [log.temperature for log in logs],
        )
    )
    count = len(clean[0][sub])
    label = np.repeat(np.arange(setting.recordings), count)
    deviation = setting.noise * torque.std(axis=0)
    noise = torque_noise(rng, deviation, setting.colour, setting.recordings, count)
    step = _encoder_step(setting, gear)
    labels = range(setting.recordings)
    # The engine's speed belongs to half a step before the position; the logged one to the same instant.
    at_position = velocity + setting.step / 2 * acceleration
    recording = Recording(
        time=np.round(np.concatenate([log.time[sub] for log in logs]), 6),
        trajectory=label,
        position=quantise(position, step) if setting.bits else position,
        torque=torque + noise,
        velocity=at_position + rng.normal(0, 5e-4, velocity.shape) if setting.velocity else None,
        temperature=quantise(temperature + rng.normal(0, 0.05, temperature.shape), 0.1)
        if setting.temperature
        else None,
        train=tuple(k for k in labels if k != TEST),
        test=(TEST,),
        name=case.name,
    )
    facts: dict[str, Any] = {
        "case": case.name,
        "set": case.set,
        "tier": "world",
        "kind": case.kind,
        "subject": case.subject,
        "closed_loop": True,
        "arm": kind.name,
        "rate": setting.rate,
        "bits": setting.bits,
        "link_side": setting.link_side,
        "torque_kind": setting.torque,
        "controller": setting.controller,
        "motion": setting.motion,
        "inertial_error": setting.inertial_error,
        "drive_error": setting.drive_error,
        "gear_known": setting.gear_known,
        "velocity": setting.velocity,
        "temperature": setting.temperature,
        "noise": deviation.tolist(),
        "colour": setting.colour,
        "wrong_parameter": wrong,
        "effects": [],
    }
    felt = felt_noise(deviation, step, np.diag(Dynamics(believed).mass_matrix(position.mean(axis=0))), setting.rate)
    judge = Judge(setting, robot, real, felt, heat, starts, rng)
    if hidden:
        describe(facts, hidden, make, judge, logs, clean)
    if wrong:
        judge.add_energy_of_parameter(wrong, logs, chain, drives, folder)
    held = np.flatnonzero(label == TEST)[::TRUTH_STRIDE]
    clock = recording.time[held] - recording.time[label == TEST][0]
    judged = ((clock >= EDGE) & (clock <= clock[-1] - EDGE))[:, None] & (np.abs(velocity[held]) >= REST)
    told = {"torque_kind": setting.torque, "encoder_side": "link" if setting.link_side else "motor"}
    given = Dynamics(robot).inverse_dynamics(position[held], velocity[held], acceleration[held])
    torques = (np.where(judged, x, np.nan) for x in (torque[held], recording.torque[held], given))
    return WorldCase(recording, robot, told, facts, *torques)


def _encoder_step(setting: Setting, gear: np.ndarray) -> np.ndarray:
    if not setting.bits:
        return np.zeros_like(gear)
    turn = 2 * np.pi / 2.0**setting.bits
    return np.full_like(gear, turn) if setting.link_side else turn / np.abs(gear)
