"""The largest torque that the unloaded arm can reach at all, as a function of how fast it moves.

No trajectory is fitted here: over all poses within the limits and every instant of a motion between them the
largest |torque| is sought. A published maximum above it cannot come from this arm moving at this speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files import provenance
from jointwear.files.storage import Variable, write_dataset
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot, load_robot
from jointwear.robots.trajectory import quintic_profile
from jointwear.studies.recovery.tables import Tables, read_tables

QUASI_STATIC = 1e6  # s: nothing is left but gravity and Coulomb friction
_STEP = 1e-6
#: Steps of a climb.
_STEPS = 120


@dataclass(frozen=True)
class Bound:
    """Largest |torque| [N m], each (times, n), at `segment_time` (times,) [s].

    `free`: whatever the other axes do. `held`: with axes 1 and 6 no larger, at the same instant, than their own
    largest published maximum.
    """

    segment_time: np.ndarray
    free: np.ndarray
    held: np.ndarray


def static_bound(robot: Robot, increase: float) -> np.ndarray:
    """Return a bound (n,) [N m] on |gravity + worn Coulomb friction| that needs no search.

    The first moment of all that axis i carries is a sum of vectors, each fixed in one link: the link's own first
    moment plus the mass beyond it times the way to the next joint. Its length is at most the sum of their lengths,
    whatever the pose (triangle inequality), and gravity turns no more than that; a vector's part along an axis that
    it is fixed to does not count.

    Parameters
    ----------
    increase : largest growth of friction, a share.
    """
    mass = np.array([link.mass for link in robot.links])
    g = float(np.linalg.norm(robot.gravity))
    friction = (1 + increase) * np.maximum(robot.coulomb_positive, -robot.coulomb_negative)
    result = np.empty(robot.joints)
    for i in range(robot.joints):
        total = 0.0
        for j in range(i, robot.joints):
            row = robot.dh[j]
            # In link frame j: the joint j lies at -(way of row j), so this is the moment about it.
            back = np.array([row.a, row.d * np.sin(row.alpha), row.d * np.cos(row.alpha)])
            moment = mass[j] * robot.links[j].com + mass[j:].sum() * back
            axis = np.array([0.0, np.sin(row.alpha), np.cos(row.alpha)])  # z of frame j-1 seen in frame j
            if _parallel_from(robot, i, j):
                moment = moment - axis * (axis @ moment)
            total += float(np.linalg.norm(moment))
        # An axis parallel to gravity bears none of it.
        result[i] = (0.0 if i == 0 and _vertical_base(robot) else g * total) + friction[i]
    return result


def _parallel_from(robot: Robot, first: int, last: int) -> bool:
    """True if the axes first to last are parallel, so that what lies along the last lies along the first."""
    return all(abs(np.sin(robot.dh[k].alpha)) < 1e-9 for k in range(first, last))


def _vertical_base(robot: Robot) -> bool:
    return bool(np.allclose(robot.gravity[:2], 0.0))


def dynamic_bound(
    robot: Robot,
    segment_time: np.ndarray,
    increase: float,
    held: np.ndarray,
    random: np.random.Generator,
    draws: int = 2000,
    climbers: int = 12,
) -> Bound:
    """Return the largest |torque| of every axis over start and stop poses within limits and over all instants.

    Parameters
    ----------
    segment_time : (times,) duration of one motion [s].
    increase : growth of the friction of the axis in question, a share.
    held : (n,) largest |torque| allowed at the same instant [N m], inf where anything goes.
    draws, climbers : random motions for every time, of which the best climb.
    """
    dynamics = Dynamics(robot)
    times = np.sort(np.asarray(segment_time, dtype=float))[::-1]
    results = []
    for limit in (np.full(robot.joints, np.inf), held):
        best = np.zeros((len(times), robot.joints))
        kept: np.ndarray | None = None
        for k, time in enumerate(times):
            u = random.uniform(-np.pi / 2, np.pi / 2, size=(draws, 2 * robot.joints + 1))
            value = _objective(dynamics, u, time, increase, limit)  # (draws, n)
            top = np.argsort(-value, axis=0)[:climbers]
            start = u[top].swapaxes(0, 1)  # (n, climbers, p)
            if kept is not None:
                # What could be reached slowly is a good start for going faster.
                start = np.concatenate([start, kept], axis=1)
            kept, best[k] = _climb(dynamics, start, time, increase, limit)
        # A faster arm can always rest in the pose of the slower one's largest torque.
        results.append(np.maximum.accumulate(best, axis=0)[::-1])
    return Bound(times[::-1], *results)


def _objective(dynamics: Dynamics, u: np.ndarray, time: float, increase: float, limit: np.ndarray) -> np.ndarray:
    """|torque| of every axis less a penalty for axes beyond their limit, shape (..., n)."""
    robot, n = dynamics.robot, dynamics.robot.joints
    middle, half = (robot.upper + robot.lower) / 2, (robot.upper - robot.lower) / 2
    start = middle + half * np.sin(u[..., :n])
    span = middle + half * np.sin(u[..., n : 2 * n]) - start
    s = (0.5 + 0.5 * np.sin(u[..., -1:])) * (1 - 1e-9) + 5e-10
    share, rate, second = quintic_profile(s)
    velocity = span * rate / time
    torque = dynamics.inverse_dynamics(start + span * share, velocity, span * second / time**2)
    value = np.abs(torque + increase * robot.coulomb(velocity))
    penalty = np.where(np.isfinite(limit), np.maximum(np.abs(torque) - limit, 0.0), 0.0)
    return value - 20.0 * (penalty.sum(axis=-1, keepdims=True) - penalty) - 20.0 * penalty


def _climb(dynamics, u, time, increase, limit) -> tuple[np.ndarray, np.ndarray]:
    """Resilient gradient ascent (Rprop) of every axis' own climbers; return the best (n, 1, p) and its value (n,)."""
    n, climbers, p = u.shape
    axis = np.arange(n)[:, None]
    point, size = u.copy(), np.full(u.shape, 0.05)
    last = np.zeros(u.shape)
    best, place = np.full((n, climbers), -np.inf), point.copy()
    shift = _STEP * np.concatenate([np.zeros((1, p)), np.eye(p)])
    for _ in range(_STEPS):
        value = _objective(dynamics, point[:, :, None] + shift, time, increase, limit)
        own = value[axis, np.arange(climbers), :, axis]  # (n, climbers, 1 + p)
        better = own[..., 0] > best
        best = np.where(better, own[..., 0], best)
        place = np.where(better[..., None], point, place)
        slope = own[..., 1:] - own[..., :1]
        agree = slope * last
        size = np.clip(np.where(agree > 0, size * 1.2, np.where(agree < 0, size * 0.5, size)), 1e-6, 0.5)
        point = point + np.sign(slope) * size
        last = slope
    winner = best.argmax(axis=1)
    return place[np.arange(n), winner][:, None], best.max(axis=1)


def reachable_from(published: np.ndarray, segment_time: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Return the longest segment time [s] at which `bound` (times, n) reaches `published` (..., n).

    Infinite where every time does, 0 where none does.
    """
    result = np.empty(published.shape)
    for index in np.ndindex(published.shape):
        reach = bound[:, index[-1]] >= published[index]
        if reach[-1]:
            result[index] = np.inf
        elif not reach.any():
            result[index] = 0.0
        else:
            k = int(np.flatnonzero(reach)[-1])
            # The inertial torque goes with 1/time^2.
            x = segment_time[k : k + 2] ** -2.0
            y = bound[k : k + 2, index[-1]]
            share = (published[index] - y[1]) / max(y[0] - y[1], 1e-300)
            result[index] = (x[1] + share * (x[0] - x[1])) ** -0.5
    return result


def largest_speed(robot: Robot, tables: Tables) -> np.ndarray:
    """Return (n,) the velocity [rad/s] at which Coulomb and viscous friction alone make the largest published maximum.

    Only for axes that bear neither gravity nor inertia worth mentioning is this a bound on their speed: 1 and 6.
    """
    weakest = np.minimum(robot.coulomb_positive, -robot.coulomb_negative)
    return np.maximum(tables.maximum.max(axis=(0, 2)) - weakest, 0.0) / robot.viscous


def bound_published(
    robot_path: str | Path, published: str | Path, output: str | Path, settings: dict[str, Any]
) -> None:
    """Compute the bounds and from which segment time on each published maximum comes within reach.

    Parameters
    ----------
    robot_path : the unloaded arm.
    published : file of the published values.
    output : netCDF file.
    settings : `seed`, `segment_times` [s], `noise_allowance` (share by which noise may raise a maximum).
    """
    robot, tables = load_robot(robot_path), read_tables(published)
    increase = float(tables.increase_percent.max()) / 100
    limits = np.full(robot.joints, np.inf)
    largest = tables.maximum.max(axis=(0, 2))
    limits[[0, -1]] = largest[[0, -1]]
    random = np.random.default_rng(settings["seed"])
    times = np.array([*settings["segment_times"], QUASI_STATIC])
    bound = dynamic_bound(robot, times, increase, limits, random)
    allowed = 1 + settings["noise_allowance"]
    needed = np.moveaxis(tables.maximum, 1, -1) / allowed  # (t, c, n)
    free = reachable_from(needed, bound.segment_time, bound.free)
    held = reachable_from(needed, bound.segment_time, bound.held)
    cells = ("task", "increase", "axis")
    variables = {
        "segment_time": Variable(("segment_time",), bound.segment_time, "duration of one motion", "s"),
        "axis": Variable(("axis",), np.arange(1, robot.joints + 1), "axis of the robot", "1"),
        "task": Variable(("task",), np.array(tables.tasks), "task"),
        "increase": Variable(("increase",), tables.increase_percent, "growth of the friction", "percent"),
        "largest_torque": Variable(("segment_time", "axis"), bound.free, "largest |torque| over all poses", "N m"),
        "largest_torque_held": Variable(
            ("segment_time", "axis"), bound.held, "the same with axes 1 and 6 within their published torque", "N m"
        ),
        "static_bound": Variable(
            ("axis",),
            static_bound(robot, increase),
            "bound of gravity and worn friction by the triangle inequality",
            "N m",
        ),
        "published": Variable(cells, np.moveaxis(tables.maximum, 1, -1), "largest |torque| in Table V", "N m"),
        "reachable_from": Variable(cells, free, "longest segment time at which it can be reached (inf: any)", "s"),
        "reachable_from_held": Variable(
            cells, held, "the same with axes 1 and 6 within their published torque (0: at none)", "s"
        ),
        "largest_speed": Variable(
            ("axis",),
            largest_speed(robot, tables),
            "speed at which friction alone makes the largest published torque",
            "rad s-1",
        ),
    }
    write_dataset(output, variables, provenance.attributes("bound of the unloaded arm's torque", settings))
