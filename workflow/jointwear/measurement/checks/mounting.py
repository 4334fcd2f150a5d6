"""Which way gravity acts on an arm, told from its torques: a robot on a wall or a ceiling, a base frame turned.

The gravity torque is linear in the acceleration of gravity, so that its three components in the base frame are found
together from all axes, with friction, motor inertia and inertial torque of each left free. A load that the file lacks
hangs the same way and turns it little; masses that are wrong change its length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jointwear.measurement.checks.axes_check import (
    CLEARLY,
    FAVOURS,
    RIGHT,
    best_reading,
    even_so,
    explained,
    total_left,
)
from jointwear.measurement.checks.axis_readings import Likelihood, Reading
from jointwear.measurement.checks.turned_signs import likeliest_signs, nats_of_signs, needed_signs, turned_around
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.measurement.stated import Stated
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

#: Angle [rad] from which a mounting is another one: base frames are turned by quarter turns, or stand on a slope.
ANOTHER = np.radians(30.0)
#: Rounds of weighting the axes.
ROUNDS = 3


def check_mounting(
    name: str, robot: Robot, parts: np.ndarray, usable: np.ndarray, stated: Stated | None = None
) -> None:
    """Check that gravity acts on the arm as the robot file says.

    Parameters
    ----------
    name : of the data set or the log, for messages.
    parts : (m, 4, n) position, velocity, acceleration, torque. usable : (m, n) bool.
    stated : what its configuration says already, default nothing.

    Raises
    ------
    Refused : where the torques show gravity along another direction of the base frame.
    """
    size = float(np.linalg.norm(robot.gravity))
    seen = _gravity(robot, parts, usable)
    if seen is None or not size > 0:
        return

    def nats(gravity: np.ndarray) -> float:
        return Likelihood(Dynamics(replace(robot, gravity=gravity)), FEWEST_OF_JOINT)(parts, usable)

    _check_weight(name, robot, parts, usable, seen, nats)
    way = seen / np.linalg.norm(seen)
    if np.arccos(np.clip(way @ robot.gravity / size, -1.0, 1.0)) < ANOTHER:
        return
    # A load that the file lacks turns what is found; the likelihood knows of it.
    along = np.sign(way) * (np.abs(way) == np.abs(way).max())
    found, simpler = nats(size * way), nats(size * along)
    if not found - simpler > FAVOURS["zero"]:
        way, found = along, simpler
    as_given, turned = Dynamics(robot), Dynamics(replace(robot, gravity=size * way))
    if _left(as_given, parts, usable) - _left(turned, parts, usable) < CLEARLY:
        return
    if found - nats(robot.gravity) < FAVOURS["zero"]:
        return
    # A flipped joint lifts what hangs, too.
    rivals = [best_reading(as_given, parts, usable), _turned_signs(as_given, parts, usable)]
    rival, reading = max(rivals, key=lambda x: x[0])
    ahead = found - rival
    # Hanging from a ceiling, a shoulder that counts from the opposite zero and joints of a plane that all turn the
    # other way are the same to the torques.
    if ahead < (-FAVOURS["zero"] if reading.kind == "zero" or reading.several else 0.0):
        return
    too_much, another = even_so(explained(turned, parts, usable), robot)
    told = ", ".join(f"{x:.3g}" for x in size * way + 0.0)
    given = ", ".join(f"{x:.3g}" for x in robot.gravity + 0.0)
    near = {r.reason: r.remedy_beside(stated or Stated()) for n, r in rivals if found - n < FAVOURS["zero"]}
    also = "".join(f"; or {reason}" for reason in near)
    raise Refused(
        f"{name}: the torques show gravity along [{told}] of the base frame, robot '{robot.name}' has [{given}]: the "
        f"arm may be mounted on a wall, a ceiling or a slope, or its base frame turned{also}{too_much}",
        f"give 'gravity: [{told}]' in the robot file" + "".join(f"; or {remedy}" for remedy in near.values()) + another,
        by_keys=True,
    )


def _check_weight(
    name: str,
    robot: Robot,
    parts: np.ndarray,
    usable: np.ndarray,
    seen: np.ndarray,
    nats: Callable[[np.ndarray], float],
) -> None:
    """Check that the torques hold that of gravity: what a controller logs beside its own compensation does not.

    Parameters
    ----------
    seen : (3,) the acceleration of gravity that explains the torques best. nats : log likelihood of one.

    Raises
    ------
    Refused : where `seen` is nearer to none than to that of the robot file, and none fits far better.
    """
    none = np.zeros(3)
    if np.linalg.norm(seen) > np.linalg.norm(seen - robot.gravity):
        return
    as_given, weightless = Dynamics(robot), Dynamics(replace(robot, gravity=none))
    if _left(as_given, parts, usable) - _left(weightless, parts, usable) < CLEARLY:
        return
    # Wrong masses and centres of mass leave some: none has to be most of what the best one is likelier by.
    given, found = nats(robot.gravity), nats(none)
    if found - given < max(FAVOURS["zero"], nats(seen) - found):
        return
    # A joint that turns the other way takes its gravity from the others, too.
    if _turned_signs(as_given, parts, usable)[0] - found > FAVOURS["flip"]:
        return
    too_much, another = even_so(explained(weightless, parts, usable), robot)
    raise Refused(
        f"{name}: the torques hold nothing of gravity, as those from which a controller has taken its own compensation"
        f"{too_much}",
        f"log the whole torque of the motors; or give 'gravity: [0, 0, 0]' in the robot file{another}",
        by_keys=True,
    )


def _turned_signs(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> tuple[float, Reading]:
    """Return the reading that turns around the joints that need it, with its log likelihood [nats]; without any it is
    none."""
    nats = nats_of_signs(dynamics, parts, usable)
    needed = needed_signs(nats, likeliest_signs(nats, parts.shape[2]), FAVOURS["flip"])
    return nats(needed) if needed else -np.inf, turned_around(needed)


def _left(dynamics: Dynamics, parts: np.ndarray, usable: np.ndarray) -> float:
    return total_left(explained(dynamics, parts, usable), RIGHT)


def _gravity(robot: Robot, parts: np.ndarray, usable: np.ndarray) -> np.ndarray | None:
    """Return the acceleration of gravity (3,) [m/s2] in the base frame that explains the torques best, or None."""
    q, v, a, torque = (parts[:, k] for k in range(4))
    weightless = replace(robot, gravity=np.zeros(3))
    inertial = Dynamics(weightless).rigid_body_torque(q, v, a)
    unit = np.stack([Dynamics(replace(robot, gravity=way)).gravity_torque(q) for way in np.eye(3)], axis=2)
    rests = []
    for j in range(q.shape[1]):
        u = usable[:, j] & np.isfinite(torque[:, j])
        if u.sum() < FEWEST_OF_JOINT:
            continue
        columns = np.column_stack([v[u, j] > 0, v[u, j] < 0, v[u, j], a[u, j], inertial[u, j]]).astype(float)
        columns /= np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-12)
        both = np.column_stack([unit[u, j], torque[u, j]]) / max(float(np.sqrt(np.mean(torque[u, j] ** 2))), 1e-12)
        rests.append(both - columns @ np.linalg.lstsq(columns, both, rcond=1e-9)[0])
    if not rests:
        return None
    weights, found = np.ones(len(rests)), np.zeros(3)
    for _ in range(ROUNDS):
        rows = np.concatenate([w * r for w, r in zip(weights, rests, strict=True)])
        found = np.linalg.lstsq(rows[:, :3], rows[:, 3], rcond=1e-6)[0]
        weights = np.array([1 / np.sqrt(np.mean((r[:, 3] - r[:, :3] @ found) ** 2) + RIGHT) for r in rests])
    return found if np.linalg.norm(found) > 0 else None
