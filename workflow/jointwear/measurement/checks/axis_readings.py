"""Ways in which the columns of a recording may have to be read, and how likely the nominal model makes each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from jointwear.files.wording import listed, numbered
from jointwear.measurement.stated import Stated
from jointwear.measurement.units import POSITION_WORDS, size_of, sizes_of
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.inertia import bodies, inertial_regressor, prior_factor, to_joint_frame
from jointwear.robots.robot import Robot

#: Samples that the likelihood looks at: apart by more than noise remembers, so that they count as independent.
INDEPENDENT = 200
#: Relative standard deviations of the inertial parameters and of the drive parameters of a nominal model.
INERTIAL_ERROR, DRIVE_ERROR = 0.05, 0.3
#: Standard deviation of friction, and of motor inertia, where the robot file has none (0 stands for unknown): share of
#: the torque of the axis.
DRIVE_UNKNOWN = 0.5
#: A payload that nobody wrote down, standard deviations: share of the mass of the arm, and its lever [m]. Arms carry
#: up to a fifth of their own mass, two of these.
PAYLOAD_SHARE, PAYLOAD_LEVER = 0.1, 0.15
#: Share of the squared torque of an axis that a nominal model always leaves, 3 % of the torque: ripple, friction of
#: another form, work pieces that change. Below it a better fit says nothing about the way in which an axis is read.
MODEL_ERROR = 1e-3
#: What the zero of a joint differs by between conventions [rad].
ZEROS = (0.5 * np.pi, -0.5 * np.pi, np.pi)
#: Cosine of the angle between two axes from which they count as parallel.
PARALLEL = 0.999
#: What two axes exchange, of position, velocity, acceleration and torque, by kind of reading.
EXCHANGED = {"swap": slice(0, 4), "positions": slice(0, 3), "torques": slice(3, 4)}
#: Rounds in which the parameters of the model and the noise of each axis are found in turn.
ROUNDS = 8


@dataclass(frozen=True)
class Reading:
    """One way to read a recording: "swap" two axes, their "torques" or their "positions" alone, "flip" one or more,
    turn the "torque" or the "position" of one or more around, take it as of the "motor", add an angle
    [rad] to its position, that is count it from another "zero", take off that of the joint before it, times a factor,
    that is count it from the "base", multiply it by a factor, that is take it in another "unit", or divide the torques
    of some by a factor each, that is take them in another "scale".

    `axes` are 0-based.
    """

    kind: str
    axes: tuple[int, ...]
    angle: float = 0.0
    factors: tuple[float, ...] = ()

    @property
    def reason(self) -> str:
        """What a recording looks like that has to be read this way."""
        return {
            "swap": f"{self._joints} look swapped",
            "torques": f"the torques of {self._joints} look swapped",
            "positions": f"the positions of {self._joints} look swapped",
            "flip": f"the sign of {self._joints} looks flipped",
            "torque": f"the sign of the torque of {self._joints} looks flipped",
            "position": f"the sign of the position of {self._joints} looks flipped",
            "motor": f"the torque of {self._joints} looks like that of the motor, before the gear",
            "zero": f"the position of {self._joints} looks counted from another zero, {self._degrees} deg off",
            "base": f"the position of {self._joints} looks counted from the base, as by some controllers, and not from "
            "the link before it",
            "unit": f"the position of {self._joints} looks like {self._unit}, those of the others do not",
            "scale": f"the torque of {self._joints} is {_figures(self.factors)} times that of the model, friction "
            "included",
        }[self.kind]

    @property
    def remedy(self) -> str:
        """How to mend such a recording."""
        return self.remedy_beside(Stated())

    def remedy_beside(self, stated: Stated) -> str:
        """Return how to mend such a recording where its configuration has `stated` units and factors already."""
        verb, to = ("add", "to") if self.factors and self.factors[0] < 0 else ("subtract", "from")
        advised = {
            "swap": f"exchange the columns of {self._joints}: name them in order under 'variables'",
            "torques": f"exchange the torques of {self._joints}: name the columns of 'torque' in order "
            "under 'variables'",
            "positions": f"exchange the positions of {self._joints}: name the columns of 'position' in "
            "order under 'variables'",
            "flip": f"turn the sign of position and torque of {self._joints}: give 'sign' with -1 for {self._them}",
            "torque": f"turn the sign of the torque of {self._joints}: give 'scale' with -1 for {self._them}",
            "position": f"turn the sign of the position of {self._joints}: give 'sign' and 'scale' with -1 "
            f"for {self._them}",
            "motor": "multiply the torque by the gear ratio: give it as 'scale' for each joint",
            "zero": f"add {self._degrees} deg to the position of {self._joints}, or {self.angle:.5g} rad to its "
            "'offset' in the robot file",
            "base": f"{verb} the position of joint {self.axes[0]} {to} that of {self._joints}",
            "unit": f"write the position of {self._joints} in the unit of the others: it is {self._unit} as read",
            "scale": f"give 'scale' with {_figures([1 / f for f in self.factors])} for {self._joints}, or "
            "'torque_constant' in N m/A for a current",
        }[self.kind]
        mends = {
            "flip": {"sign": -1.0},
            "torque": {"scale": -1.0},
            "position": {"sign": -1.0, "scale": -1.0},
        }.get(self.kind, {})
        wanted = {key: dict.fromkeys(self.axes, factor) for key, factor in mends.items()}
        if self.kind == "scale":
            wanted = {"scale": {a: 1 / f for a, f in zip(self.axes, self.factors, strict=True)}}
        told = {key: stated.instead(key, factors) for key, factors in wanted.items()}
        if not any(told.values()):
            return advised
        return " and ".join(words or f"give '{key}' with -1 for {self._joints}" for key, words in told.items())

    def looks_like(self, stated: Stated) -> str:
        """Return the unit of the positions of a joint that is read in another "unit"; empty where none is of that
        size."""
        sizes = sizes_of("position")
        size = size_of("position", stated.units.get("position") or "rad") * self.factors[0]
        return next((unit for unit, known in sizes.items() if math.isclose(size, known, rel_tol=1e-6)), "")

    @property
    def by_keys(self) -> bool:
        """Whether keys of the configuration mend such a recording; one joint has no unit of its own there, and none is
        counted with another."""
        return self.kind not in ("unit", "base")

    @property
    def several(self) -> bool:
        """Whether more joints than one are turned around, each for itself."""
        return self.kind in ("flip", "torque", "position") and len(self.axes) > 1

    @property
    def _them(self) -> str:
        return "each" if self.several else "it"

    @property
    def _joints(self) -> str:
        return numbered("joint", [axis + 1 for axis in self.axes])

    @property
    def _unit(self) -> str:
        degrees, radians = POSITION_WORDS["deg"], POSITION_WORDS["rad"]
        return degrees if self.factors and self.factors[0] < 1 else f"{radians} taken for {degrees}"

    @property
    def _degrees(self) -> str:
        return f"{np.degrees(self.angle):.4g}"

    def read(self, parts: np.ndarray, usable: np.ndarray, robot: Robot) -> tuple[np.ndarray, np.ndarray]:
        """Return positions, velocities, accelerations and torques (m, 4, n), and usable (m, n), read this way."""
        turned = parts.copy()
        if self.kind in EXCHANGED:
            rows, there, from_there = EXCHANGED[self.kind], list(self.axes), self.axes[::-1]
            turned[:, rows, there] = parts[:, rows, from_there]
            known = usable.copy()
            if self.kind != "torques":
                known[:, there] = usable[:, from_there]
            # What was usable with the torque of its own axis may meet a missing one.
            return turned, known & np.isfinite(turned[:, 3])
        if self.kind == "scale":
            turned[:, 3, list(self.axes)] /= self.factors
            return turned, usable
        if self.kind == "flip":
            turned[:, :, list(self.axes)] *= -1.0
            return turned, usable
        if self.kind == "torque":
            turned[:, 3, list(self.axes)] *= -1.0
            return turned, usable
        if self.kind == "position":
            turned[:, :3, list(self.axes)] *= -1.0
            return turned, usable
        (axis,) = self.axes
        if self.kind == "zero":
            turned[:, 0, axis] += self.angle
        elif self.kind == "base":
            turned[:, :3, axis] -= self.factors[0] * parts[:, :3, axis - 1]
        elif self.kind == "unit":
            turned[:, :3, axis] *= self.factors[0]
        else:
            turned[:, 3, axis] *= robot.gear_ratio[axis]
        return turned, usable


def _figures(values: Sequence[float]) -> str:
    return listed([f"{value:.3g}" for value in values]) if values else ""


def readings(robot: Robot) -> Iterator[Reading]:
    """Yield every other way to read a recording of `robot`."""
    for pair in combinations(range(robot.joints), 2):
        for kind in EXCHANGED:
            yield Reading(kind, pair)
    for axis in range(robot.joints):
        yield Reading("flip", (axis,))
        yield Reading("torque", (axis,))
        yield Reading("position", (axis,))
        for angle in ZEROS:
            yield Reading("zero", (axis,), angle)
        if abs(robot.gear_ratio[axis]) > 2:
            yield Reading("motor", (axis,))
    axes = FlangeLoad(robot).axes(np.zeros((1, robot.joints)))[0]
    for axis in range(1, robot.joints):
        # The angle between neighbours is the same at all positions.
        if abs(axes[axis - 1] @ axes[axis]) > PARALLEL:
            for sign in (1.0, -1.0):
                yield Reading("base", (axis,), factors=(sign,))


def all_turned(robot: Robot) -> Iterator[Reading]:
    """Yield the readings that turn the torques of all joints around, their positions, or both, as an export with
    another convention does."""
    for kind in ("torque", "position", "flip"):
        yield Reading(kind, tuple(range(robot.joints)))


def units_of_one(robot: Robot, position: np.ndarray) -> Iterator[Reading]:
    """Yield the readings of single axes in degrees where they leave their limits, and in radians where those do not.

    Parameters
    ----------
    position : (m, n) [rad], as read.
    """
    reach = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
    largest = np.abs(position).max(axis=0, initial=0.0)
    for axis in range(robot.joints):
        if largest[axis] > reach[axis]:
            yield Reading("unit", (axis,), factors=(np.pi / 180,))
        elif 0 < largest[axis] * 180 / np.pi <= reach[axis]:
            yield Reading("unit", (axis,), factors=(180 / np.pi,))


def other_scale(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> Reading | None:
    """Return the reading under which each torque has the size of the model's, None where all have by and large.

    Of joints that hardly carry anything friction tells the scale. A joint counts whose factor no drive parameter
    within three standard deviations explains.

    Parameters
    ----------
    parts : (m, 4, n) as of :meth:`Reading.read`. usable : (m, n) bool.
    """
    robot = dynamics.robot
    q, v, a, torque = (parts[:, k] for k in range(4))
    level = np.where(v > 0, robot.coulomb_positive, robot.coulomb_negative)
    model = np.where(usable, dynamics.rigid_body_torque(q, v, a) + level + robot.viscous * v, 0.0)
    shared = np.sum(model * np.where(usable, torque, 0.0), axis=0)
    factor = shared / np.maximum(np.sum(model**2, axis=0), 1e-12)
    axes = np.flatnonzero(
        (factor > 0) & (np.abs(np.log(np.where(factor > 0, factor, 1.0))) > np.log1p(3 * DRIVE_ERROR))
    )
    return Reading("scale", tuple(axes.tolist()), factors=tuple(factor[axes].tolist())) if len(axes) else None


def payload_std(robot: Robot) -> np.ndarray:
    """Return standard deviations (10,) of the inertial parameters of an unknown body at the flange."""
    mass = PAYLOAD_SHARE * sum(b[0] for b in bodies(robot))
    return np.array([mass, *[mass * PAYLOAD_LEVER] * 3, *[mass * PAYLOAD_LEVER**2] * 6])


@dataclass(frozen=True)
class _OfMotion:
    """What the model says of a motion of m samples: the torque of the rigid bodies (m, n), and for each axis what
    deviations of the bodies do to it, (k, m) for those that the axis feels, with their numbers (k,)."""

    rigid: np.ndarray
    columns: list[np.ndarray]
    parameters: list[np.ndarray]


class Likelihood:
    """How likely a nominal model makes a recording when its parameters may be as wrong as such parameters are.

    Friction, motor inertia, inertial parameters and a payload have Gaussian priors; what they leave is noise of a
    size that the data tell. So what a wrong parameter, or a body at the flange, does to the torque speaks against no
    reading, and friction of a size that no such drive has does.
    """

    def __init__(self, dynamics: Dynamics, fewest: int) -> None:
        self._dynamics, self._fewest = dynamics, fewest
        robot = dynamics.robot
        links = prior_factor(robot, INERTIAL_ERROR)
        tip = np.zeros((len(links), 10))
        tip[-10:] = to_joint_frame(robot, robot.joints - 1) * payload_std(robot)
        self._factor = np.concatenate([links, tip], axis=1)
        self._first: tuple[np.ndarray, _OfMotion] | None = None
        self._drives = np.stack([robot.coulomb_positive, robot.coulomb_negative, robot.viscous, robot.armature], axis=1)

    def __call__(self, parts: np.ndarray, usable: np.ndarray) -> float:
        """Return the log likelihood [nats] of samples (m, 4, n), up to what does not depend on how they are read."""
        step = max(1, len(parts) // INDEPENDENT)
        parts, usable = parts[::step], usable[::step]
        bodies = self._of_motion(parts[:, :3])
        n, shared = usable.shape[1], self._factor.shape[1]
        products, counts = [], []
        for j in range(n):
            used = usable[:, j]
            if used.sum() * step < self._fewest:
                continue
            v, a, torque = parts[used, 1:, j].T
            size = max(float(np.sqrt(np.mean(torque**2))), 1e-12)
            columns = np.stack([v > 0, v < 0, v, a])
            motion = columns * self._drives[j][:, None]
            # Motor inertia is part of the rigid-body torque.
            rest = torque - bodies.rigid[used, j] - motion[:3].sum(axis=0)
            # What moves the axis: its own drive, and the bodies behind it. Of all others the products are none.
            moving = bodies.parameters[j]
            rows = np.concatenate(
                [columns * self._drive_error(j, columns, size)[:, None], bodies.columns[j][:, used], rest[None]]
            )
            rows /= size
            at = np.concatenate([4 * j + np.arange(4), 4 * n + moving, [4 * n + shared]])
            square = np.zeros((4 * n + shared + 1, 4 * n + shared + 1))
            square[np.ix_(at, at)] = rows @ rows.T
            products.append(square)
            counts.append(rows.shape[1])
        if not products:
            return 0.0
        sums, count = np.array(products), np.array(counts)
        # An axis that the model cannot follow must not bend the parameters of the others: nothing is trusted at first.
        left = np.ones(len(sums))
        for _ in range(ROUNDS):
            total = np.tensordot(1 / left, sums, 1)
            theta = least_solution(total[:-1, :-1] + np.eye(len(total) - 1), total[:-1, -1])
            error = np.append(-theta, 1.0)
            left = np.maximum(sums @ error @ error, 0.0) / count + MODEL_ERROR
        return -float(0.5 * count @ np.log(left)) - 0.5 * float(theta @ theta)

    def _of_motion(self, motion: np.ndarray) -> _OfMotion:
        """Return what the model says of positions, velocities and accelerations (m, 3, n).

        Readings of torques leave the motion as it is: what is said of the first one is kept.
        """
        if self._first is not None and np.array_equal(self._first[0], motion):
            return self._first[1]
        q, v, a = (motion[:, k] for k in range(3))
        regressor = inertial_regressor(self._dynamics, q, v, a)
        columns, parameters = [], []
        for j in range(q.shape[1]):
            felt = np.flatnonzero(regressor[:, j].any(axis=0))
            varied = np.flatnonzero(self._factor[felt].any(axis=0))
            columns.append(self._factor[np.ix_(felt, varied)].T @ regressor[:, j, felt].T)
            parameters.append(varied)
        found = _OfMotion(self._dynamics.rigid_body_torque(q, v, a), columns, parameters)
        if self._first is None:
            self._first = (motion.copy(), found)
        return found

    def _drive_error(self, j: int, columns: np.ndarray, size: float) -> np.ndarray:
        """Return standard deviations (4,) of Coulomb friction either way, viscous friction and motor inertia.

        Without friction in the file an axis would have to explain its friction by bodies, and nats tell nothing.

        Parameters
        ----------
        columns : (4, m) what they are multiplied with. size : root mean square torque of the axis [N m].
        """
        drives = self._drives[j]
        unknown = np.append(np.full(3, not np.any(drives[:3])), drives[3] == 0)
        scale = np.sqrt(np.mean(columns.astype(float) ** 2, axis=1))
        free = np.where(scale > 0, DRIVE_UNKNOWN * size / np.where(scale > 0, scale, 1.0), 0.0)
        return np.where(unknown, free, DRIVE_ERROR * drives)


def least_solution(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the solution (k,) of equations (k, k), the smallest of those that come nearest where they have none.

    Where positions that are none make torques many decades beyond the measured ones, rounding takes the prior's one
    off the diagonal.
    """
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(matrix, right, rcond=None)[0]
