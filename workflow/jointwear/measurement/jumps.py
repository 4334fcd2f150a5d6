"""Positions that jump away within one sample and come back: bytes that were lost, a row of zeros, never an arm.

One such sample among thousands has a spectrum as large as the motion: it would be taken for the noise of the encoder,
against which no joint moves.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.files.wording import count, numbered
from jointwear.measurement.even_steps import pieces_of
from jointwear.measurement.recording import Recording, elapsed_time

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
    away = np.zeros(position.shape, bool)
    for piece in pieces_of(time, trajectory):
        t = time[piece]
        for j, x in enumerate(position[piece].T):
            known = np.flatnonzero(np.isfinite(x))
            if len(known) > 3:
                away[piece.start + known, j] = _away(t[known], x[known])
    away[away.sum(axis=1) > 1] = True
    return away


def _away(t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return which of the finite positions x (m,) [rad] at times t (m,) [s] are away."""
    step = np.abs(np.diff(x))
    # Steps before the first and after the last sample are none.
    near = np.concatenate([[0.0], step, [0.0]])
    large = step > np.maximum(FASTEST * np.diff(t), UNUSUAL * np.median(step))
    away, back = np.zeros(len(x), bool), -1
    for i in np.flatnonzero(large):
        if i <= back or step[i] < ALONE * near[i]:
            continue
        until = int(np.searchsorted(t, t[i + 1] + LONGEST, side="right"))
        for k in np.flatnonzero(large[i + 1 : until]) + i + 1:
            if abs(x[k + 1] - x[i]) < BACK * step[i] and step[k] > ALONE * near[k + 2]:
                away[i + 1 : k + 1], back = True, k
                break
    return away


def without_jumps(recording: Recording) -> Recording:
    """Return the recording with NaN for the motion of a joint where its position is none of the arm."""
    away = _of(recording)
    if not away.any():
        return recording

    def left(values: np.ndarray | None) -> np.ndarray | None:
        return None if values is None else np.where(away, np.nan, values)

    return replace(
        recording,
        position=left(recording.position),
        velocity=left(recording.velocity),
        acceleration=left(recording.acceleration),
    )


def jumps_in_words(recording: Recording) -> list[str]:
    """Return in words how many samples were left out for jumps, and where the first is."""
    away = _of(recording)
    rows = np.flatnonzero(away.any(axis=1))
    if not len(rows):
        return []
    joints = numbered("joint", np.flatnonzero(away.any(axis=0)) + 1)
    left_out = f"first at sample {rows[0] + 1}: {count(len(rows), 'sample')} left out"
    return [f"positions of {joints} jump away and back, {left_out}"]


def _of(recording: Recording) -> np.ndarray:
    time = elapsed_time(recording.time, recording.trajectory)
    return jumps(time, recording.trajectory, recording.position)
