"""Make one case: the data that discovery gets, and apart from it the truth that only the score may read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from jointwear.robots.robot import Robot
from jointwear.statistics.randomness import generator
from jointwear.studies.challenge.arm import Arm, with_one_wrong_parameter, with_wrong_parameters
from jointwear.studies.challenge.circumstances import Circumstances, draw_circumstances
from jointwear.studies.challenge.hide import SMOOTH_ONLY, allowed_axes, draw_hidden
from jointwear.studies.challenge.motion import Path, fourier_path, transfer_paths
from jointwear.studies.challenge.plan import Case
from jointwear.studies.challenge.scene import Scene, scene_of
from jointwear.studies.challenge.sensors import felt_noise, quantise, torque_noise
from jointwear.studies.challenge.separability import IDENTIFIABLE, sieve_world
from jointwear.studies.challenge.surroundings import start_times, temperatures
from jointwear.studies.challenge.tiers import EFFECTS, TIERS, WHOLE_ARM, Tier
from jointwear.studies.challenge.tracking import track, tuned_down
from jointwear.studies.challenge.world import Hidden, World, build_world, total_torque
from jointwear.studies.sieve import Sieve

#: The recording that is held out; never the first or last, so that nothing has to be foretold.
TEST = 2
#: Every so many samples of the held-out recording keep their noise-free torque.
TRUTH_STRIDE = 5
INERTIAL_PRIOR = 0.05
#: Standard deviation [rad/s] of the velocity where the recorder gives one.
VELOCITY_NOISE = 1e-4
#: Below this speed [rad/s] an axis rests and its friction is not judged; nor are the ends of a recording [s], where
#: a filter that makes derivatives of positions has nothing to lean on.
REST = 0.02
EDGE = 0.25
_RIVAL_DRAWS = 3


@dataclass(frozen=True)
class CaseData:
    """What is measured: arrays (m, n), `time` and `trajectory` (m,); velocity and acceleration may be None."""

    time: np.ndarray
    trajectory: np.ndarray
    position: np.ndarray
    torque: np.ndarray
    temperature: np.ndarray
    velocity: np.ndarray | None
    acceleration: np.ndarray | None
    train: tuple[int, ...]
    test: tuple[int, ...]
    told: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Truth:
    """What is hidden: facts for JSON, and over every fifth held-out sample the noise-free torque (k, n), the torque of
    each hidden effect (e, k, n), the measured torque and that of the given robot on the true motion (k, n) [N m]; NaN
    where the axis is not judged: at rest and at the ends."""

    facts: dict[str, Any]
    torque: np.ndarray
    effects: np.ndarray
    measured: np.ndarray
    given: np.ndarray


def _paths(tier: Tier, robot: Robot, rng: np.random.Generator, count: int, duration: float) -> list[Path]:
    if tier.motion == "transfer":
        return transfer_paths(robot, rng, count, duration)
    # One recording in three is slow throughout: a good excitation also creeps.
    return [
        fourier_path(robot, rng, np.exp(rng.uniform(np.log(0.5), np.log(2.0), robot.joints)) * rng.choice([0.3, 1, 1]))
        for _ in range(count)
    ]


def _draw(case: Case, scene: Scene, rng: np.random.Generator) -> list[Hidden]:
    if case.kind in ("single", "outside"):
        return [draw_hidden(case.subject, scene, rng)]
    if case.kind != "two":
        return []
    first, second = (str(x) for x in rng.choice(EFFECTS, 2, replace=False))
    one = draw_hidden(first, scene, rng)
    places = allowed_axes(second, scene)
    others = [k for k in places if k != one.axis]
    if one.axis in places and rng.random() < 0.4:
        return [one, draw_hidden(second, scene, rng, one.axis)]
    return [one, draw_hidden(second, scene, rng, int(rng.choice(others)) if others else None)]


def _real_arm(case: Case, tier: Tier, nominal: Robot, rng: np.random.Generator) -> tuple[Robot, dict[str, Any] | None]:
    robot = with_wrong_parameters(nominal, rng, tier.inertial_error, tier.drive_error)
    if case.kind != "retuned":
        return robot, None
    massive = [k for k, link in enumerate(nominal.links) if link.mass]
    axis = int(rng.choice(massive)) if case.subject == "link_inertia" else int(rng.integers(nominal.joints))
    share = float(rng.uniform(0.15, 0.40) * rng.choice([-1, 1]))
    return with_one_wrong_parameter(robot, case.subject, axis, share), {
        "parameter": case.subject,
        "axis": axis + 1,
        "share": share,
    }


def generate(case: Case, nominal: Robot, seed: int) -> tuple[CaseData, Truth]:
    """Make one case; the same case, robot and seed give the same arrays.

    Parameters
    ----------
    nominal : the robot that discovery will be given, by DH table; behind the gears where torque is sensed there.
    seed : of the whole test; the case's words are the spawn key.

    Raises
    ------
    ArmLost : if no controller keeps the arm on its paths.
    """
    rng = generator(seed, *case.key, replicate=case.index)
    tier = TIERS[case.tier]
    how = circumstances_of(case, nominal, seed)
    if how.torque == "link_sensor":
        nominal = nominal.without_drives()
    robot, wrong = _real_arm(case, tier, nominal, rng)
    arm = Arm(robot)
    count = int(rng.integers(4, 6))
    samples = round(how.duration / how.interval)
    paths = _paths(tier, nominal, rng, count, how.duration)
    starts = start_times(rng, count, how.duration)
    heat = temperatures(rng, count, nominal.joints)
    world = build_world(arm, paths, starts, heat, samples, how.interval)
    hidden = _draw(case, scene_of(world), rng)
    closed = how.controller is not None and not any(h.name in SMOOTH_ONLY for h in hidden)
    if closed:
        laws = [h.law for h in hidden if h.law is not None]
        drive = partial(
            track,
            arm,
            Arm(nominal),
            paths,
            starts,
            heat,
            how.duration,
            law=(lambda state: sum(law(state) for law in laws)) if laws else None,
            integral=how.controller == "pid",
        )
        moved = tuned_down(drive, paths, float(rng.uniform(3, 6)), nominal.name)
        world = build_world(arm, moved, starts, heat, samples, how.interval)
    torque, terms = total_torque(world, hidden)
    deviation = how.quiet * tier.noise * torque.std(axis=0)
    noise = torque_noise(rng, deviation, tier.colour, count, samples)
    data = _measure(world, torque + noise, rng, closed, how)
    # What an encoder's steps do to derived accelerations hides an effect as torque noise does.
    inertia = np.diagonal(arm.mass_matrix(world.state.position[::200]), axis1=1, axis2=2).mean(axis=0)
    felt = felt_noise(deviation, how.step, inertia, 1 / how.interval)
    train = world.state.recording != TEST
    facts: dict[str, Any] = {
        "case": case.name,
        "set": case.set,
        "tier": case.tier,
        "kind": case.kind,
        "subject": case.subject,
        "arm": nominal.name,
        "rate": round(1 / how.interval),
        "link_side": how.link_side,
        "encoder_step": how.step.tolist(),
        "torque_kind": how.torque,
        "controller": how.controller if closed else None,
        "closed_loop": bool(closed),
        "noise": deviation.tolist(),
        "wrong_parameter": wrong,
    }
    facts["effects"] = _hidden_facts(case, hidden, terms, (world, nominal, train, felt, tier.colour), rng)
    if wrong:
        facts["wrong_parameter"]["energy"] = _energy_of_parameter(wrong, world, nominal, train, felt, tier.colour)
    kept = np.flatnonzero(~train)[::TRUTH_STRIDE]
    effects = np.array([t[kept] for t in terms]).reshape(len(terms), len(kept), nominal.joints)
    hide = ~_judged(world)[kept]
    s = world.state
    given = Arm(nominal).torque(s.position[kept], s.velocity[kept], s.acceleration[kept])
    shown = (np.where(hide, np.nan, x) for x in (torque[kept], effects, data.torque[kept], given))
    return data, Truth(facts, *shown)


def _hidden_facts(
    case: Case,
    hidden: list[Hidden],
    terms: list[np.ndarray],
    seen: tuple[World, Robot, np.ndarray, np.ndarray, float],
    rng: np.random.Generator,
) -> list[dict[str, Any]]:
    """Return the facts of what is hidden, one entry for each of it.

    Parameters
    ----------
    terms : torque (m, n) of each. seen : world, nominal robot, samples (m,) of training, noise (n,) of the torque and
        its colour.
    """
    if not hidden:
        return []
    world, nominal, train, felt, colour = seen
    sieve = sieve_world(world, nominal, train, felt, colour, INERTIAL_PRIOR)
    plain = sieve_world(world, nominal, train, felt, 0.0, INERTIAL_PRIOR) if colour else sieve
    entries = []
    for k, (item, term) in enumerate(zip(hidden, terms, strict=True)):
        # The second effect must stand out beside the first one.
        other = [t for j, t in enumerate(terms) if j != k]
        entries.append(_describe(item, term, other, sieve, plain, world))
    if case.kind != "outside":
        for item, term, entry in zip(hidden, terms, entries, strict=True):
            entry["rivals"] = _rivals(item, term, world, sieve, rng) if entry["energy"] > IDENTIFIABLE else {}
    return entries


def _judged(world: World) -> np.ndarray:
    """Return where the torque of an axis is judged, (m, n)."""
    clock = np.tile(world.clock, len(world.paths))
    inside = (clock >= EDGE) & (clock <= world.clock[-1] - EDGE)
    return inside[:, None] & (np.abs(world.state.velocity) >= REST)


def circumstances_of(case: Case, nominal: Robot, seed: int) -> Circumstances:
    """Return how a case is driven and logged."""
    rng = generator(seed, *case.key, "circumstances", replicate=case.index)
    smooth = case.subject in SMOOTH_ONLY
    return draw_circumstances(rng, case.kind, case.subject, nominal.gear_ratio, smooth)


def _measure(world: World, torque: np.ndarray, rng: np.random.Generator, closed: bool, how: Circumstances) -> CaseData:
    s = world.state
    given = rng.random()
    velocity = acceleration = None
    if given > 0.5:
        velocity = s.velocity + rng.normal(0, VELOCITY_NOISE, s.velocity.shape)
    if given > 0.8 and not closed:
        acceleration = s.acceleration
    labels = range(len(world.paths))
    return CaseData(
        time=np.round(s.time, 6),
        trajectory=s.recording,
        position=np.where(how.step > 0, quantise(s.position, np.where(how.step > 0, how.step, 1.0)), s.position),
        torque=torque,
        temperature=quantise(s.temperature + rng.normal(0, 0.05, s.temperature.shape), 0.1),
        velocity=velocity,
        acceleration=acceleration,
        train=tuple(k for k in labels if k != TEST),
        test=(TEST,),
        told={"torque_kind": how.torque, "encoder_side": "link" if how.link_side else "motor"},
    )


def _describe(
    item: Hidden, term: np.ndarray, other: list[np.ndarray], sieve: Sieve, plain: Sieve, world: World
) -> dict[str, Any]:
    held = _judged(world) & (world.state.recording == TEST)[:, None]
    return {
        "effect": item.name,
        "axis": None if item.axis is None else item.axis + 1,
        "source_axis": None if item.source is None else item.source + 1,
        "also": [k + 1 for k in item.also],
        "form": item.form,
        "size": item.size,
        "unit": item.unit,
        "parameters": item.parameters,
        "energy": sieve.energy(term, other),
        "energy_unwhitened": plain.energy(term),
        "peak": np.abs(np.where(held, term, 0.0)).max(axis=0).tolist(),
    }


def _rivals(item: Hidden, term: np.ndarray, world: World, sieve: Sieve, rng: np.random.Generator) -> dict[str, float]:
    """Return for every other effect the energy of the true one that it leaves, acting on the same axis."""
    scene = scene_of(world)
    axis = item.axis if item.axis is not None else int(np.argmax(np.sum(term**2, axis=0)))
    left = {}
    for name in EFFECTS:
        if name == item.name or (name in SMOOTH_ONLY and hasattr(world.paths[0], "torque_at")):
            continue
        if name not in WHOLE_ARM and axis not in allowed_axes(name, scene):
            continue
        draws = [draw_hidden(name, scene, rng, axis).term(world) for _ in range(_RIVAL_DRAWS)]
        left[name] = sieve.energy(term, draws)
    return left


def _energy_of_parameter(
    wrong: dict[str, Any], world: World, nominal: Robot, train: np.ndarray, deviation: np.ndarray, colour: float
) -> float:
    """Return the energy of a wrong parameter of the nominal model: what its other parameters cannot take over."""
    axis, parameter = wrong["axis"] - 1, wrong["parameter"]
    sieve = sieve_world(world, nominal, train, deviation, colour, INERTIAL_PRIOR, (parameter, axis))
    right = with_one_wrong_parameter(world.arm.robot, parameter, axis, 1 / (1 + wrong["share"]) - 1)
    s = world.state
    change = world.arm.torque(s.position, s.velocity, s.acceleration) - Arm(right).torque(
        s.position, s.velocity, s.acceleration
    )
    return sieve.energy(change)
