"""Disturbances that no effect of the library describes; ``draw(scene, rng, axis) -> Hidden``.

Heights are 10 to 60 % of the axis's Coulomb friction unless the disturbance has a scale of its own.
"""

from __future__ import annotations

import numpy as np

from jointwear.studies.challenge.scene import Scene, either, log_uniform
from jointwear.studies.challenge.world import Hidden, World, hidden_law, on_axis


def _make(name: str, scene: Scene, axis: int, size: float, law, electrical: bool = False) -> Hidden:
    return hidden_law(
        name, axis, name, size, "Fc", {"height": size * scene.coulomb[axis]}, law, in_loop=False, electrical=electrical
    )


def _height(scene: Scene, rng: np.random.Generator, axis: int) -> tuple[float, float]:
    size = log_uniform(rng, 0.1, 0.6)
    return size, size * float(scene.coulomb[axis])


def end_stop_bump(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A rubber stop that pushes back over the last tenth of the travel at one end."""
    size, height = _height(scene, rng, axis)
    reach = scene.high[axis] - scene.low[axis]
    side = either(rng)
    edge = (scene.high[axis] if side > 0 else scene.low[axis]) - side * 0.1 * reach

    def law(state):
        return side * 2 * height * np.maximum(side * (state.position[:, axis] - edge) / (0.1 * reach), 0) ** 1.5

    return _make("end_stop_bump", scene, axis, size, law)


def broken_tooth(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """One bad tooth: a narrow bump once in a motor turn."""
    size, height = _height(scene, rng, axis)
    where, width, gear = rng.uniform(-np.pi, np.pi), rng.uniform(0.15, 0.3), scene.gear[axis]

    def law(state):
        off = np.angle(np.exp(1j * (gear * state.position[:, axis] - where)))
        return 2 * height * np.exp(-((off / width) ** 2) / 2)

    return _make("broken_tooth", scene, axis, size, law)


def beat(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Two close frequencies from elsewhere in the cell."""
    size, height = _height(scene, rng, axis)
    first, apart = rng.uniform(2, 15), rng.uniform(0.1, 0.5)

    def law(state):
        t = state.time - state.time[0]
        return height * (np.sin(2 * np.pi * first * t) + np.sin(2 * np.pi * (first + apart) * t)) / 2

    return _make("beat", scene, axis, size, law)


def step_in_time(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A sudden shift of the torque in the middle of the second recording."""
    size, height = _height(scene, rng, axis)
    sign, share = either(rng), rng.uniform(0.35, 0.65)

    def law(state):
        inside = np.flatnonzero(state.recording == min(1, state.recording[-1]))
        start = state.time[inside[int(share * len(inside))]]
        return sign * height * (state.time >= start)

    return _make("step_in_time", scene, axis, size, law, electrical=True)


def product_of_positions(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A hose that pulls by the product of two joint positions."""
    size, height = _height(scene, rng, axis)
    other = axis - 1 if axis else 1

    def unit(state, k):
        return (2 * state.position[:, k] - scene.low[k] - scene.high[k]) / (scene.high[k] - scene.low[k])

    return _make("product_of_positions", scene, axis, size, lambda s: 1.5 * height * unit(s, axis) * unit(s, other))


def random_walk(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A zero point that walks at random within every recording."""
    size, height = _height(scene, rng, axis)
    seed = int(rng.integers(2**63))

    def term(world: World) -> np.ndarray:
        steps = np.random.default_rng(seed).normal(size=(len(world.paths), world.samples))
        walk = np.cumsum(steps, axis=1) / np.sqrt(world.samples / 2)
        return on_axis(axis, height * walk.ravel(), scene.joints)

    return Hidden("random_walk", axis, "random_walk", size, "Fc", {"height": height}, term, electrical=True)


def dead_zone(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A torque signal that is blind around zero and continues beyond."""
    size = log_uniform(rng, 0.1, 0.6)
    width = size * float(scene.coulomb[axis])

    def law(state):
        tau = state.torque[:, axis]
        return -np.clip(tau, -width, width)

    return _make("dead_zone", scene, axis, size, law, electrical=True)


def saturation(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A torque signal that is cut where the amplifier ends: at 55 to 80 % of its largest value."""
    share = rng.uniform(0.55, 0.8)

    def law(state):
        tau = state.torque[:, axis]
        top = share * np.abs(tau).max()
        return np.clip(tau, -top, top) - tau

    return _make("saturation", scene, axis, share, law, electrical=True)


def neighbour_position_friction(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """Friction that depends on where the neighbour stands, as with a hose that presses on a bearing."""
    size, height = _height(scene, rng, axis)
    other, phase, waves = (axis - 1 if axis else 1), rng.uniform(0, 2 * np.pi), rng.uniform(1, 2.5)

    def law(state):
        return height * np.cos(waves * state.position[:, other] + phase) * np.sign(state.velocity[:, axis])

    return _make("neighbour_position_friction", scene, axis, size, law)


def chirp(scene: Scene, rng: np.random.Generator, axis: int) -> Hidden:
    """A sweep over each recording from about 0.5 Hz to between 5 and 15 Hz."""
    size, height = _height(scene, rng, axis)
    low, high = rng.uniform(0.3, 0.8), rng.uniform(5, 15)

    def term(world: World) -> np.ndarray:
        t, length = world.clock, world.clock[-1]
        wave = np.sin(2 * np.pi * (low * t + (high - low) * t**2 / (2 * length)))
        return on_axis(axis, height * np.tile(wave, len(world.paths)), scene.joints)

    return Hidden("chirp", axis, "chirp", size, "Fc", {"height": height}, term, electrical=True)


DRAW = {
    "end_stop_bump": end_stop_bump,
    "broken_tooth": broken_tooth,
    "beat": beat,
    "step_in_time": step_in_time,
    "product_of_positions": product_of_positions,
    "random_walk": random_walk,
    "dead_zone": dead_zone,
    "saturation": saturation,
    "neighbour_position_friction": neighbour_position_friction,
    "chirp": chirp,
}
