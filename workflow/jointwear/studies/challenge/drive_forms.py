"""Hidden effects of motor, gear and torque measurement; ``draw(scene, rng, axis) -> Hidden``."""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge.scene import Scene, either, log_uniform
from jointwear.studies.challenge.surroundings import REFERENCE_TEMPERATURE
from jointwear.studies.challenge.world import Hidden, PlantState, hidden_law


def _mesh(rng: np.random.Generator, order: int):
    """Return a wave over the motor angle with unit fundamental and weak second and third harmonics."""
    phase = rng.uniform(0, 2 * np.pi, 3)
    second, third = rng.uniform(0.08, 0.25), rng.uniform(0.0, 0.1)

    def wave(motor: np.ndarray) -> np.ndarray:
        x = order * motor
        return np.sin(x + phase[0]) + second * np.sin(2 * x + phase[1]) + third * np.sin(3 * x + phase[2])

    return wave


def cogging(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Torque of the motor's poles or the gear's mesh over the motor angle, with harmonics; 1 to 10 % of Coulomb."""
    size, order = log_uniform(rng, 0.01, 0.1), int(rng.integers(1, 5))
    wave, height, gear = _mesh(rng, order), size * scene.coulomb[axis], scene.gear[axis]
    return hidden_law(
        "cogging_torque",
        axis,
        "mesh_harmonics",
        size,
        "Fc",
        {"height": height, "order": order},
        lambda state: height * wave(gear * state.position[:, axis]),
    )


def constant_ripple(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Torque constant that ripples over the motor angle: the torque is divided by 1 + ripple; 0.5 to 5 %."""
    size, order = log_uniform(rng, 0.005, 0.05), int(rng.integers(1, 5))
    wave, gear = _mesh(rng, order), scene.gear[axis]

    def law(state):
        return state.torque[:, axis] * (1 / (1 + size * wave(gear * state.position[:, axis])) - 1)

    return hidden_law(
        "torque_constant_ripple",
        axis,
        "divided",
        size,
        "1",
        {"share": size, "order": order},
        law,
        in_loop=False,
        electrical=True,
    )


def constant_error(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Wrong torque constant: the measured torque is the true one over 1 + error, or saturates softly on top of it."""
    size = log_uniform(rng, 0.01, 0.15) * either(rng)
    form = str(rng.choice(["divided", "iron_saturation"]))
    peak = 3 * scene.torque[axis]

    def law(state):
        tau = state.torque[:, axis]
        bend = 1 + 0.03 * (tau / peak) ** 2 if form == "iron_saturation" else 1.0
        return tau * (1 / (1 + size * bend) - 1)

    return hidden_law(
        "torque_constant_error", axis, form, size, "1", {"share": size}, law, in_loop=False, electrical=True
    )


def constant_temperature(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Torque constant that falls by 2 to 4 % per 20 K, so that a torque computed from current rises.

    As 1 / (1 - a dT), or with a quadratic part.
    """
    size, form = log_uniform(rng, 0.02, 0.04), str(rng.choice(["divided", "quadratic"]))

    def law(state):
        dt = (state.temperature[:, axis] - REFERENCE_TEMPERATURE) / 20
        gain = 1 / (1 - size * dt) if form == "divided" else 1 + size * (dt + 0.15 * dt**2)
        return state.torque[:, axis] * (gain - 1)

    return hidden_law(
        "torque_constant_temperature",
        axis,
        form,
        size,
        "per 20 K",
        {"share": size},
        law,
        in_loop=False,
        electrical=True,
    )


def offset_drift(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Zero point of the torque signal that wanders smoothly: warm-up, slow wave, bent line; 1 to 20 % of Coulomb."""
    size, form = log_uniform(rng, 0.01, 0.2) * either(rng), str(rng.choice(["warm_up", "slow_wave", "bent_line"]))
    span, constant = scene.span, rng.uniform(0.2, 0.6)
    turns, phase, bend = rng.uniform(0.4, 1.0), rng.uniform(0, 2 * np.pi), rng.uniform(-0.5, 0.5)
    height = size * scene.coulomb[axis]

    def law(state):
        x = state.time / span
        if form == "warm_up":
            return height * (1 - np.exp(-x / constant))
        if form == "slow_wave":
            return height * np.sin(2 * np.pi * turns * x + phase)
        return height * (x + bend * x**2)

    return hidden_law(
        "torque_offset_drift", axis, form, size, "Fc", {"height": height}, law, in_loop=False, electrical=True
    )


def coupling(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A wrist motor whose shaft turns with two joints: its friction and inertia act on the neighbour too.

    The shaft of motor j turns at w = v_j + r v_i. By virtual work its friction f(w) and inertia J w' give f + J w' on
    joint j and r times that on joint i; the nominal model has f(v_j) + J a_j on joint j alone. "shared" is this;
    "dragged" acts on joint i alone (a housing that motor j drags along).
    """
    size = log_uniform(rng, 0.02, 0.5)
    source = axis + 1 if axis == scene.joints - 3 or (axis == scene.joints - 2 and rng.random() < 0.7) else axis - 1
    form, ratio = str(rng.choice(["shared", "dragged"])), either(rng)
    level = size * scene.coulomb[axis]
    slope = level * rng.uniform(0.3, 1.0) / max(scene.speed[axis], 0.5)
    inertia = size * rng.uniform(0.05, 0.2) * scene.armature[source]

    def drag(speed: np.ndarray, rate: np.ndarray) -> np.ndarray:
        return level * np.sign(speed) + slope * speed + inertia * rate

    def whole(state: PlantState) -> np.ndarray:
        v, a = state.velocity, state.acceleration
        result = np.zeros_like(v)
        both = drag(v[:, source] + ratio * v[:, axis], a[:, source] + ratio * a[:, axis])
        if form == "shared":
            result[:, axis] = ratio * both
            result[:, source] = both - drag(v[:, source], a[:, source])
        else:
            result[:, axis] = drag(v[:, source], a[:, source]) * ratio
        return result

    return Hidden(
        "drive_coupling",
        axis,
        form,
        size,
        "Fc",
        {"coulomb": level, "viscous": slope, "inertia": inertia, "ratio": ratio},
        lambda world: whole(world.state),
        source=source,
        also=(source,) if form == "shared" else (),
    )


DRAW = {
    "cogging_torque": cogging,
    "torque_constant_ripple": constant_ripple,
    "torque_constant_error": constant_error,
    "torque_constant_temperature": constant_temperature,
    "torque_offset_drift": offset_drift,
    "drive_coupling": coupling,
}
