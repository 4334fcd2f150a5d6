"""Velocity and acceleration along a log, and the samples that can be used.

What the log measures is taken as it is. What it lacks is derived in each uninterrupted stretch: a zero-phase
low-pass filter (Butterworth of order 4, forward and backward; the cut-off is that of the survey, in Hz, whatever the
rate), then central differences of fourth order. Stamps that are not even are those of even samples in the words of a
coarse clock, or right: the motion tells. Samples that are not even are first brought onto an even grid by cubic
splines. Samples that a filter edge or a gap reaches are not used.

A joint whose position is counted within one turn is unwrapped first.
Positions that are missing for no longer than two of their own steps are bridged by cubic splines where they are
differentiated: a corner of a straight line is an acceleration that nobody made, in the torques of all axes. Where more
is missing no axis is used, because every torque depends on every position. A missing torque concerns its axis alone.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from jointwear.measurement.derived.even_steps import likelier_time
from jointwear.measurement.derived.filtering import SAFELY, SHORTEST, low_pass
from jointwear.measurement.derived.missing_samples import lead_over, reached
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.turns import unwrapped

#: Spread of the steps, over their median, up to which stamps count as even.
EVEN = 0.05
#: Longest bridge, in usual steps of what is bridged.
BRIDGE = 2.5
#: Periods of the cut-off that the edge of a filter reaches into a piece.
REACH = 1.2


@dataclass(frozen=True)
class Motion:
    """Position, velocity, acceleration, temperature (m, n), where they may be used (m, n), and flags (m, n)."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    temperature: np.ndarray | None
    usable: np.ndarray
    flags: np.ndarray


def derive_motion(chunk: Chunk, stretch: np.ndarray, cutoff: np.ndarray) -> Motion:
    """Return the motion along samples in order.

    Parameters
    ----------
    chunk : samples whose time rises within each stretch.
    stretch : (m,) labels.
    cutoff : (n,) of the filter [Hz]; used only where something is derived.
    """
    m, n = chunk.position.shape
    position = unwrapped(chunk.position)
    usable = np.ones((m, n), dtype=bool)
    flags = np.zeros((m, n), dtype=np.int64)
    flags[~np.isfinite(chunk.torque)] |= int(Flag.NOT_FINITE)
    flags[~np.isfinite(position)] |= int(Flag.NOT_FINITE)
    velocity = None if chunk.velocity is None else np.array(chunk.velocity)
    acceleration = None if chunk.acceleration is None else np.array(chunk.acceleration)
    temperature = None if chunk.temperature is None else np.array(chunk.temperature)
    out_velocity, out_acceleration = np.zeros((m, n)), np.zeros((m, n))
    edges = [0, *(np.flatnonzero(np.diff(stretch)) + 1), m] if m else [0]
    due: list[_Derived] = []
    for a, b in itertools.pairwise(edges):
        part, time = slice(a, b), chunk.time[a:b]
        hole = _bridge(time, position[part])
        given_v = velocity is not None and _bridge_given(time, velocity[part], hole)
        given_a = acceleration is not None and given_v and _bridge_given(time, acceleration[part], hole)
        if temperature is not None:
            _bridge(time, temperature[part], longest=np.inf)
        if given_v and given_a:
            out_velocity[part], out_acceleration[part] = velocity[part], acceleration[part]
            usable[part] &= ~hole.any(axis=1)[:, None]
            continue
        if b - a < SHORTEST:
            usable[part] = False
            if given_v:
                out_velocity[part] = velocity[part]
            continue
        rate = (b - a - 1) / (time[-1] - time[0])
        limit = np.minimum(cutoff, SAFELY * rate)
        values, measured = (velocity[part], chunk.velocity) if given_v else (position[part], chunk.position)
        clock = likelier_time(time, values)
        lead_over(clock, values, ~np.isfinite(measured[part]) & ~hole)
        if given_v:
            out_velocity[part] = values
        due.append(_Derived(part, clock, values, limit, not given_v))
        reach = min(int(np.ceil(REACH * rate / limit.min())) + 1, (b - a) // 4)
        usable[a : a + reach] = False
        usable[b - reach : b] = False
        for j in np.flatnonzero(hole.any(axis=0)):
            around = reached(hole[:, j], reach)
            usable[part] &= ~around[:, None]
    for one, (smooth, first, second) in _differentiated(due):
        if one.twice:
            position[one.part], out_velocity[one.part], out_acceleration[one.part] = smooth, first, second
        else:
            out_acceleration[one.part] = first
    return Motion(position, out_velocity, out_acceleration, temperature, usable, flags)


def _bridge(time: np.ndarray, values: np.ndarray, longest: float = BRIDGE) -> np.ndarray:
    """Fill missing values (k, n) in place by straight lines; return where more than `longest` steps were missing."""
    hole = np.zeros(values.shape, dtype=bool)
    finite = np.isfinite(values)
    if finite.all():
        return hole
    for j in np.flatnonzero(~finite.all(axis=0)):
        known = np.flatnonzero(finite[:, j])
        if not len(known):
            if np.isfinite(longest):
                hole[:, j] = True
                values[:, j] = 0.0
            continue
        missing = np.flatnonzero(~finite[:, j])
        values[missing, j] = np.interp(time[missing], time[known], values[known, j])
        if np.isinf(longest):
            continue
        usual = np.median(np.diff(time[known])) if len(known) > 1 else 0.0
        after = np.searchsorted(known, missing)
        inside = (after > 0) & (after < len(known))
        left, right = known[np.clip(after - 1, 0, None)], known[np.clip(after, None, len(known) - 1)]
        hole[missing, j] = ~inside | (time[right] - time[left] > longest * usual)
    return hole


def _bridge_given(time: np.ndarray, values: np.ndarray, hole: np.ndarray) -> bool:
    """Fill a measured velocity or acceleration in place; False if an axis has none at all, which is then derived."""
    if not np.isfinite(values).any(axis=0).all():
        return False
    hole |= _bridge(time, values)
    return True


@dataclass(frozen=True)
class _Derived:
    """A stretch to differentiate, once or `twice`: its samples, `time` (k,), `values` (k, n), `cutoff` (n,) [Hz]."""

    part: slice
    time: np.ndarray
    values: np.ndarray
    cutoff: np.ndarray
    twice: bool

    @property
    def step(self) -> float:
        """Usual time between samples [s]."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @property
    def like(self) -> tuple:
        """What stretches must have in common to be filtered together: length, cut-off and rate but for round-off."""
        return len(self.time), self.twice, *(f"{x:.9g}" for x in (1 / self.step, *self.cutoff))


def _differentiated(due: list[_Derived]) -> Iterator[tuple[_Derived, tuple[np.ndarray, np.ndarray, np.ndarray]]]:
    """Yield stretches with their filtered values (k, n) and the first and (where asked) second derivative.

    Stretches that are alike are filtered in one call: a log of thirty seconds of every hour has many short ones.
    """
    groups: dict[tuple, list[_Derived]] = {}
    for one in due:
        groups.setdefault(one.like, []).append(one)
    for alike in groups.values():
        even = [float(np.std(np.diff(one.time))) <= EVEN * one.step for one in alike]
        grids = [one.time[0] + one.step * np.arange(len(one.time)) for one in alike]
        values = [
            one.values if plain else CubicSpline(one.time, one.values)(grid)
            for one, plain, grid in zip(alike, even, grids, strict=True)
        ]
        x, cutoff = np.stack(values, axis=1), alike[0].cutoff
        smooth = np.empty_like(x)
        for limit in np.unique(cutoff):
            chosen = cutoff == limit
            smooth[..., chosen] = low_pass(x[..., chosen], float(limit), 1 / alike[0].step, motion=True)
        for k, (one, plain, grid) in enumerate(zip(alike, even, grids, strict=True)):
            first = _first_difference(smooth[:, k], one.step)
            second = _second_difference(smooth[:, k], one.step) if one.twice else first
            found = smooth[:, k], first, second
            if not plain:
                found = tuple(_interpolated(one.time, grid, y) for y in found)
            yield one, found


def _interpolated(time: np.ndarray, grid: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.stack([np.interp(time, grid, column) for column in values.T], axis=1)


def _first_difference(x: np.ndarray, step: float) -> np.ndarray:
    """Central differences of fourth order; second order next to the ends."""
    result = np.gradient(x, step, axis=0)
    result[2:-2] = (8 * (x[3:-1] - x[1:-3]) - (x[4:] - x[:-4])) / (12 * step)
    return result


def _second_difference(x: np.ndarray, step: float) -> np.ndarray:
    result = np.zeros_like(x)
    result[1:-1] = (x[2:] - 2 * x[1:-1] + x[:-2]) / step**2
    result[2:-2] = (16 * (x[3:-1] + x[1:-3]) - (x[4:] + x[:-4]) - 30 * x[2:-2]) / (12 * step**2)
    return result
