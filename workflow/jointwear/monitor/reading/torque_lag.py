"""How late the torque of a log is against the motion, and a later log read as late as the first one.

A controller that filters its currents more strongly from one day on delays all torques by some milliseconds. The torque
of an arm then turns late: of a sinusoidal motion of frequency w, an inertia M seen a time d late adds M w^2 d to the
viscous friction, which looks like wear of the heaviest axes. To first order

    residual_j(t) = nuisances_j(t) - d_j db_j/dt + noise_j(t),

b the torque of the bodies. What else resembles db/dt is left free in every axis and window: friction both ways, of any
shape over speed and over load, gravity and inertia, the motor's own inertia and a load at the flange. With the five
columns of the regression alone a body that is 3 % off moves d_j by up to 80 ms, differently in each program; with these
programs of one robot differ by some 3 ms in the median of the axes. A clock or a filter delays all axes, a gear with
play one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointwear.measurement.derived.even_steps import steps_in, usual_step
from jointwear.measurement.refused import Refused
from jointwear.monitor.reading.carried import UnitTorques
from jointwear.monitor.reading.model import ModelTorque

#: Smallest change of the lag [s] that is taken out. Logs of one robot that nothing delays differ by up to 5 ms.
SMALLEST = 0.006
#: Largest change [s] that a filter or a drive makes: more are other rows or another clock.
LARGEST = 0.05
#: Error [s] up to which the lag of an axis has a say, or its share of the change; fewest such axes.
KNOWN, KNOWN_SHARE, FEWEST_AXES = 0.003, 0.1, 3
#: Share of the change that LEAST_SHARE of these axes have to show at least, and over it at most: what delays all delays
#: each alike, and another program than that of the first log moves them by 0, 9, 13 and 34 ms.
SHARED, LEAST_SHARE = 0.5, 0.6
#: What the change must take off the log of what is left of the torque, summed over the axes, and share of it that it
#: may add on one axis: a lag of all explains more of each. Filters of 8 ms take off 0.2, of 19 ms 0.8 and more. On arms
#: whose file knows neither friction nor motors the lags of an axis differ by 100 ms from program to program; what
#: explains one axis better then explains another worse.
LIKELIER, WORSE = 0.15, 0.1
#: Share that the change must take off of what a lag of its own on each axis would. What acts of 8, 12 and 20 ms, put on
#: days of five other robots, takes off 0.64 and more; programs that were taught anew and moved the axes of a UR10
#: without friction in its file by 3, 4, 8, 15 and 101 ms looked like 8 ms on all, which take off 0.34.
TAKES_OFF = 0.5
#: The same as LIKELIER for a change beyond LARGEST, whose size is known to first order only, so that some axes seem
#: worse for it. Rows moved by 0.24 s took off 1.9; of good logs none took off more than 0.07.
FAR_LIKELIER = 1.0
#: Time [s] after an axis begins to move in which its friction still turns, and is not looked at.
BEGINS = 0.1
#: Time [s] between samples that suffices, and fewest of an axis in a window: eight for each column.
STEP, FEWEST_OF_WINDOW = 0.04, 100
#: Speed [rad/s] over which friction falls after a start, of one column.
STRIBECK = 0.05
#: One of so many windows of a block is looked at first, and share of SMALLEST below which the others are not.
GLANCE, GLANCE_SHARE = 6, 0.5


@dataclass(frozen=True)
class Lag:
    """How late the torque of each axis is.

    `late` (n,) [s]; `error` (n,) [s], its standard deviation, infinite where it is not seen; `sharp` (n,) [1/s2]: what
    is left of the torque grows by the factor 1 + sharp d^2 where the lag is d off.
    """

    late: np.ndarray
    error: np.ndarray
    sharp: np.ndarray


def pieces_of(time: np.ndarray, stretch: np.ndarray, length: float) -> list[slice]:
    """Return the uninterrupted samples of each window; `time`, `stretch` (m,), `length` of a window [s]."""
    label = np.floor(time / length)
    cuts = np.flatnonzero((np.diff(label) != 0) | (np.diff(stretch) != 0)) + 1
    return [slice(a, b) for a, b in pairwise([0, *cuts.tolist(), len(label)])] if len(label) else []


def lag_of(
    torque: np.ndarray,
    model: ModelTorque,
    motion: tuple[np.ndarray, np.ndarray],
    used: np.ndarray,
    pieces: Sequence[slice],
    time: np.ndarray,
    loads: UnitTorques,
) -> Lag:
    """Return how late the torque (m, n) [N m] of each axis is.

    Parameters
    ----------
    model : torques (m, n) along the motion, with the loads. motion : velocity and acceleration (m, n) [rad/s, rad/s2].
    used : (m, n) samples that count, moving ones. pieces : uninterrupted samples of one window. time : (m,) [s],
        of which each piece has its own step: a log need not be sampled as the first one is, nor as it was.
    loads : torques of loads at the flange, by samples.
    """
    n = torque.shape[1]
    crossed, shown, left, count = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    for piece in pieces:
        if piece.stop - piece.start < FEWEST_OF_WINDOW:
            continue
        step = usual_step(np.diff(time[piece]))
        every, begins = max(steps_in(STEP, step), 1), max(steps_in(BEGINS, step), 1)
        rows = np.arange(piece.start, piece.stop, every)
        if len(rows) < FEWEST_OF_WINDOW:
            continue
        bodies = model.gravity[piece] + model.inertial[piece]
        slope, bodies = np.gradient(bodies, step, axis=0)[::every], bodies[::every]
        residual = (torque[piece] - model.total[piece])[::every]
        on = (_settled(used[piece], begins))[::every] & np.isfinite(residual)
        axes = np.flatnonzero(on.sum(axis=0) >= FEWEST_OF_WINDOW)
        if not len(axes):
            continue
        v, a = (x[rows] for x in motion)
        unit = loads.unit(rows)
        for j in axes:
            u = on[:, j]
            parts = v[u, j], a[u, j], model.gravity[rows[u], j], model.inertial[rows[u], j], bodies[u, j]
            columns = normalised(nuisances(*parts, unit[u, :, j]))
            both = np.stack([residual[u, j], -slope[u, j]], axis=1)
            rest = both - columns @ np.linalg.lstsq(columns, both, rcond=1e-7)[0]
            crossed[j] += rest[:, 1] @ rest[:, 0]
            shown[j] += rest[:, 1] @ rest[:, 1]
            left[j] += rest[:, 0] @ rest[:, 0]
            count[j] += u.sum()
    seen = (shown > 0) & (count > 0)
    late = np.divide(crossed, shown, out=np.zeros(n), where=seen)
    least = np.maximum(left - crossed * late, 1e-12)
    error, sharp = np.full(n, np.inf), np.zeros(n)
    sharp[seen] = shown[seen] / least[seen]
    error[seen] = 1 / np.sqrt(sharp[seen] * count[seen])
    return Lag(late, error, sharp)


def nuisances(
    v: np.ndarray, a: np.ndarray, gravity: np.ndarray, inertial: np.ndarray, bodies: np.ndarray, unit: np.ndarray
) -> np.ndarray:
    """Return the nuisances (k, p) of one axis: columns whose size is left free."""
    sense = np.sign(v)
    friction = v > 0, v < 0, v, v * np.abs(v), sense * np.exp(-np.abs(v) / STRIBECK), sense * np.abs(bodies)
    return np.column_stack([*friction, gravity, inertial, a, unit]).astype(float)


def normalised(columns: np.ndarray) -> np.ndarray:
    """Return columns (k, p), each divided by its root mean square."""
    return columns / np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-12)


def change_of(lag: Lag, first: Lag) -> float:
    """Return by how much later [s] the torque of all axes is than in the first log, the median over the axes; 0 where
    that is nothing to act on."""
    change = _changes(lag, first)
    if len(change) < FEWEST_AXES:
        return 0.0
    found = float(np.median(change))
    if abs(found) < SMALLEST:
        return 0.0
    share = change / found
    # A change beyond LARGEST is known to first order only.
    alike = (share >= SHARED) & ((share <= 1 / SHARED) | (abs(found) > LARGEST))
    if np.mean(alike) < LEAST_SHARE:
        return 0.0
    as_first, moved = (1 + lag.sharp * (late - lag.late) ** 2 for late in (first.late, first.late + found))
    say = _with_a_say(first)
    gain = np.log(as_first / moved)[say]
    if abs(found) > LARGEST:
        return found if gain.sum() >= FAR_LIKELIER else 0.0
    enough = max(LIKELIER, TAKES_OFF * float(np.log(as_first)[say].sum()))
    return found if gain.sum() >= enough and gain.min() >= -WORSE * gain.sum() else 0.0


def plainly_none(lag: Lag, first: Lag) -> bool:
    """Return whether a glance at some windows shows that the lag is that of the first log."""
    change = _changes(lag, first)
    return len(change) >= FEWEST_AXES and abs(float(np.median(change))) < GLANCE_SHARE * SMALLEST


def rest_of(lag: Lag, first: Lag) -> float:
    """Return what is left [s] of a change once the torque was read later: it is found to first order of its size."""
    change = _changes(lag, first)
    return float(np.median(change)) if len(change) >= FEWEST_AXES else 0.0


def off_in_time(name: str) -> Refused:
    """Return the refusal of a log whose torque changed its lag by more than LARGEST; how far it is off, and which way,
    is known to first order only."""
    return Refused(
        f"{name}: the torque of most joints is more than {1e3 * LARGEST:.0f} ms off in time against the motion, unlike "
        "that of the first log; no drive and no filter does that",
        "join torque and motion by one clock, or move the rows of the torque",
    )


def _changes(lag: Lag, first: Lag) -> np.ndarray:
    """Return the changes [s] of the axes that have a say."""
    change, error = lag.late - first.late, np.hypot(lag.error, first.error)
    return change[_with_a_say(first) & (error < np.maximum(KNOWN, KNOWN_SHARE * np.abs(change)))]


def _with_a_say(first: Lag) -> np.ndarray:
    """Return the axes (n,) whose lag in the first log is one of a drive; others lack so much of the model that it
    stands for what is lacking."""
    return np.isfinite(first.error) & (np.abs(first.late) <= LARGEST)


def read_later(
    torque: np.ndarray, time: np.ndarray, stretch: np.ndarray, usable: np.ndarray, later: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return torques (m, n) read `later` [s], and where (m, n) they may be used: not beyond the end of their stretch,
    nor beside a sample that may not be used."""
    moved, kept = np.full(torque.shape, np.nan), np.zeros(usable.shape, dtype=bool)
    edges = [0, *(np.flatnonzero(np.diff(stretch)) + 1).tolist(), len(time)] if len(time) else []
    for a, b in pairwise(edges):
        part, wanted = slice(a, b), time[a:b] + later
        inside = (wanted >= time[a]) & (wanted <= time[b - 1])
        for j in range(torque.shape[1]):
            moved[part, j] = np.interp(wanted, time[part], torque[part, j])
            sound = np.interp(wanted, time[part], usable[part, j].astype(float)) > 1 - 1e-9
            kept[part, j] = usable[part, j] & sound & inside
    return moved, kept


def _settled(used: np.ndarray, skipped: int) -> np.ndarray:
    """Return the used samples (m, n) but the first `skipped` of each run of them."""
    result = used.copy()
    for shift in range(1, skipped + 1):
        result[shift:] &= used[:-shift]
        result[:shift] = False
    return result
