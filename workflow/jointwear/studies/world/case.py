"""Make one case: robot file and log as a user would have them, and apart from them the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.measurement.recording import Recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot
from jointwear.statistics.randomness import generator
from jointwear.studies.challenge.motion import fourier_path, transfer_paths
from jointwear.studies.challenge.sensors import quantise, torque_noise
from jointwear.studies.challenge.separability import IDENTIFIABLE
from jointwear.studies.challenge.surroundings import Temperatures, start_times, temperatures
from jointwear.studies.world import channels, frictions, outside, structures
from jointwear.studies.world.arms import chain_of
from jointwear.studies.world.chains import Chain, with_body, with_errors
from jointwear.studies.world.control import Controller, Reference
from jointwear.studies.world.hidden import Channel, Hidden, Scales
from jointwear.studies.world.plan import EFFECTS, SEED, Case
from jointwear.studies.world.plant import DriveNumbers, compile_plant, draft
from jointwear.studies.world.rivals import energies_left
from jointwear.studies.world.robot_files import write_robot
from jointwear.studies.world.run import SETTLE, Log, run
from jointwear.studies.world.setting import Setting, draw_setting
from jointwear.studies.world.visibility import REST, Samples, Sieve, build_sieve, felt_noise

DRAW = {**frictions.DRAW, **structures.DRAW, **channels.DRAW, **outside.DRAW}

#: The recording that is held out; never the first or last.
TEST = 2
#: Every so many held-out samples keep their noise-free torque, as the predictions of discovery do.
TRUTH_STRIDE = 5
#: Samples at the ends of a recording [s] are not judged: a filter has nothing to lean on there.
EDGE = 0.25
#: Relative standard deviation of inertial parameters that a user tells discovery.
INERTIAL_PRIOR = 0.05
#: Whole-arm effects have no axis.
WHOLE_ARM = {"payload", "mounting_tilt"}
_LOADED = {
    "load_dependent_friction",
    "torque_constant_error",
    "joint_flexibility",
    "torque_constant_temperature",
    "torque_constant_ripple",
}
#: Rate [Hz] that the judgement of visibility looks at, at most.
_LOOK = 125


@dataclass(frozen=True)
class WorldCase:
    """What discovery gets (`recording`, `robot`, `told`), and the truth: `facts`, and over every fifth held-out sample
    the torque without noise and the measured one (k, n) [N m], NaN where an axis is not judged."""

    recording: Recording
    robot: Robot
    told: dict[str, Any]
    facts: dict[str, Any]
    torque: np.ndarray
    measured: np.ndarray


def generate(case: Case, folder: str | Path, seed: int = SEED) -> WorldCase:
    """Make one case; robot file and URDF go into `folder`. The same case and seed give the same arrays.

    Raises
    ------
    InputError : if the packages of the plants are not installed.
    """
    folder = Path(folder)
    rng = generator(seed, *case.key, replicate=case.index)
    subjects = _subjects(case, rng)
    setting = draw_setting(rng, subjects)
    kind = setting.arm
    chain = chain_of(kind.name)
    numbers = DriveNumbers(
        *(np.array(x, dtype=float) for x in (kind.drives.coulomb, kind.drives.viscous, kind.drives.armature))
    )
    gear = np.array(kind.drives.gear, dtype=float)
    told_drives = numbers if setting.torque != "link_sensor" else DriveNumbers(*np.zeros((3, chain.joints)))
    robot = write_robot(folder, case.name, chain, told_drives, gear if setting.gear_known else np.ones_like(gear))
    believed = write_robot(folder / "truth", "believed", chain, numbers, gear)
    real_chain, real_drives, wrong = _real_arm(case, setting, chain, numbers, rng)
    real = write_robot(folder / "truth", "real", real_chain, real_drives, gear)
    references = _references(setting, believed, rng)
    starts = start_times(rng, setting.recordings, setting.duration)
    heat = temperatures(rng, setting.recordings, chain.joints)
    scales = _scales(setting, believed, real_chain, real_drives, references, starts)
    hidden = _draw(subjects, scales, rng) if case.kind in ("single", "two", "outside") else []
    controllers = _controllers(setting, believed, references)
    make = _Maker(setting, real_chain, real_drives, controllers, starts, heat)
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
    recording = Recording(
        time=np.round(np.concatenate([log.time[sub] for log in logs]), 6),
        trajectory=label,
        position=quantise(position, step) if setting.bits else position,
        torque=torque + noise,
        velocity=velocity + rng.normal(0, 5e-4, velocity.shape) if setting.velocity else None,
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
        "wrong_number": wrong,
        "effects": [],
    }
    felt = felt_noise(deviation, step, np.diag(Dynamics(believed).mass_matrix(position.mean(axis=0))), setting.rate)
    judge = _Judge(setting, robot, real, felt, heat, starts, rng)
    if hidden:
        _describe(facts, hidden, make, judge, logs, clean)
    if wrong:
        judge.wrong_number(wrong, logs, chain, numbers, folder)
    held = np.flatnonzero(label == TEST)[::TRUTH_STRIDE]
    clock = recording.time[held] - recording.time[label == TEST][0]
    judged = ((clock >= EDGE) & (clock <= clock[-1] - EDGE))[:, None] & (np.abs(velocity[held]) >= REST)
    told = {"torque_kind": setting.torque, "encoder_side": "link" if setting.link_side else "motor"}
    return WorldCase(
        recording,
        robot,
        told,
        facts,
        np.where(judged, torque[held], np.nan),
        np.where(judged, recording.torque[held], np.nan),
    )


def _subjects(case: Case, rng: np.random.Generator) -> list[str | None]:
    if case.kind == "two":
        return [str(x) for x in rng.choice(EFFECTS, 2, replace=False)]
    return [case.subject]


def _real_arm(
    case: Case, setting: Setting, chain: Chain, drives: DriveNumbers, rng: np.random.Generator
) -> tuple[Chain, DriveNumbers, dict[str, Any] | None]:
    """Return the arm that moves: the one of the robot file with errors, and in "retuned" cases one gross error."""
    real = with_errors(chain, rng, setting.inertial_error)
    off = [np.clip(1 + setting.drive_error * rng.normal(size=chain.joints), 0.5, 1.5) for _ in range(3)]
    numbers = {
        "coulomb_friction": drives.coulomb * off[0],
        "viscous_friction": drives.viscous * off[1],
        "motor_inertia": drives.armature * off[2],
    }
    if case.kind != "retuned":
        return real, DriveNumbers(*numbers.values()), None
    axis, number = int(rng.integers(chain.joints)), str(case.subject)
    share = float(rng.uniform(0.15, 0.40) * rng.choice([-1, 1]))
    if number == "link_inertia":
        real = with_body(real, axis, real.mass[axis] * (1 + share), real.com[axis], real.inertia[axis] * (1 + share))
    else:
        numbers[number] = numbers[number].copy()
        numbers[number][axis] *= 1 + share
    return real, DriveNumbers(*numbers.values()), {"number": number, "axis": axis + 1, "share": share}


@dataclass(frozen=True)
class _Wanted:
    """The wanted motion of one recording at simulation steps, from the settling on; arrays (m, n)."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def _references(setting: Setting, robot: Robot, rng: np.random.Generator) -> list[_Wanted]:
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
    return [_Wanted(*p.at(clock if settle else np.maximum(clock, 0.0))) for p in paths]


def _controllers(setting: Setting, robot: Robot, references: Sequence[_Wanted]) -> list[Controller]:
    dynamics = Dynamics(robot)
    result = []
    for wanted in references:
        if setting.controller == "pd_gravity":
            feed = dynamics.gravity_torque(wanted.position)
        else:
            feed = dynamics.rigid_body_torque(wanted.position, wanted.velocity, wanted.acceleration)
        inertia = np.diag(dynamics.mass_matrix(wanted.position.mean(axis=0)))
        reference = Reference(wanted.position, wanted.velocity, feed)
        result.append(Controller(setting.controller, reference, inertia, setting.bandwidth, setting.step))
    return result


def _scales(setting: Setting, robot: Robot, chain: Chain, drives: DriveNumbers, references, starts) -> Scales:
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


def _draw(subjects: Sequence[str | None], scales: Scales, rng: np.random.Generator) -> list[Hidden]:
    hidden: list[Hidden] = []
    for name in subjects:
        n = scales.chain.joints
        axes = list(range(n))
        if name in _LOADED:
            axes = [k for k in axes if scales.load[k] > 0.4 * scales.drives.coulomb[k]] or [1]
        taken = [h.axis for h in hidden]
        # Two effects share an axis in two cases of five.
        free = [k for k in axes if k not in taken]
        axis = int(rng.choice(axes if rng.random() < 0.4 or not free else free))
        hidden.append(DRAW[str(name)](scales, rng, None if name in WHOLE_ARM else axis))
    return hidden


def _encoder_step(setting: Setting, gear: np.ndarray) -> np.ndarray:
    if not setting.bits:
        return np.zeros_like(gear)
    turn = 2 * np.pi / 2.0**setting.bits
    return np.full_like(gear, turn) if setting.link_side else turn / np.abs(gear)


@dataclass(frozen=True)
class _Maker:
    """Runs the plant of a case with given hidden things."""

    setting: Setting
    chain: Chain
    drives: DriveNumbers
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


class _Judge:
    """Says how well hidden things can be seen."""

    def __init__(self, setting: Setting, robot: Robot, real: Robot, noise, heat, starts, rng) -> None:
        self.setting, self.robot, self.heat, self.starts, self.rng = setting, robot, heat, starts, rng
        self.noise = noise
        keep = max(1, round(setting.rate / _LOOK))
        self.stride, self.rate = setting.sub * keep, setting.rate / keep
        # Fewer samples carry the same information where the noise is white; coloured noise fades between them.
        self.noise = noise / np.sqrt(keep) if not setting.colour else noise
        self.colour = setting.colour**keep
        if setting.torque == "link_sensor":
            zero = np.zeros(real.joints)
            real = replace(real, armature=zero, viscous=zero, coulomb_positive=zero, coulomb_negative=zero)
        self.real = real

    def samples(self, logs: Sequence[Log]) -> Samples:
        """Return the motion at the instants that are looked at."""
        q, v, a = (
            np.concatenate([getattr(log, x)[:: self.stride] for log in logs])
            for x in ("position", "velocity", "acceleration")
        )
        label = np.repeat(np.arange(len(logs)), len(q) // len(logs))
        return Samples(label, q, v, a, self.rate)

    def torque(self, clean: Sequence[np.ndarray]) -> np.ndarray:
        """Return the torque channel at these instants."""
        return np.concatenate([c[:: self.stride] for c in clean])

    def plain(self, samples: Samples) -> np.ndarray:
        """Return the torque of the same motion with nothing hidden (m, n) [N m]."""
        return Dynamics(self.real).inverse_dynamics(samples.position, samples.velocity, samples.acceleration)

    def sieve(self, samples: Samples, without: tuple[str, int] | None = None) -> Sieve:
        """Return the projection for the training recordings."""
        drives = self.setting.torque != "link_sensor"
        train = samples.recording != TEST
        return build_sieve(samples, self.robot, train, self.noise, self.colour, INERTIAL_PRIOR, drives, without)

    def wrong_number(
        self, wrong: dict[str, Any], logs: Sequence[Log], chain: Chain, drives: DriveNumbers, folder: Path
    ) -> None:
        """Add to `wrong` the energy of a wrong number of the model itself."""
        samples, axis = self.samples(logs), wrong["axis"] - 1
        names = {"coulomb_friction": "coulomb", "viscous_friction": "viscous", "motor_inertia": "armature"}
        other_chain, other = chain, drives
        if wrong["number"] == "link_inertia":
            f = 1 + wrong["share"]
            other_chain = with_body(chain, axis, chain.mass[axis] * f, chain.com[axis], chain.inertia[axis] * f)
        else:
            field = names[wrong["number"]]
            values = getattr(drives, field).copy()
            values[axis] *= 1 + wrong["share"]
            other = replace(drives, **{field: values})
        gear = np.ones(chain.joints)
        one = write_robot(folder / "truth", "one", other_chain, other, gear)
        none = write_robot(folder / "truth", "none", chain, drives, gear)
        q, v, a = samples.position, samples.velocity, samples.acceleration
        change = Dynamics(one).inverse_dynamics(q, v, a) - Dynamics(none).inverse_dynamics(q, v, a)
        wrong["energy"] = self.sieve(samples, (wrong["number"], axis)).energy(change)


def _describe(facts, hidden: Sequence[Hidden], make: _Maker, judge: _Judge, logs: Sequence[Log], clean) -> None:
    """Add to `facts` what is hidden, how well it can be seen, and what it cannot be told from."""
    samples, torque = judge.samples(logs), judge.torque(clean)
    whole = torque - judge.plain(samples)
    if len(hidden) == 1:
        terms = [whole]
    else:
        # The torque of one of two: what is there, less what is there without it; on nearly the same motion.
        terms = []
        for item in hidden:
            alone = make.logs([item])
            there = judge.samples(alone)
            terms.append(judge.torque(make.channel(alone, [item])) - judge.plain(there))
    sieve = judge.sieve(samples)
    held = (samples.recording == TEST)[:, None] & (np.abs(samples.velocity) >= REST)
    for k, (item, term) in enumerate(zip(hidden, terms, strict=True)):
        others = [t for j, t in enumerate(terms) if j != k]
        energy = sieve.energy(term, others)
        entry = {
            "effect": item.name,
            "axis": None if item.axis is None else item.axis + 1,
            "source_axis": None if item.source is None else item.source + 1,
            "also": [j + 1 for j in item.also],
            "form": item.form,
            "size": item.size,
            "unit": item.unit,
            "parameters": item.parameters,
            "energy": energy,
            "peak": np.abs(np.where(held, term, 0.0)).max(axis=0).tolist(),
        }
        if facts["kind"] != "outside":
            entry["rivals"] = (
                energies_left(
                    item.name, item.axis, term, judge.real, samples, torque, judge.starts, judge.heat, sieve, judge.rng
                )
                if energy > IDENTIFIABLE
                else {}
            )
        facts["effects"].append(entry)
