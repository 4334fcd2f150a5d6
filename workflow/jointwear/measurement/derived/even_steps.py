"""Logs whose samples are not evenly spaced: put on an even grid of time before anything is filtered.

Filters and noise models count samples. One sample that the logger dropped is a jump of the position by a step of
motion, and steps that vary by a tenth are noise of the velocity times that: accelerations derived from either are wrong
by many times themselves. Stamps can be late too while the samples are even, and taking those at their word would make
the same noise. Motion is smooth, so the positions tell which of the readings is right: the one with the lowest floor of
noise at high frequencies, and the samples as they come unless another is lower by far.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from jointwear.measurement.recording import Recording
from jointwear.statistics.runs import runs

#: Usual steps after which a record is in two pieces, as for the clock of the monitor.
GAP = 5.0
#: Share by which a clock may be slow before its rate is another one; of dates 10 Hz are 9.99999998 Hz already.
CLOCK = 0.01
#: Share of a step up to which samples count as evenly spaced.
EVEN = 1e-3
#: A reading of the stamps has to lower the mean square of the fourth differences, the geometric mean over the joints
#: that move, to this share of that of the samples as they come, which is no chance.
CLEARER = 0.5
#: Fewest samples that are put on a grid.
SHORTEST = 24
#: Part of a step from which on a time holds one step more. Not a half: a tenth of a second at 125 Hz is 12.5 steps, and
#: the round-off of stamps would decide between 12 and 13, block by block.
ONE_MORE = 0.55
#: Part of a step by which a step may differ from a whole number of them and be counted by itself.
NEAR_WHOLE = 0.25
#: Parts of what a stamp is early or late by which the place of a sample and the step follow it.
FOLLOW = (0.1, 0.005)


def pieces_of(time: np.ndarray, trajectory: np.ndarray) -> list[slice]:
    """Return the uninterrupted pieces of a log: runs of one label, cut where more than `GAP` steps are missing.

    Parameters
    ----------
    time : (m,) [s]. trajectory : (m,) labels.
    """
    result = []
    for run in runs(trajectory):
        steps = np.diff(time[run])
        cuts = np.flatnonzero(steps > GAP * np.median(steps)) + run.start + 1 if len(steps) else []
        result += [slice(a, b) for a, b in zip([run.start, *cuts], [*cuts, run.stop], strict=True)]
    return result


def reaches(rate: float, least: float) -> bool:
    """Return whether a rate is at least `least` [Hz], but for a clock that is slow and stamps that are rounded."""
    return rate >= (1.0 - CLOCK) * least


def usual_step(steps: np.ndarray) -> float:
    """Return the usual time [s] between samples of steps (k,) [s], 0 of none.

    It is the mean of those within a half of it, or within one tick of a clock that is coarser: under stamps in whole
    milliseconds steps of 2.5 ms are of 2 and 3, and samples that were dropped or written in a burst are of other
    lengths.
    """
    if not len(steps):
        return 0.0
    usual, tick = float(np.median(steps)), _tick(steps)
    for _ in range(4):
        near = np.abs(steps - usual) <= max(0.5 * usual, tick) * (1 + 1e-9)
        if not near.any():
            break
        usual = float(np.mean(steps[near]))
    return usual


def step_of(time: np.ndarray, stretch: np.ndarray) -> float:
    """Return the usual time [s] between samples that follow each other in a stretch, infinite where none do.

    Parameters
    ----------
    time : (m,) [s], rising within each stretch. stretch : (m,) labels.
    """
    steps = np.diff(time)[np.diff(stretch) == 0]
    return usual_step(steps) if len(steps) else np.inf


def steps_in(seconds: float, step: float) -> int:
    """Return how many steps [s] a time [s] holds, rounded at :data:`ONE_MORE`."""
    return int(seconds / step + 1.0 - ONE_MORE)


def _tick(steps: np.ndarray) -> float:
    """Return the tick [s] of the clock of which all steps (k,) [s] are whole multiples, 0 where there is none."""
    lengths = np.unique(np.round(steps, 7))
    if len(lengths) < 2:
        return 0.0
    tick = float(np.diff(lengths).min())
    # Samples that were dropped make steps of whole multiples too, of the step itself.
    coarse = tick <= 0.75 * np.median(steps) and np.abs(lengths / tick - np.round(lengths / tick)).max() < 1e-3
    return tick if coarse else 0.0


def evenly(recording: Recording, time: np.ndarray) -> tuple[Recording, np.ndarray]:
    """Return the recording and its elapsed time (m,) with even steps, or both as they are where they are even.

    Samples that were dropped, up to `GAP` steps, are filled; a value that is not finite stays so on the grid. Samples
    that are taken as they come keep their values, and get the time of even steps.
    """
    pieces = pieces_of(time, recording.trajectory)
    usual = [usual_step(np.diff(time[p])) for p in pieces]
    if all(_is_even(time[p], step) for p, step in zip(pieces, usual, strict=True)):
        return recording, time
    readings = [[read(time[p], u) for p, u in zip(pieces, usual, strict=True)] for read in (_stamped, _counted)]
    as_is = _roughness([recording.position[p] for p in pieces])
    moves = as_is > 0
    best, grids = np.log(CLEARER), None
    for reading in readings:
        filled = [_on_grid(recording.position[p], *r[:2]) for p, r in zip(pieces, reading, strict=True)]
        change = np.log(np.maximum(_roughness(filled)[moves], 1e-300) / as_is[moves])
        if len(change) and change.mean() < best:
            best, grids = change.mean(), reading
    if grids is None:
        counted = _time_as_counted(time, pieces)
        return recording, _kept_apart([counted[p] for p in pieces], recording.trajectory)

    def put(values):
        if values is None:
            return None
        parts = [_on_grid(values[p], *r[:2]) for p, r in zip(pieces, grids, strict=True)]
        return np.concatenate(parts)

    labels = [np.full(len(r[1]), recording.trajectory[p.start]) for p, r in zip(pieces, grids, strict=True)]
    trajectory = np.concatenate(labels)
    even = _kept_apart([r[2] for r in grids], trajectory)
    changed = replace(
        recording,
        time=even,
        trajectory=trajectory,
        position=put(recording.position),
        torque=put(recording.torque),
        velocity=put(recording.velocity),
        acceleration=put(recording.acceleration),
        temperature=put(recording.temperature),
    )
    return changed, even


def _kept_apart(times: list[np.ndarray], trajectory: np.ndarray) -> np.ndarray:
    """Return the times (m,) [s] of pieces as one, still pieces: a line through the stamps of each moves its ends.

    Parameters
    ----------
    times : (k,) [s] of each piece. trajectory : (m,) labels.
    """
    moved, place = [times[0]], len(times[0])
    for before, after in itertools.pairwise(times):
        least = moved[-1][-1] + (1 + EVEN) * GAP * usual_step(np.diff(before))
        follows = trajectory[place] == trajectory[place - 1]
        moved.append(after + max(least - after[0], 0.0) if follows else after)
        place += len(after)
    return np.concatenate(moved)


def _time_as_counted(time: np.ndarray, pieces: list[slice]) -> np.ndarray:
    """Return the time (m,) of samples that stay as they come: even in each piece whose stamps allow it.

    Where the stamps themselves vary, as whole milliseconds do, derivatives over them hold noise that the positions have
    not. Each stamp has to be nearer to the place of its own sample than to another's: those of a clock that runs at
    another rate for a while are not.
    """
    even = time.copy()
    for piece in pieces:
        stamps = time[piece]
        if len(stamps) < SHORTEST:
            continue
        place = np.arange(len(stamps), dtype=float)
        step, start = np.polyfit(place, stamps, 1)
        line = start + step * place
        if np.abs(line - stamps).max() < 0.5 * step:
            even[piece] = line
    return even


def likelier_time(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the time (k,) [s] of the samples of one piece: as stamped, or as counted from sample to sample.

    The stamps hold where they make the values smoother by far, or stray so far that another sample is meant.

    Parameters
    ----------
    time : (k,) stamps [s], rising, with no more than `GAP` steps missing. values : (k, n) of a smooth motion.
    """
    usual = usual_step(np.diff(time))
    if _is_even(time, usual):
        return time
    stamped, counted = _stamped(time, usual), _counted(time, usual)
    place, step = counted[0], float(counted[2][-1] - counted[2][0]) / max(len(counted[1]) - 1, 1)
    even = counted[2][0] + step * place
    if np.abs(even - time).max() >= 0.5 * step:
        return time
    by_stamps, by_count = (_roughness([_on_grid(values, *r[:2])]) for r in (stamped, counted))
    moves = by_count > 0
    if moves.any() and np.mean(np.log(np.maximum(by_stamps[moves], 1e-300) / by_count[moves])) < np.log(CLEARER):
        return time
    return even


def _is_even(time: np.ndarray, usual: float) -> bool:
    if len(time) < SHORTEST or usual <= 0:
        return True
    line = np.linspace(time[0], time[-1], len(time))
    steps = (time[-1] - time[0]) / usual
    return abs(steps - (len(time) - 1)) < 0.5 and float(np.abs(time - line).max()) <= EVEN * usual


def _stamped(time: np.ndarray, usual: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where samples and grid are, (k,) and (m,), and the times of the grid: stamps are right."""
    if len(time) < SHORTEST or usual <= 0:
        return time, time, time
    count = max(round((time[-1] - time[0]) / usual), 1)
    grid = np.linspace(time[0], time[-1], count + 1)
    return time, grid, grid


def _counted(time: np.ndarray, usual: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the same: the samples are even, the stamps tell only how many are missing."""
    if len(time) < SHORTEST or usual <= 0:
        return time, time, time
    place = _places(time, usual)
    step, start = np.polyfit(place, time, 1)
    grid = np.arange(int(place[-1]) + 1, dtype=float)
    return place, grid, start + step * grid


def _places(time: np.ndarray, usual: float) -> np.ndarray:
    """Return the places (k,), 0, 1, ..., of samples on the grid that is the likeliest by their stamps.

    A step that is no whole number of usual ones can be that of a late stamp or of a sample that was dropped. Only what
    comes after it tells: a loop that is locked to the stamps (a delay-locked one, of second order) says where the
    sample before it was.
    """
    ratio = np.diff(time) / usual
    steps = np.maximum(np.round(ratio), 1.0)
    if np.abs(ratio - steps).max() > NEAR_WHOLE:
        step, phase, rate = usual, *FOLLOW
        expected = float(np.median(time[:SHORTEST] - usual * np.arange(len(time[:SHORTEST]))))
        for k, stamp in enumerate(time[1:].tolist()):
            count = max(round((stamp - expected) / step), 1)
            off = stamp - expected - count * step
            expected += count * step + phase * off
            step += rate * off / count
            steps[k] = count
    return np.concatenate([[0.0], np.cumsum(steps)])


def _on_grid(values: np.ndarray, place: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Return values (k, ...) at `place` (k,) as they are at `grid` (m,)."""
    if place is grid:
        return values
    columns = np.asarray(values, dtype=float).reshape(len(place), -1)
    result = np.empty((len(grid), columns.shape[1]))
    nearest = np.clip(np.searchsorted(place, grid), 1, len(place) - 1)
    nearest -= grid - place[nearest - 1] < place[nearest] - grid
    for j, x in enumerate(columns.T):
        known = np.isfinite(x)
        if known.sum() < 4:
            result[:, j] = x[nearest]
            continue
        result[:, j] = CubicSpline(place[known], x[known])(grid)
        result[~known[nearest], j] = np.nan
    return result.reshape(len(grid), *values.shape[1:])


def _roughness(pieces: list[np.ndarray]) -> np.ndarray:
    """Return the mean square (n,) of the fourth differences of positions: smooth motion has hardly any."""
    parts = [np.diff(q, 4, axis=0) for q in pieces if len(q) >= SHORTEST]
    if not parts:
        return np.zeros(pieces[0].shape[1])
    return np.array([np.nan_to_num(np.nanmean(x**2)) for x in np.concatenate(parts).T])
