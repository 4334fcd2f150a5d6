"""Which other names no method could tell from the true one on this motion: tried with the forms of the other tiers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.robots.robot import Robot
from jointwear.studies.challenge.arm import Arm
from jointwear.studies.challenge.hide import SMOOTH_ONLY, allowed_axes, draw_hidden
from jointwear.studies.challenge.motion import SampledPath
from jointwear.studies.challenge.scene import scene_of
from jointwear.studies.challenge.surroundings import Temperatures
from jointwear.studies.challenge.tiers import EFFECTS
from jointwear.studies.challenge.world import PlantState, World
from jointwear.studies.sieve import Sieve
from jointwear.studies.world.visibility import Samples

_DRAWS = 3


def tilt_terms(robot: Robot, samples: Samples) -> list[np.ndarray]:
    """Return the torque (m, n) of a base tilted by one degree about each horizontal line."""
    zero = np.zeros_like(samples.position)
    level = Arm(replace(robot, coulomb_positive=zero[0], coulomb_negative=zero[0])).torque(samples.position, zero, zero)
    terms = []
    for line in range(2):
        gravity = robot.gravity.copy()
        gravity[line] = 9.81 * np.sin(np.deg2rad(1.0))
        tilted = Arm(replace(robot, gravity=gravity, coulomb_positive=zero[0], coulomb_negative=zero[0]))
        terms.append(tilted.torque(samples.position, zero, zero) - level)
    return terms


def energies_left(
    name: str,
    axis: int | None,
    term: np.ndarray,
    robot: Robot,
    samples: Samples,
    torque: np.ndarray,
    starts: np.ndarray,
    heat: Temperatures,
    sieve: Sieve,
    rng: np.random.Generator,
) -> dict[str, float]:
    """Return for every other effect the energy of the true torque `term` (m, n) that it leaves on the same axis."""
    arm, rate = Arm(robot), samples.rate
    count = len(starts)
    size = len(samples.recording) // count
    blocks = [slice(k * size, (k + 1) * size) for k in range(count)]
    q, v, a = samples.position, samples.velocity, samples.acceleration
    paths = tuple(SampledPath(1 / rate, q[b], v[b], a[b], torque[b]) for b in blocks)
    clock = np.arange(size) / rate
    state = PlantState(
        time=np.concatenate([s + clock for s in starts]),
        recording=samples.recording,
        position=q,
        velocity=v,
        acceleration=a,
        temperature=heat.at(samples.recording, np.tile(clock, count)),
        load=arm.load(q, v, a),
        torque=torque,
    )
    world = World(arm, paths, np.asarray(starts), heat, size, 1 / rate, state)
    scene = scene_of(world)
    where = axis if axis is not None else int(np.argmax(np.sum(term**2, axis=0)))
    left = {} if name == "mounting_tilt" else {"mounting_tilt": sieve.energy(term, tilt_terms(robot, samples))}
    for rival in EFFECTS:
        if rival == name or rival in SMOOTH_ONLY or rival == "mounting_tilt":
            continue
        if rival != "payload" and where not in allowed_axes(rival, scene):
            continue
        left[rival] = sieve.energy(term, [draw_hidden(rival, scene, rng, where).term(world) for _ in range(_DRAWS)])
    return left
