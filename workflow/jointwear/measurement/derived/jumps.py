"""Positions that jump within one sample, which no arm does: away and back, as bytes that were lost or a row of zeros,
off a value that they kept, as of a sensor that stopped for a while, or to another place for good.

One such sample among thousands has a spectrum as large as the motion: it would be taken for the noise of the encoder,
against which no joint moves.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from jointwear.files.wording import count, numbered
from jointwear.measurement.derived.even_steps import pieces_of
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording, elapsed_time

S = TypeVar("S", Recording, Chunk)

#: Speed [rad/s] above which a single step is a jump, where the steps on either side of it are no fifth of its size: to
#: reach it and to stop again within a sample takes accelerations of 1000 rad/s2 and more at any rate above 20 Hz.
FASTEST, ALONE = 10.0, 5.0
#: Times the median step of the joint that a jump is, at least.
UNUSUAL = 20.0
#: Longest time [s] that a position stays away.
LONGEST = 1.0
#: Share of the jump by which a position that is back may differ from the one before.
BACK = 0.5


def jumps(time: np.ndarray, trajectory: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return which positions are none of the arm, (m, n) bool; where two joints jump at once the whole row is lost.

    Parameters
    ----------
    time : (m,) [s]. trajectory : (m,) labels. position : (m, n) [rad]; NaN where it is missing.
    """
    return _found(time, trajectory, position)[0]


def lasting_jumps(time: np.ndarray, trajectory: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return at which samples a position is another one from there on, (m, n) bool; arguments as of :func:`jumps`."""
    return _found(time, trajectory, position)[1]


def _found(time: np.ndarray, trajectory: np.ndarray, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what :func:`jumps` and what :func:`lasting_jumps` returns."""
    away, lasting = np.zeros(position.shape, bool), np.zeros(position.shape, bool)
    for piece in pieces_of(time, trajectory):
        t = time[piece]
        for j, x in enumerate(position[piece].T):
            known = np.flatnonzero(np.isfinite(x))
            if len(known) > 3:
                rows = piece.start + known
                away[rows, j], lasting[rows, j] = _of_joint(t[known], x[known])
    away[away.sum(axis=1) > 1] = True
    return away, lasting


def _of_joint(t: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which of the finite positions x (m,) [rad] at times t (m,) [s] are away or stand still beside a jump, and
    at which a jump has led for good."""
    step = np.abs(np.diff(x))
    # Steps before the first and after the last sample are none.
    near = np.concatenate([[0.0], step, [0.0]])
    large = step > np.maximum(FASTEST * np.diff(t), UNUSUAL * np.median(step))
    away, lasting, back = np.zeros(len(x), bool), np.zeros(len(x), bool), -1
    for i in np.flatnonzero(large):
        if i <= back or step[i] < ALONE * near[i]:
            continue
        until = int(np.searchsorted(t, t[i + 1] + LONGEST, side="right"))
        for k in np.flatnonzero(large[i + 1 : until]) + i + 1:
            if abs(x[k + 1] - x[i]) < BACK * step[i] and step[k] > ALONE * near[k + 2]:
                away[i + 1 : k + 1], back = True, k
                break
        else:
            if step[i] > ALONE * near[i + 2]:
                still = _beside(t, step, large, i)
                away |= still
                lasting[i + 1] = not still.any()
    return away, lasting


def _beside(t: np.ndarray, step: np.ndarray, large: np.ndarray, i: int) -> np.ndarray:
    """Return which samples (m,) keep one value until a jump from sample i, or after it; where none does, the few on the
    side of an end, from which nobody knows whether it would have come back.

    The first sample that keeps a value was measured, unless it was jumped to. Arguments as in :func:`_of_joint`.
    """
    beside, moves = np.zeros(len(t), bool), np.flatnonzero(step)
    place = int(np.searchsorted(moves, i))
    begin = int(moves[place - 1]) + 1 if place else 0
    end = int(moves[place + 1]) if place + 1 < len(moves) else len(step)
    if begin < i:
        beside[begin if begin and large[begin - 1] else begin + 1 : i + 1] = True
    if end > i + 1:
        beside[i + 1 : end + 1] = True
    if beside.any():
        return beside
    if t[i] - t[0] < LONGEST:
        beside[: i + 1] = True
    elif t[-1] - t[i + 1] < LONGEST:
        beside[i + 1 :] = True
    return beside


def jumps_of(recording: Recording) -> np.ndarray:
    """Return :func:`jumps` of a recording, (m, n) bool."""
    return jumps(elapsed_time(recording.time, recording.trajectory), recording.trajectory, recording.position)


def without_jumps_of(samples: Chunk, stretch: np.ndarray) -> Chunk:
    """Return :func:`without_jumps` of samples of a log.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.
    """
    position, time = samples.position, samples.time
    with np.errstate(invalid="ignore"):
        fast = np.abs(np.diff(position, axis=0)) > FASTEST * np.diff(time)[:, None]
    if not fast.any() and np.isfinite(position).all():
        return samples
    return without_jumps(samples, jumps(time, stretch, position))


def without_jumps(samples: S, away: np.ndarray) -> S:
    """Return the samples with NaN for the motion of a joint where `away` (m, n) bool, its position none of the arm."""
    if not away.any():
        return samples

    def left(values: np.ndarray | None) -> np.ndarray | None:
        return None if values is None else np.where(away, np.nan, values)

    return replace(
        samples,
        position=left(samples.position),
        velocity=left(samples.velocity),
        acceleration=left(samples.acceleration),
    )


def jumps_in_words(away: np.ndarray) -> list[str]:
    """Return in words how many samples were left out for jumps (m, n) bool, and where the first is."""
    rows = np.flatnonzero(away.any(axis=1))
    if not len(rows):
        return []
    joints = numbered("joint", np.flatnonzero(away.any(axis=0)) + 1)
    left_out = f"first at sample {rows[0] + 1}: {count(len(rows), 'sample')} left out"
    return [f"positions of {joints} jump away and back or off a value that they kept, {left_out}"]
