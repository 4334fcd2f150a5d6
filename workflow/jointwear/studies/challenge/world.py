"""Everything that a hidden effect may depend on, at the samples of a case and between them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointwear.studies.challenge.arm import Arm
from jointwear.studies.challenge.motion import Path, SampledPath
from jointwear.studies.challenge.surroundings import Temperatures


@dataclass(frozen=True)
class PlantState:
    """Instants of an arm with n joints; arrays (m, n), `time` [s] and `recording` (m,).

    `load` is the torque behind the gears, `torque` the motor torque on the joint side, both [N m].
    """

    time: np.ndarray
    recording: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    temperature: np.ndarray
    load: np.ndarray
    torque: np.ndarray


@dataclass(frozen=True)
class World:
    """The recordings of a case: `paths` sampled every `interval` [s], `samples` each, from `starts` [s] on."""

    arm: Arm
    paths: tuple[Path, ...]
    starts: np.ndarray
    temperatures: Temperatures
    samples: int
    interval: float
    state: PlantState = field(repr=False)

    @property
    def clock(self) -> np.ndarray:
        """Time since the start of a recording (samples,) [s]."""
        return self.interval * np.arange(self.samples)

    def torque_before(self, delay: float) -> np.ndarray:
        """Return the motor torque without hidden effects `delay` [s] before every sample, (m, n) [N m]."""
        clock = self.clock - delay
        parts = []
        for path in self.paths:
            parts.append(path.torque_at(clock) if isinstance(path, SampledPath) else self.arm.torque(*path.at(clock)))
        return np.concatenate(parts)


def build_world(
    arm: Arm, paths: Sequence[Path], starts: np.ndarray, heat: Temperatures, samples: int, interval: float
) -> World:
    """Sample the paths; the motor torque is that of a controller where it moved the arm, else inverse dynamics."""
    clock = interval * np.arange(samples)
    position, velocity, acceleration = (np.concatenate(x) for x in zip(*(p.at(clock) for p in paths), strict=True))
    recording = np.repeat(np.arange(len(paths)), samples)
    torque = [p.torque_at(clock) if isinstance(p, SampledPath) else None for p in paths]
    state = PlantState(
        time=np.concatenate([s + clock for s in starts]),
        recording=recording,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        temperature=heat.at(recording, np.tile(clock, len(paths))),
        load=arm.load(position, velocity, acceleration),
        torque=arm.torque(position, velocity, acceleration) if torque[0] is None else np.concatenate(torque),
    )
    return World(arm, tuple(paths), np.asarray(starts), heat, samples, interval, state)


@dataclass(frozen=True)
class Hidden:
    """Something hidden in the torque of a case.

    Attributes
    ----------
    name : identifier. axis, source : 0-based axis it acts on (None: the whole arm) and axis that causes it.
    form : which of the generator's formulas. size : its amplitude in the unit `unit`.
    term : added torque (m, n) [N m] in a world. law : the same for any instants, where it has no memory and no
        need of acceleration or load; a closed loop then feels it. also : further axes that it moves.
    electrical : acts on what is measured, after all that is mechanical.
    """

    name: str
    axis: int | None
    form: str
    size: float
    unit: str
    parameters: dict[str, float]
    term: Callable[[World], np.ndarray]
    law: Callable[[PlantState], np.ndarray] | None = None
    source: int | None = None
    also: tuple[int, ...] = ()
    electrical: bool = False


def on_axis(axis: int, values: np.ndarray, joints: int) -> np.ndarray:
    """Return (m, n) zeros with `values` (m,) in the column of `axis`."""
    result = np.zeros((len(values), joints))
    result[:, axis] = values
    return result


def hidden_law(name: str, axis: int, form: str, size: float, unit: str, parameters: dict, law, **more) -> Hidden:
    """Return a hidden effect on one axis from a function of the state that gives its torque (m,) [N m]."""

    def whole(state: PlantState) -> np.ndarray:
        return on_axis(axis, law(state), state.position.shape[1])

    closed = more.pop("in_loop", True)
    return Hidden(name, axis, form, size, unit, parameters, lambda w: whole(w.state), whole if closed else None, **more)


def total_torque(world: World, hidden: Sequence[Hidden]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Add hidden effects to the motor torque: mechanical ones first, then what the measurement makes of the sum.

    Returns
    -------
    torque : (m, n) [N m] without noise. terms : for every hidden effect, in the order given, what it adds (m, n).
    """
    torque = world.state.torque
    terms: dict[int, np.ndarray] = {}
    for index in sorted(range(len(hidden)), key=lambda i: hidden[i].electrical):
        # A law that the controller has already felt is part of the torque and must not be added twice.
        felt = isinstance(world.paths[0], SampledPath) and hidden[index].law is not None
        terms[index] = hidden[index].term(replace(world, state=replace(world.state, torque=torque)))
        torque = torque if felt else torque + terms[index]
    return torque, [terms[i] for i in range(len(hidden))]
