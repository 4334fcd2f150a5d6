"""Make one case: robot file and log as a user would have them, and apart from them the truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

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
from jointwear.studies.world.run import Log
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
    told_drives = drives if setting.motors_in_file else DriveParameters(*np.zeros((3, chain.joints)))
    robot = write_robot(folder, case.name, chain, told_drives, gear if setting.gear_known else np.ones_like(gear))
    believed = write_robot(folder / "truth", "believed", chain, drives, gear)
    real_chain, real_drives, wrong = real_arm(case, setting, chain, drives, rng)
    real = write_robot(folder / "truth", "real", real_chain, real_drives, gear)
    references = wanted_motion(setting, believed, rng)
    starts = start_times(rng, setting.recordings, setting.duration)
    heat = temperatures(rng, setting.recordings, chain.joints)
    scales = scales_of(setting, believed, real_chain, real_drives, references, starts)
    hidden = draw_hidden_things(subjects, scales, rng) if case.kind in ("single", "two", "outside") else []
    controllers = controllers_of(setting, believed, gear, references)
    make = Maker(setting, real_chain, real_drives, controllers, starts, heat)
    logs = make.logs(hidden)
    clean = make.channel(logs, hidden)
    true = _Samples.of(logs, clean, setting.sub)
    deviation = setting.noise * true.torque.std(axis=0)
    step = setting.encoder_step(setting.bits, gear)
    recording = _logged(case.name, setting, true, _shown_velocity(logs, setting), deviation, step, rng)
    seen = np.hypot(deviation, make.answer_to_steps(logs))
    felt = felt_noise(seen, step, np.diag(Dynamics(believed).mass_matrix(true.position.mean(axis=0))), setting.rate)
    judge = Judge(setting, robot, real, felt, heat, starts, rng)
    facts = _circumstances(case, setting) | {"noise": deviation.tolist(), "wrong_parameter": wrong, "effects": []}
    if hidden:
        describe(facts, hidden, make, judge, logs, clean)
    if wrong:
        judge.add_energy_of_parameter(wrong, logs, chain, drives, folder)
    told = {"torque_kind": setting.torque, "encoder_side": "link" if setting.link_side else "motor"}
    return WorldCase(recording, robot, told, facts, *_held_out(recording, robot, true))


@dataclass(frozen=True)
class _Samples:
    """What is true at the samples that are logged: `time` (m,) [s], `label` (m,), the others (m, n); the speed of the
    engine belongs to half a step before the position."""

    time: np.ndarray
    label: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    temperature: np.ndarray

    @classmethod
    def of(cls, logs: Sequence[Log], torque: Sequence[np.ndarray], every: int) -> _Samples:
        """Return every so many samples of the logs, with the torque (k, n) of each."""

        def joined(name: str) -> np.ndarray:
            return np.concatenate([getattr(log, name)[::every] for log in logs])

        parts = [x[::every] for x in torque]
        label = np.repeat(np.arange(len(parts)), len(parts[0]))
        motion = (joined(name) for name in ("position", "velocity", "acceleration"))
        return cls(joined("time"), label, *motion, np.concatenate(parts), joined("temperature"))


def _shown_velocity(logs: Sequence[Log], setting: Setting) -> np.ndarray:
    """Return the velocity (k, n) [rad/s] that a controller shows of the logged samples, without noise."""
    keep = np.exp(-setting.step / setting.velocity_lag) if setting.velocity_lag else 0.0
    shown = []
    for log in logs:
        # The logged speed belongs to the same instant as the position.
        now = log.velocity + setting.step / 2 * log.acceleration
        late, _ = lfilter([1 - keep], [1.0, -keep], now, axis=0, zi=keep * now[:1])
        shown.append(late[:: setting.sub])
    return np.concatenate(shown)


def _logged(
    name: str,
    setting: Setting,
    true: _Samples,
    velocity: np.ndarray,
    deviation: np.ndarray,
    step: np.ndarray,
    rng: np.random.Generator,
) -> Recording:
    """Return what is logged of the true motion.

    Parameters
    ----------
    velocity : (k, n) as the controller shows it. deviation : (n,) standard deviation of the torque [N m].
    step : (n,) of the encoders [rad].
    """
    count = len(true.time) // setting.recordings
    noise = torque_noise(rng, deviation, setting.colour, setting.recordings, count)
    labels = range(setting.recordings)
    return Recording(
        time=np.round(true.time, 6),
        trajectory=true.label,
        position=quantise(true.position, step) if setting.bits else true.position,
        torque=true.torque + noise,
        velocity=velocity + rng.normal(0, 5e-4, velocity.shape) if setting.velocity else None,
        temperature=quantise(true.temperature + rng.normal(0, 0.05, true.temperature.shape), 0.1)
        if setting.temperature
        else None,
        train=tuple(k for k in labels if k != TEST),
        test=(TEST,),
        name=name,
    )


def _circumstances(case: Case, setting: Setting) -> dict[str, Any]:
    """Return which case it is, and how its arm is driven and logged."""
    return {
        "case": case.name,
        "set": case.set,
        "tier": "world",
        "kind": case.kind,
        "subject": case.subject,
        "closed_loop": True,
        "arm": setting.arm.name,
        "rate": setting.rate,
        "bits": setting.bits,
        "bits_read": setting.bits_read,
        "link_side": setting.link_side,
        "torque_kind": setting.torque,
        "motors_in_file": setting.motors_in_file,
        "controller": setting.controller,
        "motion": setting.motion,
        "inertial_error": setting.inertial_error,
        "drive_error": setting.drive_error,
        "gear_known": setting.gear_known,
        "velocity": setting.velocity,
        "velocity_lag": setting.velocity_lag if setting.velocity else 0.0,
        "temperature": setting.temperature,
        "colour": setting.colour,
    }


def _held_out(recording: Recording, robot: Robot, true: _Samples) -> Iterator[np.ndarray]:
    """Return true torque, measured one and that of the given robot (k, n) [N m], NaN where an axis is not judged."""
    held = np.flatnonzero(true.label == TEST)[::TRUTH_STRIDE]
    clock = recording.time[held] - recording.time[true.label == TEST][0]
    inside = (clock >= EDGE) & (clock <= clock[-1] - EDGE)
    judged = inside[:, None] & (np.abs(true.velocity[held]) >= REST)
    given = Dynamics(robot).inverse_dynamics(true.position[held], true.velocity[held], true.acceleration[held])
    return (np.where(judged, x, np.nan) for x in (true.torque[held], recording.torque[held], given))
