"""Rows that were not measured: a logger wrote once more what it had written before while the robot moved on, or values
on the straight line to the next that it had."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST, Refused

#: Encoder steps that a joint makes in each row, at least, where a row that repeats the one before is none of motion.
STEPS = 2.0
#: Share of the usual step of a column by which steps of a straight line may differ: what rounding leaves of them.
ROUNDED = 1e-4


def check_rows_are_new(samples: Chunk | Recording, stretch: np.ndarray, name: str) -> None:
    """Check that rows of fast motion are measured anew: one that repeats position and torque of all joints, or goes on
    with the steps of all of them, is not; nor is one that repeats the torques of all joints, or the position of one
    whose velocity is derived from it.

    A joint that has made many of its smallest steps from one change to the next has passed some in every row between.
    No torque is so smooth, nor its noise so small, that the torques of all joints change by the same as in the row
    before.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.

    Raises
    ------
    Refused : where rows repeat, or go on, before more than half of the changes, with the time from one to the next.
    """
    if len(samples.time) < FEWEST:
        return
    values = np.concatenate([samples.position, samples.torque], axis=1)
    with np.errstate(invalid="ignore"):
        steps = np.diff(values, axis=0)
        drawn = _goes_on(steps, samples.torque.shape[1], stretch)
    n = samples.position.shape[1]
    told = "rows repeat the positions and torques of all joints or lie on a straight line"
    _check(samples, stretch, name, steps, n, drawn, told)
    _check(samples, stretch, name, steps[:, n:], n, None, "rows repeat the torques of all joints")
    if samples.velocity is None:
        for j in range(n):
            _check(samples, stretch, name, steps[:, j : j + 1], 1, None, f"rows repeat the position of joint {j + 1}")


def _check(
    samples: Chunk | Recording,
    stretch: np.ndarray,
    name: str,
    steps: np.ndarray,
    moving: int,
    drawn: np.ndarray | None,
    words: str,
) -> None:
    """Check the `steps` (m - 1, k) of some columns, of which the first `moving` tell fast motion; `drawn` (m - 1,) is
    where a row goes on by the steps of the row before."""
    moved = np.abs(steps[:, :moving])
    changed = np.any(steps != 0.0, axis=1) | (np.diff(stretch) != 0)
    if drawn is not None:
        first = np.argmax(changed) + 1
        changed[first:] &= ~drawn[first:]
    # Row k + 1 against row k: rows since the change before, the change itself included.
    places = np.flatnonzero(changed)
    if len(places) < 2:
        return
    rows = np.diff(places, prepend=places[0] - 1)
    if 2 * (rows > 1).sum() <= FEWEST:
        return  # too few rows repeat to be half of those that are looked at
    inside = (np.diff(stretch) == 0)[places]
    smallest = np.where(moved > 0.0, moved, np.inf).min(axis=0)
    since = np.diff(np.cumsum(np.nan_to_num(moved), axis=0)[places], axis=0, prepend=np.nan_to_num(moved[places[:1]]))
    fast = inside & (np.nanmax(since / smallest, axis=1) > STEPS * rows)
    if fast.sum() < FEWEST:
        return
    repeated = float(np.mean(rows[fast] > 1))
    if repeated > 0.5:
        held = float(np.median(np.diff(samples.time))) * float(np.median(rows[fast]))
        raise Refused(
            f"{name}: before {100 * repeated:.0f} % of the rows of fast motion in which something changes, {words}; "
            f"the logger holds or interpolates values, for about {held:.2g} s",
            "write each value once, at the time at which it was measured, and not on a faster grid",
        )


def without_lines(samples: Chunk, stretch: np.ndarray) -> Chunk:
    """Return samples without the positions of rows on straight lines, which somebody drew through a hole of the log.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.
    """
    if len(samples.time) < FEWEST:
        return samples
    with np.errstate(invalid="ignore"):
        steps = np.diff(np.concatenate([samples.position, samples.torque], axis=1), axis=0)
        drawn = np.concatenate([_goes_on(steps, samples.torque.shape[1], stretch), [False]])
    # Row k lies between two like steps, the one to it and the one from it.
    return replace(samples, position=np.where(drawn[:, None], np.nan, samples.position)) if drawn.any() else samples


def _goes_on(steps: np.ndarray, joints: int, stretch: np.ndarray) -> np.ndarray:
    """Return where a row (m - 1,) goes on by the `steps` (m - 1, 2 n) of the row before, in all positions and torques.

    Parameters
    ----------
    joints : columns of torques, the last ones; half of them have to change, as coarse ones seldom do. stretch : (m,).
    """
    on = np.diff(stretch) == 0
    on[:1] = False
    # Mostly the first torque tells that there is no such row.
    for column in steps.T[::-1]:
        size = np.abs(column)
        usual = np.median(size[size > 0]) if (size > 0).any() else 0.0
        on[1:] &= np.abs(np.diff(column)) <= ROUNDED * usual
        if not on.any():
            return on
    return on & ((steps[:, -joints:] != 0).sum(axis=1) >= max(joints / 2, 1))
