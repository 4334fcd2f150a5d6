"""The load at the flange that no log tells: how much, where its centre is, and when it is carried.

A load adds (m, m c) . u to the torques of the axes, u the torques of a unit mass at the flange and of unit first
moments about it (linear in them, see Khalil and Dombre 2002, chapter 12). Within a window it is picked up and put down,
which is a switch c(t) in {0, 1}:

    residual_j(t) = nuisances_j(t) + c(t) (m, m c) . u_j(t) + noise_j(t),

with the nuisances of the regression (friction both ways and viscous, gravity and inertial torque) free in every axis.
Switch and moments are found in turn, all axes together. A load is accepted only where it explains most of what the
model leaves; then its torque belongs to the model, and what a load does to the estimates of friction goes with it.

One sample turns its switch with the nuisances held, which have swallowed much of a load under a wrong switch: a search
from afar then ends in a switch of its own making. Where it finds nothing, it begins once more from a switch that is any
number in each second, found with the nuisances free.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np

from jointwear.measurement.derived.even_steps import steps_in
from jointwear.monitor.reading.model import ModelTorque
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot

#: Rounds of finding switch and moments in turn; a few suffice, as each is a least-squares step.
ROUNDS = 12
#: Time [s] over which the switch is told from the residuals, and what is left out around it: a gripper needs as long.
SMOOTH, EDGE = 0.5, 0.3
#: Factor by which the variance left by the model must fall (geometric mean over the axes) for a load to be accepted.
VARIANCE_FALLS = 4.0
#: Time [s] between samples that suffices to find a load. Fewest of them.
STEP, FEWEST_FOR_LOAD = 0.1, 60
#: Time [s] of samples that shows a load: two to four cycles of a robot.
SUFFICES = 20.0
#: Time [s] over which a switch that is any number keeps its value, rounds of finding it, and what is added to its
#: normal equations, of their mean diagonal: the nuisances hardly tell a load that is carried throughout from none.
SEGMENT, RELAXED_ROUNDS, RELAXED_RIDGE = 1.0, 4, 1e-3
#: Time [s] of a window in which such a switch is looked for: the work grows with the square of the number of segments.
LONGEST = 60.0
#: Quantiles of the shares of the segments half way between which a load counts as carried.
OUTER = (0.1, 0.9)
#: Share of the residual (root mean square) below which gravity or inertia of the model could not matter even if all
#: wrong, and share of the largest torque of a unit load below which one of its moments is not seen: an axis on which
#: gravity does not act has nothing but round-off there.
NEGLIGIBLE, HIDDEN = 1e-3, 1e-4
#: What is added to the normal equations of the moments, their diagonal being one: moments that the motion hardly tells
#: apart stay small instead of turning on round-off.
RIDGE = 1e-8
#: Share of the largest gain of a switch that is round-off: where nothing moves, it must not say which way it turns.
ROUND_OFF = 1e-9
#: Rows of the regressors that are torques of the model.
_TORQUES = slice(3, 5)


@dataclass(frozen=True)
class Load:
    """`moments` (4,): mass [kg] and first moments [kg m] in the frame of the flange; `carried` (m,) bool."""

    moments: np.ndarray
    carried: np.ndarray


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

    Parameters
    ----------
    model : torques (m, n) without the loads. residual : (m, n) torque less that of the model. used : (m, n) samples
        that count, moving ones. groups : pieces of uninterrupted samples, those together in which one load may be.
    step : [s] between samples. torques : of loads at samples. least : smallest mass [kg].
    """
    clear = np.ones(used.shape, dtype=bool)
    every = max(steps_in(STEP, step), 1)
    index = [np.arange(piece.start, piece.stop, every) for group in groups for piece in group]
    rows = np.concatenate(index) if index else np.zeros(0, dtype=int)
    if not len(rows):
        return model, clear
    v, on = velocity[rows], used[rows]
    # What no axis is asked of says nothing of a load. A last row, of nothing, lies between the pieces of a group.
    asked = on.any(axis=1)
    units = np.zeros((4, used.shape[1], len(rows) + 1)).transpose(2, 0, 1)
    units[:-1][asked] = torques.unit(rows[asked])
    columns = np.stack([v > 0, -(v < 0).astype(float), v, model.gravity[rows], model.inertial[rows]])
    columns = _with_nothing(np.where(on, columns, 0.0).transpose(1, 2, 0)).transpose(1, 2, 0)
    left, on = _with_nothing(residual[rows]), _with_nothing(on)
    moments, places = np.zeros((len(used), 4)), _places(index)
    apart = np.full(max(round(SMOOTH / (every * step)), 1), -1)
    for group in groups:
        own = [next(places) for _ in group]
        at = np.concatenate([part for place in own for part in (place, apart)][:-1])
        load = find_load(left[at], columns[:, :, at], units[at], on[at], every * step, least)
        if load is None:
            continue
        begin = 0
        for piece, place in zip(group, own, strict=True):
            there = load.carried[begin : begin + len(place)]
            begin += len(place) + len(apart)
            carried = np.repeat(there, every)[: piece.stop - piece.start]
            moments[piece] = carried[:, None] * load.moments
            clear[piece] &= ~near_switch(carried, step)[:, None]
    loaded = np.flatnonzero(moments.any(axis=1))
    if not len(loaded):
        return model, clear
    gravity, inertial = torques.torque(loaded, moments[loaded])
    parts = [model.total.copy(), model.gravity.copy(), model.inertial.copy()]
    for part, more in zip(parts, (gravity + inertial, gravity, inertial), strict=True):
        part[loaded] += more
    return ModelTorque(*parts), clear


def together(pieces: Sequence[slice], window: np.ndarray, stretch: np.ndarray, step: float) -> list[list[slice]]:
    """Return the pieces in groups that one load is looked for in: those too short to show one with what is beside them.

    Parameters
    ----------
    pieces : uninterrupted samples of one window each, in order. window, stretch : (m,) labels. step : [s] between
        samples.

    Notes
    -----
    A hole cuts a piece off from what its window shows. Of its few moves most fit a load no better than friction: with
    none taken off, or a wrong one, parts of 5 to 14 kg turned into 30 to 70 % of friction beside holes of seconds.
    """

    def beside(one: slice, other: slice) -> bool:
        return window[one.start] == window[other.start] or stretch[one.start] == stretch[other.start]

    groups: list[list[slice]] = []
    for piece in pieces:
        if groups and _seconds(groups[-1], step) < SUFFICES and beside(groups[-1][-1], piece):
            groups[-1].append(piece)
            continue
        _join_short(groups, beside, step)
        groups.append([piece])
    _join_short(groups, beside, step)
    return groups


def _join_short(groups: list[list[slice]], beside: Callable[[slice, slice], bool], step: float) -> None:
    """Put the last group, where it is too short and nothing follows beside it, to the one before it."""
    if len(groups) > 1 and _seconds(groups[-1], step) < SUFFICES and beside(groups[-2][-1], groups[-1][0]):
        groups[-2:] = [groups[-2] + groups[-1]]


def _seconds(group: Sequence[slice], step: float) -> float:
    return step * sum(piece.stop - piece.start for piece in group)


def _with_nothing(values: np.ndarray) -> np.ndarray:
    """Return values (k, ...) and a row of zeros after them."""
    return np.concatenate([values, np.zeros_like(values[:1])])


def _places(index: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Yield the places that each of the `index` has where they are put together."""
    at = 0
    for samples in index:
        yield np.arange(at, at + len(samples))
        at += len(samples)


def find_load(
    residual: np.ndarray, columns: np.ndarray, unit: np.ndarray, used: np.ndarray, step: float, least: float = 0.0
) -> Load | None:
    """Return the load of one window, None where none explains the residual.

    Parameters
    ----------
    residual : (m, n) torque less that of the model. columns : (n, p, m) regressors of the nuisances.
    unit : (m, 4, n) torque of unit loads. used : (m, n) samples that count. step : [s] between samples.
    least : smallest mass [kg].
    """
    rows = used.any(axis=1)
    axes = np.flatnonzero(used.sum(axis=0) >= FEWEST_FOR_LOAD)
    if rows.sum() < FEWEST_FOR_LOAD or not len(axes):
        return None
    on = used[:, axes].T.astype(float)
    raw = np.where(used, residual, 0.0)[:, axes].T
    bases = _bases([_that_matter(columns[j] * on[k], raw[k]) for k, j in enumerate(axes)])
    plain = _without(bases, raw[..., None])[..., 0]
    count = on.sum(axis=1)
    before = np.maximum((plain**2).sum(axis=1) / count, 1e-12)
    loads = unit[:, :, axes].transpose(2, 0, 1) * on[..., None]
    width = max(round(SMOOTH / step), 1)
    near = partial(_nearest, plain, loads, bases, count, before, width, least)
    found = near(_starts(plain, loads, before, width))
    if found is not None:
        return found
    longest = round(LONGEST / step)
    if len(used) <= longest:
        return near(_relaxed_starts(plain, loads, bases, count, before, step))
    start = _start_from_stretch(residual, columns, unit, used, step, least, longest)
    return None if start is None else near([start])


def _nearest(
    plain: np.ndarray,
    loads: np.ndarray,
    bases: np.ndarray,
    count: np.ndarray,
    before: np.ndarray,
    width: int,
    least: float,
    starts: Iterable[np.ndarray],
) -> Load | None:
    """Return the best load that is found from any of the switches (m,) of `starts`, None where it explains too little.

    Parameters
    ----------
    plain : (n, m) residual [N m] without the nuisances. loads : (n, m, 4) torque of unit loads. bases : (n, m, p) of
        the nuisances. count : (n,) samples. before : (n,) mean square of `plain`. width : of smoothing, in samples.
    """
    best, lowest = None, 0.0
    for start in starts:
        carried, weight = start, 1.0 / before
        for _ in range(ROUNDS):
            shown = _without(bases, loads * carried[None, :, None])
            moments = _least_squares(shown, plain, weight)
            error = plain - shown @ moments
            after = np.maximum((error**2).sum(axis=1) / count, 1e-12)
            torque = loads @ moments
            fresh = _switch(torque, error + carried * torque, after, width)
            done = np.array_equal(fresh, carried)
            carried, weight = fresh, 1.0 / after
            if done or not carried.any():
                break
        left = float(count @ np.log(after / before) / count.sum())
        if carried.any() and moments[0] > least and left < lowest:
            best, lowest = Load(moments, carried), left
    return best if lowest < -np.log(VARIANCE_FALLS) else None


def _least_squares(shown: np.ndarray, plain: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the moments (4,) that explain `plain` (n, m) by `shown` (n, m, 4); `weight` (n,) of the axes."""
    turned = shown.transpose(0, 2, 1) * weight[:, None, None]
    return _moments((turned @ shown).sum(axis=0), (turned @ plain[..., None]).sum(axis=0)[:, 0])


def _that_matter(columns: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Return the columns (p, m) of one axis, torques of the model that cannot matter set to zero."""
    kept = columns.copy()
    small = (columns[_TORQUES] ** 2).sum(axis=1) < NEGLIGIBLE**2 * (residual**2).sum()
    kept[_TORQUES][small] = 0.0
    return kept


def _moments(gram: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the moments (4,) of the normal equations; one that no axis shows is zero."""
    size = np.sqrt(gram.diagonal())
    seen = size > HIDDEN * size.max(initial=0.0)
    whole = seen.all()
    if not (whole or seen.any()):
        return np.zeros(len(size))
    scale = size if whole else np.where(seen, size, 1.0)
    inner = gram / (scale[:, None] * scale)
    aim = moment / scale
    if not whole:
        inner[~(seen[:, None] & seen)] = 0.0
        aim[~seen] = 0.0
    inner.flat[:: len(size) + 1] = 1.0 + RIDGE
    return np.linalg.solve(inner, aim) / scale


def _starts(plain: np.ndarray, loads: np.ndarray, variance: np.ndarray, width: int) -> list[np.ndarray]:
    """Switches (m,) to begin with: carried throughout, and where the residual looks like a mass."""
    inner = _positive(np.einsum("jm,jm->m", plain / variance[:, None], loads[..., 0]), width)
    return [np.ones(plain.shape[1], dtype=bool), inner]


def _relaxed_starts(
    plain: np.ndarray, loads: np.ndarray, bases: np.ndarray, count: np.ndarray, before: np.ndarray, step: float
) -> list[np.ndarray]:
    """Switches (m,) to begin with, one the other turned round: of a load carried by any share in each segment.

    Moments and shares are found in turn, either with the nuisances free; arrays as of :func:`_nearest`.
    """
    m = plain.shape[1]
    segments = max(round(m * step / SEGMENT), 2)
    segment = np.arange(m) * segments // m
    inside = np.eye(segments)[segment]
    share, weight = np.ones(segments), 1.0 / before
    for _ in range(RELAXED_ROUNDS):
        moments = _least_squares(_without(bases, loads * share[segment][None, :, None]), plain, weight)
        shown = _without(bases, (loads @ moments)[..., None] * inside)
        turned = shown.transpose(0, 2, 1) * weight[:, None, None]
        gram = (turned @ shown).sum(axis=0)
        mean = gram.trace() / segments
        if not mean > 0:
            return []
        gram.flat[:: segments + 1] += RELAXED_RIDGE * mean
        share = np.linalg.solve(gram, (turned @ plain[..., None]).sum(axis=0)[:, 0])
        weight = 1.0 / np.maximum(((plain - shown @ share) ** 2).sum(axis=1) / count, 1e-12)
    low, high = np.quantile(share, OUTER)
    carried = share[segment] > 0.5 * (low + high)
    return [carried, ~carried]


def _start_from_stretch(
    residual: np.ndarray,
    columns: np.ndarray,
    unit: np.ndarray,
    used: np.ndarray,
    step: float,
    least: float,
    longest: int,
) -> np.ndarray | None:
    """Return the switch (m,) that the load and the nuisances of the busiest stretch of a window speak for in all of it.

    None where the stretch shows no load. `longest` : its samples; the other arguments are those of :func:`find_load`.
    """
    begin = max(range(0, len(used), longest), key=lambda k: int(used[k : k + longest].sum()))
    own = slice(begin, begin + longest)
    load = find_load(residual[own], columns[:, :, own], unit[own], used[own], step, least)
    if load is None:
        return None
    torque = np.where(used, np.einsum("mkn,k->mn", unit, load.moments), 0.0)
    axes = np.flatnonzero(used[own].sum(axis=0) >= FEWEST_FOR_LOAD)
    torque, without = torque[:, axes].T, np.where(used, residual, 0.0)[:, axes].T
    for k, j in enumerate(axes):
        rest = without[k, own] - load.carried * torque[k, own]
        without[k] -= np.linalg.lstsq(columns[j][:, own].T, rest, rcond=1e-6)[0] @ columns[j]
    left = without[:, own] - load.carried * torque[:, own]
    variance = np.maximum((left**2).sum(axis=1) / used[own][:, axes].sum(axis=0), 1e-12)
    return _switch(torque, without, variance, max(round(SMOOTH / step), 1))


def _bases(columns: Sequence[np.ndarray]) -> np.ndarray:
    """Return orthonormal bases (n, m, p) of the spaces of columns (p, m), filled up with zeros."""
    stacked = np.stack(columns)
    size = np.sqrt((stacked**2).sum(axis=2, keepdims=True))
    shown = np.divide(stacked, size, out=np.zeros_like(stacked), where=size > 0).transpose(0, 2, 1)
    left, values, _ = np.linalg.svd(shown, full_matrices=False)
    return left * (values > 1e-6)[:, None, :]


def _without(bases: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values (n, m, k) less their part in the spaces of `bases` (n, m, p)."""
    return values - bases @ (bases.transpose(0, 2, 1) @ values)


def _switch(torque: np.ndarray, without: np.ndarray, variance: np.ndarray, width: int) -> np.ndarray:
    """Return where (m,) a load is likelier carried than not, over `width` samples and all axes together.

    Parameters
    ----------
    torque : (n, m) of the load [N m]. without : (n, m) what is left where none is carried [N m]. variance : (n,) of it.
    """
    return _positive((torque * (2 * without - torque) / variance[:, None]).sum(axis=0), width)


def _positive(gain: np.ndarray, width: int) -> np.ndarray:
    """Return where a gain (m,), smoothed, speaks for the load: nothing but round-off speaks for neither."""
    smooth = _smooth(gain, width)
    return smooth > ROUND_OFF * np.abs(smooth).max(initial=0.0)


def _smooth(values: np.ndarray, width: int) -> np.ndarray:
    # A piece beside a hole may be shorter than what is smoothed over: `same` would return the longer of the two.
    begin = (width - 1) // 2
    return np.convolve(values, np.ones(width))[begin : begin + len(values)]


def near_switch(carried: np.ndarray, step: float) -> np.ndarray:
    """Return the samples (m,) within :data:`EDGE` of picking up or putting down."""
    turn = np.concatenate([[False], carried[1:] != carried[:-1]])
    return _smooth(turn.astype(float), 2 * steps_in(EDGE, step) + 1) > 0.5
