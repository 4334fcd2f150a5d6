"""Bases that describe structure without naming it: bins over every argument, pairs of joints, waves over angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery import assumed
from jointwear.effects.bristle import travel_since_reversal
from jointwear.effects.state import State, record_slices
from jointwear.effects.tables import hats, knots_of
from jointwear.effects.temperature import SMALLEST_SPREAD

#: Knots over each argument of the axis: a structure that matters to a simulation is a few knots wide. Temperature has
#: few, since it passes through each value once or twice in a record.
KNOTS = {"position": 16, "velocity": 16, "acceleration": 12, "torque": 14, "load": 10, "temperature": 5, "travel": 10}
#: Knots over position and velocity of another joint, of which there are many.
KNOTS_OF_OTHERS = {"position": 7, "velocity": 8}
#: Fewest knots of the saturated fit.
FEWEST_KNOTS = 4
#: Length of bins of time [s]: of an offset, and of friction, which shows in either direction of motion alone.
TIME_BIN, FRICTION_BIN = 1.5, 5.0
#: Waves of a motor turn: magnets, slots, gear teeth and bearings of usual drives lie below.
ORDERS = 12
#: Travel [rad] below which a joint counts as still.
STILL = 1e-6


@dataclass(frozen=True)
class Basis:
    """Columns (N, k) over an argument of one axis; `values` (N,) and `unit` tell where structure sits."""

    argument: str
    unit: str
    columns: np.ndarray
    values: np.ndarray


def time_bins(state: State, width: float) -> np.ndarray:
    """Return columns of ones over bins of `width` [s] of each record, (N, k)."""
    _, record = np.unique(np.asarray(state.record), return_inverse=True)
    start = np.full(record.max() + 1, np.inf)
    np.minimum.at(start, record, state.time)
    bin_of = np.floor((state.time - start[record]) / width).astype(int)
    _, index = np.unique(record * (bin_of.max() + 1) + bin_of, return_inverse=True)
    series = np.zeros((index.max() + 1, len(index)))
    series[index, np.arange(len(index))] = 1.0
    return series.T


def axis_bases(
    state: State, axis: int, usable: np.ndarray, coarse: bool = False, velocity: np.ndarray | None = None
) -> list[Basis]:
    """Return the bases of one axis. `coarse` gives fewer knots, for the saturated fit that noise is estimated from.

    Parameters
    ----------
    state : ordered samples of all joints. usable : (N,) samples of this axis that can be judged.
    velocity : (N, n) [rad/s] that bases over velocities are made of; default those of `state`.
    """
    velocity = state.velocity if velocity is None else velocity
    fine = assumed.COARSE if coarse else 1.0
    found: list[Basis] = []

    def add(argument, unit, values, count, carriers=(("", None),), judged=usable):
        columns = hats(values, knots_of(values[judged], max(FEWEST_KNOTS, round(fine * count))))
        for words, carrier in carriers if columns.shape[1] else ():
            carried = columns if carrier is None else columns * carrier[:, None]
            found.append(Basis(argument + words, unit, carried, values))

    q, v, a = state.position[:, axis], velocity[:, axis], state.acceleration[:, axis]
    s, torque, load = state.direction[:, axis], state.torque[:, axis], state.load[:, axis]
    alone, by_direction = ("", None), (" x direction", s)
    add("position", "rad", q, KNOTS["position"], (alone, by_direction))
    add("velocity", "rad/s", v, KNOTS["velocity"])
    add("acceleration", "rad/s2", a, KNOTS["acceleration"])
    add("torque", "N m", torque, KNOTS["torque"])
    add("load", "N m", load, KNOTS["load"], (by_direction,))
    warm = state.temperature[:, axis]
    if np.isfinite(warm).any() and np.ptp(warm[np.isfinite(warm)]) > SMALLEST_SPREAD:
        warm = np.nan_to_num(warm, nan=float(np.nanmean(warm)))
        add("temperature", "degC", warm, KNOTS["temperature"], (alone, by_direction, (" x velocity", v)))
    found.append(Basis("time", "s", time_bins(state, TIME_BIN), state.time))
    slow = time_bins(state, FRICTION_BIN)
    found.append(Basis("time x direction", "s", slow * s[:, None], state.time))
    for other in range(state.position.shape[1]):
        if other == axis:
            continue
        p = state.position[:, other]
        if np.ptp(p) < STILL:
            continue
        add(f"position of joint {other + 1}", "rad", p, KNOTS_OF_OTHERS["position"], (alone, by_direction))
        add(f"velocity of joint {other + 1}", "rad/s", velocity[:, other], KNOTS_OF_OTHERS["velocity"])
        if not coarse or abs(other - axis) <= 1:
            x, y = _unit(q), _unit(p)
            pair = np.stack([x * y, x * x * y, x * y * y], axis=1)
            found.append(Basis(f"position x position of joint {other + 1}", "rad", pair, p))
    if not coarse:
        travel = _travel(state, axis)
        turned = np.isfinite(travel)
        if (usable & turned).any():
            known = np.nan_to_num(travel, nan=np.nanmax(travel))
            carrier = " x direction", np.where(turned, s, 0.0)
            add("travel since reversal", "rad", known, KNOTS["travel"], (carrier,), usable & turned)
        angle = state.drive.gear_ratio[axis] * q
        # Waves of higher orders are powers of the first.
        waves = np.multiply.accumulate(np.broadcast_to(np.exp(1j * angle), (ORDERS, len(angle))), axis=0)
        further = [np.exp(1j * order * angle) for order in state.orders_of_gears(axis)]
        waves = np.concatenate([waves, further]) if further else waves
        columns = np.concatenate([waves.imag, waves.real]).T
        found.append(Basis("motor angle", "rad", columns, np.mod(angle, 2 * np.pi)))
    return found


def _travel(state: State, axis: int) -> np.ndarray:
    """Return how far one axis has gone since it last turned round (N,) [rad], NaN before that."""
    place, way = state.position[:, axis], state.direction[:, axis]
    return np.concatenate([travel_since_reversal(place[part], way[part]) for part in record_slices(state)])


def _unit(x: np.ndarray) -> np.ndarray:
    half = 0.5 * np.ptp(x)
    return (x - 0.5 * (x.max() + x.min())) / (half if half > 0 else 1.0)
