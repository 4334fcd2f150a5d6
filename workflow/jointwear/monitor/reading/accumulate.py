"""From samples to :class:`~jointwear.monitor.reading.windows.WindowStatistics`."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.model import ModelTorque
from jointwear.monitor.reading.program_labels import add_labels, label_text
from jointwear.monitor.reading.reversals import Pulses, pulses
from jointwear.monitor.reading.windows import (
    HISTOGRAM_BINS,
    HISTOGRAM_SPAN,
    REGRESSORS,
    WindowStatistics,
    blank_statistics,
)

_P = len(REGRESSORS)
#: Share of the torque reference below which a gravity or inertial torque could not matter even if all wrong.
NEGLIGIBLE = 1e-3


@dataclass(frozen=True)
class WindowSettings:
    """How samples become windows.

    Attributes
    ----------
    length : of a window [s].
    dead_band : (n,) speed [rad/s] below which an axis counts as at rest.
    torque_reference : (n,) torque [N m] that scales the histogram.
    guard : samples around a reversal that are left out, 0 for samples far apart.
    reach : samples of :func:`jointwear.monitor.reading.reversals.reach_of`, 0 where nothing is gathered at reversals.
    block : length [s] of the blocks of `score`; several times as long as the noise remembers.
    """

    length: float
    dead_band: np.ndarray
    torque_reference: np.ndarray
    guard: int = 1
    reach: int = 0
    block: float = 2.0


@dataclass(frozen=True)
class Samples:
    """Samples of a robot, in order of time within each stretch.

    Attributes
    ----------
    time : (m,) [s]. position, velocity, torque : (m, n) [rad], [rad/s], [N m].
    model : torque of the model along the motion, of :class:`~jointwear.monitor.reading.model.TorqueModel`.
    usable : (m, n) False where a sample must not be used (not finite, filter edge); None: all may be.
    stretch : (m,) label of the uninterrupted stretch; None: there is one.
    temperature : (m, n) [degC], NaN where unknown. flags : (m,) or (m, n) bit fields found in reading.
    program : (m,) label of the program that a sample belongs to. dated : times are dates, not those of a clock.
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    model: ModelTorque
    usable: np.ndarray | None = None
    stretch: np.ndarray | None = None
    temperature: np.ndarray | None = None
    flags: np.ndarray | None = None
    program: np.ndarray | None = None
    dated: bool = False


def moving(velocity: np.ndarray, stretch: np.ndarray, dead_band: np.ndarray, guard: int) -> np.ndarray:
    """Return where an axis moves faster than its dead band and does not reverse within `guard` samples, (m, n)."""
    result = np.abs(velocity) > dead_band
    forward = velocity > 0
    for shift in range(1, guard + 1):
        turn = (forward[shift:] != forward[:-shift]) & (stretch[shift:] == stretch[:-shift])[:, None]
        result[shift:] &= ~turn
        result[:-shift] &= ~turn
    return result


def window_statistics(samples: Samples, settings: WindowSettings, kept: slice = slice(None)) -> WindowStatistics:
    """Return the statistics of samples.

    Parameters
    ----------
    kept : the samples that count; those outside only show what is around them.
    """
    time, position, velocity, torque = samples.time, samples.position, samples.velocity, samples.torque
    model, temperature, program = samples.model, samples.temperature, samples.program
    stretch = np.zeros(len(time), dtype=int) if samples.stretch is None else samples.stretch
    residual = torque - model.total
    used = moving(velocity, stretch, settings.dead_band, settings.guard) & np.isfinite(residual)
    if samples.usable is not None:
        used &= samples.usable
    around = _Around(model, velocity, residual, used, stretch, kept.indices(len(residual))[0])
    time, position, velocity, torque, stretch = (x[kept] for x in (time, position, velocity, torque, stretch))
    used, residual, m, n = used[kept], residual[kept], len(time), velocity.shape[1]
    regressors = velocity, model.gravity[kept], model.inertial[kept]
    flags = _of_axes(samples.flags, kept, m, n)
    temperature = None if temperature is None else temperature[kept]
    program = None if program is None else program[kept]

    index = np.floor(time / settings.length).astype(np.int64)
    rows, place = np.unique(index, return_inverse=True)
    total = blank_statistics(rows * settings.length, settings.length, settings.torque_reference, samples.dated)
    edges = [0, *(np.flatnonzero(np.diff(place)) + 1), m] if m else [0]
    fits, left = [], []
    for a, b in itertools.pairwise(edges):
        piece, row = slice(a, b), int(place[a])
        moved = np.ascontiguousarray(used[piece].T)
        columns = _columns([x[piece] for x in regressors], residual[piece], moved, settings.torque_reference)
        fit, error = _add_regression(total, row, columns, moved, time[piece], stretch[piece], settings.block)
        fits.append(fit)
        left.append(error)
        _add_torque(total, row, torque[piece], settings.torque_reference)
        _add_travel(total, row, position[piece], stretch[piece])
        total.flags[row] |= np.bitwise_or.reduce(flags[piece], axis=0)
        if program is not None:
            add_labels(total.labels, [row], [label_text(program[piece])])
        if temperature is not None:
            _add_temperature(total, row, temperature[piece])
    if settings.reach and m:
        found = around.pulses(fits, left, settings)
        for a, b in itertools.pairwise(edges):
            _add_pulses(total, int(place[a]), found, slice(around.offset + a, around.offset + b))
    # An axis whose torque was not measured may move.
    frozen = total.flags & int(Flag.TORQUE_FROZEN) != 0
    total.flags[(total.count == 0) & ~frozen] |= int(Flag.AT_REST)
    return total


def _of_axes(flags: np.ndarray | None, kept: slice, m: int, n: int) -> np.ndarray:
    """Return the flags (m, n) of the samples that count; `flags` (m,) or (m, n) of all, or None."""
    if flags is None:
        return np.zeros((m, n), dtype=np.int64)
    flags = np.asarray(flags)[kept]
    return np.broadcast_to(flags[:, None] if flags.ndim == 1 else flags, (m, n))


@dataclass(frozen=True)
class _Around:
    """Samples (m, n) with those around them that only show what is there, of which `offset` come before."""

    model: ModelTorque
    velocity: np.ndarray
    residual: np.ndarray
    used: np.ndarray
    stretch: np.ndarray
    offset: int

    def pulses(self, fits: Sequence[np.ndarray], left: Sequence[np.ndarray], settings: WindowSettings) -> Pulses:
        """Return the pulses in what the fits of the pieces leave.

        Parameters
        ----------
        fits : (n, p) coefficients of each piece. left : (n, k) residual less the fit, 0 where it is not used.

        Notes
        -----
        What lies around is taken less the fit of the piece next to it, so that no step comes between them.
        """
        stop = self.offset + sum(error.shape[1] for error in left)
        before = self._beside(fits[0], slice(0, self.offset), settings.torque_reference)
        after = self._beside(fits[-1], slice(stop, None), settings.torque_reference)
        whole = np.concatenate([before, *left, after], axis=1)
        return pulses(whole, self.model, self.used, self.stretch, settings.reach)

    def _beside(self, fit: np.ndarray, rows: slice, reference: np.ndarray) -> np.ndarray:
        regressors = self.velocity[rows], self.model.gravity[rows], self.model.inertial[rows]
        columns = _columns(regressors, self.residual[rows], np.ascontiguousarray(self.used[rows].T), reference)
        return _less(columns, fit)


def _columns(
    regressors: Sequence[np.ndarray], residual: np.ndarray, used: np.ndarray, reference: np.ndarray
) -> np.ndarray:
    """Return the regressors and the residual (n, p + 1, k) of one piece, zeros where `used` (n, k) is False.

    Torques that cannot matter are set to zero sample by sample, so that pieces add up.

    Parameters
    ----------
    regressors : velocity, gravity and inertial torque (k, n). residual : (k, n). reference : (n,) torque [N m].
    """
    columns = np.zeros((len(used), _P + 1, used.shape[1]))
    np.logical_and(used, regressors[0].T > 0, out=columns[:, 0], casting="unsafe")
    columns[:, 1] = columns[:, 0] - used
    for k, values in enumerate((*regressors, residual), start=2):
        np.copyto(columns[:, k], values.T, where=used)
    torques = columns[:, 3:5]
    np.copyto(torques, 0.0, where=np.abs(torques) < NEGLIGIBLE * reference[:, None, None])
    return columns


def _add_regression(
    total: WindowStatistics,
    row: int,
    columns: np.ndarray,
    used: np.ndarray,
    time: np.ndarray,
    stretch: np.ndarray,
    block: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Add one piece of a window; columns (n, p + 1, k) with zeros where `used` (n, k) is False.

    Returns the coefficients (n, p) and what they leave of the residual (n, k), 0 where it is not used.
    """
    products = columns @ columns.transpose(0, 2, 1)
    gram, moment = products[:, :_P, :_P], products[:, :_P, _P]
    count = used.sum(axis=1)
    total.gram[row] += gram
    total.moment[row] += moment
    total.square[row] += products[:, _P, _P]
    total.count[row] += count
    starts = np.concatenate([used[:, :1], used[:, 1:] & (~used[:, :-1] | (stretch[1:] != stretch[:-1]))], axis=1)
    total.stretches[row] += starts.sum(axis=1)

    fit, rank = _local_fit(gram, moment)
    freedom = count - rank
    # A piece with hardly more samples than columns says nothing about the noise.
    enough = freedom > rank
    left = _less(columns, fit)
    error = left * (used & enough[:, None])
    total.residual_square[row] += np.einsum("jk,jk->j", error, error)
    total.freedom[row] += np.where(enough, freedom, 0)
    pair = used[:, 1:] & used[:, :-1] & (stretch[1:] == stretch[:-1])
    total.lag_square[row] += np.einsum("jk,jk,jk->j", error[:, 1:], error[:, :-1], pair.astype(float))
    total.lag_count[row] += np.where(enough, pair.sum(axis=1), 0)
    label = np.floor(time / block)
    cuts = np.concatenate([[0], np.flatnonzero((np.diff(label) != 0) | (np.diff(stretch) != 0)) + 1])
    scores = np.add.reduceat(columns[:, :_P] * error[:, None], cuts, axis=2)
    inflation = np.where(enough, count / np.maximum(freedom, 1), 0.0)
    total.score[row] += (scores @ scores.transpose(0, 2, 1)) * inflation[:, None, None]
    occupied = np.add.reduceat(used, cuts, axis=1, dtype=np.int64) > 0
    total.blocks[row] += np.where(enough, occupied.sum(axis=1), 0)
    return fit, left


def _less(columns: np.ndarray, fit: np.ndarray) -> np.ndarray:
    """Return what coefficients (n, p) leave of the last (n, k) of columns (n, p + 1, k)."""
    return columns[:, _P] - (fit[:, None] @ columns[:, :_P])[:, 0]


def _add_pulses(total: WindowStatistics, row: int, found: Pulses, piece: slice) -> None:
    """Add one piece of a window, samples of `found`."""
    square, near, far = found.square[:, piece], found.near[:, piece], found.far[:, piece]
    total.pulse_near[row] += np.einsum("jk,jk->j", square, near)
    total.pulse_far[row] += np.einsum("jk,jk->j", square, far)
    total.near_count[row] += near.sum(axis=1)
    total.far_count[row] += far.sum(axis=1)
    total.turns[row] += found.turns[:, piece].sum(axis=1)


def _local_fit(gram: np.ndarray, moment: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return least-squares coefficients (n, p) and rank (n,), columns scaled first; hidden directions stay zero."""
    scale = np.sqrt(np.einsum("jpp->jp", gram))
    inverse = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    values, vectors = np.linalg.eigh(gram * inverse[:, :, None] * inverse[:, None, :])
    seen = values > 1e-9
    weights = np.divide(1.0, values, out=np.zeros_like(values), where=seen)
    inner = np.einsum("jpk,jp->jk", vectors, moment * inverse) * weights
    return np.einsum("jpk,jk->jp", vectors, inner) * inverse, seen.sum(axis=1)


def _add_temperature(total: WindowStatistics, row: int, temperature: np.ndarray) -> None:
    """Add one piece to the mean temperature; temperature (k, n) [degC], NaN where unknown."""
    known = np.isfinite(temperature)
    before = np.nan_to_num(total.temperature[row]) * total.temperature_count[row]
    total.temperature_count[row] += known.sum(axis=0)
    count, sums = total.temperature_count[row], before + np.where(known, temperature, 0.0).sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        total.temperature[row] = np.where(count > 0, sums / count, np.nan)


def _add_travel(total: WindowStatistics, row: int, position: np.ndarray, stretch: np.ndarray) -> None:
    """Add one piece to the travel and the samples; position (k, n) [rad], stretch (k,) labels."""
    same = (stretch[1:] == stretch[:-1])[:, None]
    total.travel[row] += np.nansum(np.abs(np.diff(position, axis=0)) * same, axis=0)
    total.samples[row] += len(position)


def _add_torque(total: WindowStatistics, row: int, torque: np.ndarray, reference: np.ndarray) -> None:
    """Add one piece to the histogram and the peak; torque (k, n)."""
    for j in range(torque.shape[1]):
        values = torque[:, j]
        values = values[np.isfinite(values)]
        if not len(values):
            continue
        total.torque_peak[row, j] = max(total.torque_peak[row, j], float(np.abs(values).max()))
        scaled = (values / (HISTOGRAM_SPAN * reference[j]) + 1) * (HISTOGRAM_BINS / 2)
        bins = np.clip(scaled, 0, HISTOGRAM_BINS - 1).astype(np.int64)
        total.torque_histogram[row, j] += np.bincount(bins, minlength=HISTOGRAM_BINS)
