"""The load at the flange that no log tells: how much, where its centre is, and when it is carried.

A load adds (m, m c) . u to the torques of the axes, u the torques of a unit mass at the flange and of unit first
moments about it (linear in them, see Khalil and Dombre 2002, chapter 12). Within a window it is picked up and put down,
which is a switch c(t) in {0, 1}:

    residual_j(t) = nuisances_j(t) + c(t) (m, m c) . u_j(t) + noise_j(t),

with the nuisances of the regression (friction both ways and viscous, gravity and inertial torque) free in every axis.
Switch and moments are found in turn, all axes together. A load is accepted only where it explains most of what the
model leaves, or where other windows show it (:mod:`.settled_loads`); then its torque belongs to the model, and what a
load does to the estimates of friction goes with it.

One sample turns its switch with the nuisances held, which have swallowed much of a load under a wrong switch: a search
from afar then ends in a switch of its own making. Where it finds nothing, it begins once more from a switch that is any
number in each second, found with the nuisances free.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jointwear.measurement.derived.even_steps import steps_in
from jointwear.monitor.reading.load_search import HALVES, SMOOTH, Load, find_load, near_switch
from jointwear.monitor.reading.model import ModelTorque
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot

#: Time [s] between samples that suffices to find a load.
STEP = 0.1


@dataclass(frozen=True)
class FoundLoad:
    """A load, and for each of the pieces that it was looked for in which of their samples it is carried in, bool."""

    load: Load
    pieces: tuple[tuple[slice, np.ndarray], ...]


class UnitTorques(Protocol):
    """Torques of loads at samples of a motion, by their indices (k,)."""

    def unit(self, rows: np.ndarray) -> np.ndarray:
        """Return the torque (k, 4, n) of unit mass [N m/kg] and of unit first moments [N m/(kg m)]."""

    def torque(self, rows: np.ndarray, moments: np.ndarray) -> np.ndarray:
        """Return gravity and inertial torque (2, k, n) [N m] of loads `moments` (k, 4)."""


@dataclass(frozen=True)
class LoadsOnMotion:
    """Torques of loads at the flange along a motion, arrays (m, n): :class:`UnitTorques` of `rows`, an index."""

    flange: FlangeLoad
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    def unit(self, rows: np.ndarray) -> np.ndarray:
        """See :class:`UnitTorques`."""
        return self.flange.unit_sum(self.position[rows], self.velocity[rows], self.acceleration[rows])

    def torque(self, rows: np.ndarray, moments: np.ndarray) -> np.ndarray:
        """See :class:`UnitTorques`."""
        return self.flange.torque(self.position[rows], self.velocity[rows], self.acceleration[rows], moments)


def least_mass(robot: Robot) -> float:
    """Return the mass [kg] that can be missing: the payload of the robot file, counted negative."""
    return 0.0 if robot.payload is None else -robot.payload.mass


def with_loads(
    model: ModelTorque,
    residual: np.ndarray,
    velocity: np.ndarray,
    used: np.ndarray,
    groups: Sequence[Sequence[slice]],
    step: float,
    torques: UnitTorques,
    least: float = 0.0,
) -> tuple[ModelTorque, np.ndarray]:
    """Return the model with the loads that the samples show, and which samples (m, n) are not near a switch.

    Parameters are those of :func:`found_loads`.
    """
    found = found_loads(model, residual, velocity, used, groups, step, torques, least)
    return carrying(model, clear_ones(found), step, torques)


def found_loads(
    model: ModelTorque,
    residual: np.ndarray,
    velocity: np.ndarray,
    used: np.ndarray,
    groups: Sequence[Sequence[slice]],
    step: float,
    torques: UnitTorques,
    least: float = 0.0,
) -> list[FoundLoad]:
    """Return the loads that the samples show, those among them that are not clear.

    Parameters
    ----------
    model : torques (m, n) without the loads. residual : (m, n) torque less that of the model. used : (m, n) samples
        that count, moving ones. groups : pieces of uninterrupted samples, those together in which one load may be.
    step : [s] between samples. torques : of loads at samples. least : smallest mass [kg].
    """
    every = max(steps_in(STEP, step), 1)
    index = [np.arange(piece.start, piece.stop, every) for group in groups for piece in group]
    rows = np.concatenate(index) if index else np.zeros(0, dtype=int)
    if not len(rows):
        return []
    v, on = velocity[rows], used[rows]
    # What no axis is asked of says nothing of a load. A last row, of nothing, lies between the pieces of a group.
    asked = on.any(axis=1)
    units = np.zeros((4, used.shape[1], len(rows) + 1)).transpose(2, 0, 1)
    units[:-1][asked] = torques.unit(rows[asked])
    columns = np.stack([v > 0, -(v < 0).astype(float), v, model.gravity[rows], model.inertial[rows]])
    columns = _with_nothing(np.where(on, columns, 0.0).transpose(1, 2, 0)).transpose(1, 2, 0)
    left, on = _with_nothing(residual[rows]), _with_nothing(on)
    places, result = _places(index), []
    apart = np.full(max(round(SMOOTH / (every * step)), 1), -1)
    for group in groups:
        own = [next(places) for _ in group]
        at = np.concatenate([part for place in own for part in (place, apart)][:-1])
        load = find_load(left[at], columns[:, :, at], units[at], on[at], every * step, least, HALVES)
        if load is None:
            continue
        begin, carried = 0, []
        for piece, place in zip(group, own, strict=True):
            there = load.carried[begin : begin + len(place)]
            begin += len(place) + len(apart)
            carried.append((piece, np.repeat(there, every)[: piece.stop - piece.start]))
        result.append(FoundLoad(load, tuple(carried)))
    return result


def clear_ones(found: Sequence[FoundLoad]) -> list[FoundLoad]:
    """Return the loads that their own samples show clearly."""
    return [one for one in found if one.load.clear]


def carrying(
    model: ModelTorque, found: Sequence[FoundLoad], step: float, torques: UnitTorques
) -> tuple[ModelTorque, np.ndarray]:
    """Return the model with loads, and which samples (m, n) are not near a switch; parameters as of
    :func:`found_loads`."""
    clear, moments = np.ones(model.total.shape, dtype=bool), np.zeros((len(model.total), 4))
    for one in found:
        for piece, carried in one.pieces:
            moments[piece] = carried[:, None] * one.load.moments
            clear[piece] &= ~near_switch(carried, step)[:, None]
    loaded = np.flatnonzero(moments.any(axis=1))
    if not len(loaded):
        return model, clear
    gravity, inertial = torques.torque(loaded, moments[loaded])
    parts = [model.total.copy(), model.gravity.copy(), model.inertial.copy()]
    for part, more in zip(parts, (gravity + inertial, gravity, inertial), strict=True):
        part[loaded] += more
    return ModelTorque(*parts), clear


def _with_nothing(values: np.ndarray) -> np.ndarray:
    """Return values (k, ...) and a row of zeros after them."""
    return np.concatenate([values, np.zeros_like(values[:1])])


def _places(index: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the places that each of the `index` has where they are put together."""
    at = 0
    for samples in index:
        yield np.arange(at, at + len(samples))
        at += len(samples)
