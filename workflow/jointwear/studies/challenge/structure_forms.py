"""Hidden springs, payloads, elastic joints, presliding and delays; ``draw(scene, rng, axis) -> Hidden``."""

from __future__ import annotations

from dataclasses import replace
from math import exp

import numpy as np

from jointwear.robots.robot import Link
from jointwear.studies.challenge.arm import Arm
from jointwear.studies.challenge.scene import Scene, log_uniform
from jointwear.studies.challenge.world import Hidden, World, hidden_law, on_axis

#: Dead times that a first-order lag is made of.
LAG_NODES = 96


def spring(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A hose package that stiffens (sinh), a leaf between soft stops (tan), or a gas-spring counterbalance."""
    form = str(rng.choice(["hose", "leaf", "counterbalance"] if axis in (1, 2) else ["hose", "leaf"]))
    middle = rng.uniform(scene.low[axis], scene.high[axis])
    reach = scene.high[axis] - scene.low[axis]
    if form == "counterbalance":
        size = log_uniform(rng, 0.3, 2.0)
        height, ratio, preload = size * scene.coulomb[axis], rng.uniform(2, 4), rng.uniform(0.1, 0.4)

        def law(state):
            # A spring between an arm of length 1 and a pivot at distance `ratio`: lever times force over length.
            x = state.position[:, axis] - middle
            length = np.sqrt(1 + ratio**2 - 2 * ratio * np.cos(x))
            return height * ratio * np.sin(x) / length * (preload + (length - ratio + 1) / 2)

    else:
        size = log_uniform(rng, 0.05, 0.3)
        height, bend = size * scene.coulomb[axis], rng.uniform(0.5, 1.1)

        def law(state):
            x = state.position[:, axis] - middle
            if form == "hose":
                return height * np.sinh(bend * x) / bend
            width = 1.4 * reach
            return height * width / np.pi * 2 * np.tan(np.pi * x / 2 / width)

    return hidden_law("joint_spring", axis, form, size, "Fc/rad", {"height": height, "centre": float(middle)}, law)


def payload(scene: Scene, rng: np.random.Generator, axis: int | None = None) -> Hidden:
    """A body at the flange, a cylinder with its own inertia; 2 % of the rated load up to all of it."""
    mass = log_uniform(rng, 0.02, 1.0) * scene.rated
    offset = np.array([*rng.uniform(-0.04, 0.04, 2), rng.uniform(0.02, 0.12)])
    radius = 0.02 + 0.03 * mass ** (1 / 3)
    inertia = mass * radius**2 * np.diag([7 / 12, 7 / 12, 1 / 2])

    def term(world: World) -> np.ndarray:
        robot = world.arm.robot
        loaded = Arm(replace(robot, payload=Link(mass, offset, inertia)))
        s = world.state
        return loaded.load(s.position, s.velocity, s.acceleration) - world.arm.load(
            s.position, s.velocity, s.acceleration
        )

    parameters = {"mass": mass, "x": float(offset[0]), "y": float(offset[1]), "z": float(offset[2])}
    return Hidden("payload", None, "cylinder", mass, "kg", parameters, term)


#: Root mean square [N m] of the load on the second axis of a PUMA 560 in these motions.
_PUMA_LOAD = 40.0


def flexibility(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Two masses and a gear spring, solved exactly: the motor leads the link by the wind-up of the gear.

    Position is measured on the link. The motor turns at theta = q + wind-up(load), so that its inertia and its
    friction follow theta. The spring is linear or stiffens with the cube of the wind-up.
    """
    # 500 to 20,000 N m/rad for an arm of the PUMA's loads, in proportion for heavier ones.
    stiffness = log_uniform(rng, 5e2, 2e4) * max(1.0, scene.load[axis] / _PUMA_LOAD)
    form = str(rng.choice(["linear", "stiffening"]))
    load_scale = 2 * scene.load[axis]
    cubic = stiffness * rng.uniform(0.05, 0.2) / (load_scale / stiffness) ** 2 if form == "stiffening" else 0.0

    def wind_up(load: np.ndarray) -> np.ndarray:
        x = load / stiffness
        for _ in range(5 if cubic else 0):
            x = x - (stiffness * x + cubic * x**3 - load) / (stiffness + 3 * cubic * x**2)
        return x

    def term(world: World) -> np.ndarray:
        arm, h = world.arm, 2e-3
        # The neighbouring instants give the derivatives of the wind-up; the path is smooth in between.
        wound = [
            wind_up(np.concatenate([arm.load(*p.at(world.clock + shift))[:, axis] for p in world.paths]))
            for shift in (-h, 0.0, h)
        ]
        rate, bend = (wound[2] - wound[0]) / (2 * h), (wound[2] - 2 * wound[1] + wound[0]) / h**2
        velocity = world.state.velocity.copy()
        before = arm.friction(velocity)[:, axis]
        velocity[:, axis] += rate
        # At rest the motor is at rest too, and friction is not defined.
        after = np.where(world.state.velocity[:, axis] == 0, before, arm.friction(velocity)[:, axis])
        return on_axis(axis, arm.robot.armature[axis] * bend + after - before, scene.joints)

    return Hidden("joint_flexibility", axis, form, stiffness, "N m/rad", {"stiffness": stiffness}, term)


def presliding(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Coulomb friction that builds up over 0.01 to 0.1 rad: LuGre bristles, Maxwell slip, or a sharp-kneed Dahl law."""
    reach, form = log_uniform(rng, 0.01, 0.1), str(rng.choice(["lugre", "maxwell_slip", "dahl_half"]))
    height = float(scene.coulomb[axis])
    damping = rng.uniform(0.5e-3, 3e-3)

    def term(world: World) -> np.ndarray:
        step = world.interval / 5
        fine = step * np.arange(5 * (world.samples - 1) + 1)
        parts = []
        for path in world.paths:
            position = path.at(fine)[0]
            state = FORMS[form](np.diff(position[:, axis]), reach, damping / step)
            parts.append(state[::5])
        z = np.concatenate(parts)
        return on_axis(axis, height * (z - np.sign(world.state.velocity[:, axis])), scene.joints)

    return Hidden("presliding_hysteresis", axis, form, reach, "rad", {"height": height, "reach": reach}, term)


def _first_direction(steps: np.ndarray) -> float:
    """Return +1 or -1, the direction of the first step that is not zero."""
    moving = steps[steps != 0]
    return float(np.sign(moving[0])) if len(moving) else 1.0


def _lugre(steps: np.ndarray, reach: float, damping: float) -> np.ndarray:
    """LuGre torque over Coulomb friction along a path, bristles z plus micro-damping z', started sliding (m + 1,).

    z' = v - abs(v) z / reach, exact over each step; `damping` is the micro-damping over the time step.
    """
    z = _first_direction(steps)
    result = [z]
    for dq in steps.tolist():
        before = z
        if dq:
            goal = 1.0 if dq > 0 else -1.0
            z = goal + (z - goal) * exp(-abs(dq) / reach)
        result.append(z + damping * (z - before))
    return np.array(result)


def _maxwell_slip(steps: np.ndarray, reach: float, damping: float) -> np.ndarray:
    """Five parallel sliders with a spring each, breaking away between 0.2 and 2.4 times the reach (m + 1,)."""
    limits = [reach * f for f in (0.2, 0.5, 1.0, 1.6, 2.4)]
    shares = (0.3, 0.25, 0.2, 0.15, 0.1)
    sign = _first_direction(steps)
    wound = [sign * limit for limit in limits]
    result = [sign]
    for dq in steps.tolist():
        if dq:
            wound = [min(max(x + dq, -limit), limit) for x, limit in zip(wound, limits, strict=True)]
        result.append(sum(w * x / limit for w, x, limit in zip(shares, wound, limits, strict=True)))
    return np.array(result)


def _dahl_half(steps: np.ndarray, reach: float, damping: float) -> np.ndarray:
    """Dahl's law with exponent 1/2, dz/dq = sqrt(1 - s z) / reach: full sliding after finite travel (m + 1,)."""
    z = _first_direction(steps)
    result = [z]
    for dq in steps.tolist():
        if dq:
            s = 1.0 if dq > 0 else -1.0
            # Integrated: sqrt(1 - s z) falls linearly with travel.
            root = max(max(1 - s * z, 0.0) ** 0.5 - abs(dq) / (2 * reach), 0.0)
            z = s * (1 - root * root)
        result.append(z)
    return np.array(result)


FORMS = {"lugre": _lugre, "maxwell_slip": _maxwell_slip, "dahl_half": _dahl_half}


def delay(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Torque that is recorded 3 to 20 ms late: a dead time, or the first-order lag of a current filter."""
    time, form = log_uniform(rng, 0.003, 0.02), str(rng.choice(["dead_time", "lag"]))
    # A first-order lag is an exponentially weighted mean of the past. Friction jumps at reversals, so that the nodes
    # are spread over the share of the weight (Gauss-Legendre), not over a polynomial of the delay (Gauss-Laguerre).
    # Each node makes a step of its own of such a jump: a lag has none.
    share, weights = np.polynomial.legendre.leggauss(LAG_NODES)
    nodes, weights = (-np.log(0.5 - 0.5 * share), weights / 2) if form == "lag" else (np.ones(1), np.ones(1))

    def term(world: World) -> np.ndarray:
        late = sum(w * world.torque_before(time * x)[:, axis] for x, w in zip(nodes, weights, strict=True))
        return on_axis(axis, late - world.torque_before(0.0)[:, axis], scene.joints)

    return Hidden("actuation_delay", axis, form, time, "s", {"delay": time}, term, electrical=True)


def tilt(scene: Scene, rng: np.random.Generator, axis: int | None = None) -> Hidden:
    """A base that stands askew by 0.5 to 5 degrees in any direction."""
    angle, heading = np.deg2rad(log_uniform(rng, 0.5, 5.0)), rng.uniform(0, 2 * np.pi)

    def term(world: World) -> np.ndarray:
        robot, s = world.arm.robot, world.state
        # Rodrigues about a horizontal line.
        line = np.cross(robot.gravity, [np.cos(heading), np.sin(heading), 0.3])
        line = line / np.linalg.norm(line)
        gravity = robot.gravity * np.cos(angle) + np.cross(line, robot.gravity) * np.sin(angle)
        askew, rest = Arm(replace(robot, gravity=gravity)), np.zeros_like(s.position)
        return askew.load(s.position, rest, rest) - world.arm.load(s.position, rest, rest)

    degrees = float(np.rad2deg(angle))
    return Hidden("mounting_tilt", None, "rotated_gravity", degrees, "degree", {"angle": float(angle)}, term)


DRAW = {
    "mounting_tilt": tilt,
    "joint_spring": spring,
    "payload": payload,
    "joint_flexibility": flexibility,
    "presliding_hysteresis": presliding,
    "actuation_delay": delay,
}
