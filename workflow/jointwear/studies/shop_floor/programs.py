"""Programs of the arms: closed cycles of moves between poses, and what the bodies ask for along them.

A move takes all axes from rest to rest by a polynomial of degree seven. A run at a speed override s passes the same
path, so that the torque of the bodies is gravity(phase) + s^2 dynamic(phase): computed once per program and load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot
from jointwear.studies.shop_floor.arms import ArmType, robot_data, robot_of

#: Step of the phase [s] at full speed, and of the control loop [s].
STEP = 0.005
#: Phases from one at which a mass matrix is computed to the next.
EVERY = 25


@dataclass(frozen=True)
class Program:
    """A cycle on a grid of STEP: position and derivatives (m, n) [rad, s]; `carrying` (m,) share of the load."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    carrying: np.ndarray

    @property
    def period(self) -> float:
        """Length of a cycle at full speed [s]."""
        return len(self.position) * STEP


def draw_program(arm: ArmType, random: np.random.Generator) -> Program:
    """Draw a cycle of five to eight moves."""
    n, count = len(arm.home), int(random.integers(5, 9))
    # A program uses some axes less than others.
    use = random.uniform(0.35, 1.0, n)
    poses = np.array(arm.home) + np.array(arm.reach) * use * random.uniform(-1, 1, (count, n))
    pieces: dict[str, list[np.ndarray]] = {"q": [], "v": [], "a": [], "c": []}
    taken, given = sorted(random.choice(count, 2, replace=False))
    hurry = random.uniform(0.6, 1.0)
    for k in range(count):
        start, way = poses[k], poses[(k + 1) % count] - poses[k]
        # The fastest axis reaches its speed: the polynomial's peak is 35/16 of the mean.
        duration = max(float(np.max(np.abs(way) / np.array(arm.speed))) * 35 / 16 / hurry, 0.4)
        rest = random.uniform(0.1, 0.7)
        steps, still = round(duration / STEP), round(rest / STEP)
        u = np.arange(steps) / steps
        s = u**4 * (35 - 84 * u + 70 * u**2 - 20 * u**3)
        ds = 140 * u**3 * (1 - u) ** 3 / duration
        dds = 420 * u**2 * (1 - u) ** 2 * (1 - 2 * u) / duration**2
        zeros = np.zeros((still, n))
        pieces["q"] += [start + s[:, None] * way, np.tile(start + way, (still, 1))]
        pieces["v"] += [ds[:, None] * way, zeros]
        pieces["a"] += [dds[:, None] * way, zeros]
        loaded = float(taken <= k < given)
        pieces["c"].append(np.full(steps + still, loaded))
    carried = np.concatenate(pieces["c"])
    # Grasping takes a quarter of a second.
    kernel = np.ones(63) / 63
    carried = np.convolve(np.concatenate([carried[-31:], carried, carried[:31]]), kernel, mode="valid")
    return Program(*(np.concatenate(pieces[k]) for k in ("q", "v", "a")), carried)


@dataclass(frozen=True)
class Job:
    """A program with a load, at every phase.

    `program`; `true` and `model` (m, 2, n): gravity and dynamic torque [N m] at full speed of the arm as built with its
    load, and of the robot file without; `inertia` (n,) mean diagonal of the mass matrix [kg m2] as built, `nominal`
    (m, n) that of the robot file along the path; `load` (m, 2, 4, n): what unit loads add to gravity and dynamic
    torque at full speed, :class:`jointwear.robots.flange.FlangeLoad`.
    """

    program: Program
    true: np.ndarray
    model: np.ndarray
    inertia: np.ndarray
    nominal: np.ndarray
    load: np.ndarray


def bodies_along(robot: Robot, program: Program) -> np.ndarray:
    """Return gravity and dynamic torque (m, 2, n) of a robot at full speed [N m]."""
    dynamics = Dynamics(robot)
    gravity = dynamics.gravity_torque(program.position)
    rigid = dynamics.rigid_body_torque(program.position, program.velocity, program.acceleration)
    return np.stack([gravity, rigid - gravity], axis=1)


def inertia_along(robot: Robot, program: Program) -> np.ndarray:
    """Return the diagonal of the mass matrix along the path (m, n) [kg m2], computed at every 25th phase."""
    dynamics = Dynamics(robot)
    index = np.arange(0, len(program.position), EVERY)
    coarse = np.einsum("mjj->mj", dynamics.mass_matrix(program.position[index]))
    phases = np.arange(len(program.position))
    return np.stack([np.interp(phases, index, c) for c in coarse.T], axis=1)


class Jobs:
    """The jobs of one arm, each computed when first asked for."""

    def __init__(self, arm: ArmType, programs: list[Program], built: dict) -> None:
        self._arm, self._programs, self._built = arm, programs, built
        self._known: dict[tuple[int, float], Job] = {}

    def __call__(self, program: int, mass: float) -> Job:
        """Return the job of a program with a load [kg]."""
        key = (program, mass)
        if key not in self._known:
            self._known[key] = self._make(self._programs[program], mass)
        return self._known[key]

    def _make(self, program: Program, mass: float) -> Job:
        nominal = robot_of(robot_data(self._arm))
        bare = robot_of(self._built)
        true = bodies_along(bare, program)
        if mass > 0:
            loaded = robot_of({**self._built, "payload": {**self._built["payload"], "mass": mass}})
            true = true + program.carrying[:, None, None] * (bodies_along(loaded, program) - true)
        diagonal = inertia_along(nominal, program)
        unit = FlangeLoad(nominal).unit(program.position, program.velocity, program.acceleration)
        return Job(
            program, true, bodies_along(nominal, program), inertia_along(bare, program).mean(axis=0), diagonal,
            np.moveaxis(unit, 0, 1),
        )  # fmt: skip
