"""Rows of two robots, or of two loggers, that were merged by their times into one file.

The stamps of such a log look like those of packets, and each of its joints seems to leap to and fro at every row. What
is left of either robot once leaps are left out says whatever one likes of friction, speed and load.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.formats.chunk import Chunk

#: Longest usual step of time [s], with a clock that is slow by a hundredth: over longer ones an arm may well be where
#: it was two rows before.
LONGEST = 0.101
#: How far [rad] a joint leaps from one row to the next at least, the acceleration [rad/s2] of an arm that would do so
#: and turn back within a row more, which none reaches in row after row, and part of a leap by which the joint is off
#: where it was two or three rows before.
APART, FASTEST, BACK = 0.05, 200.0, 0.2
#: Joints that leap in the same row, at least: one alone is a fault of its encoder.
JOINTS = 2
#: Rows of a part of a log, fewest of them that tell anything, and share of them from which they are of two sources:
#: merged at random a quarter of them tells it, in turn all.
PART, FEWEST, SHARE = 500, 40, 0.2
#: Rows before, at one of which a source was last seen: two sources in turn, three, or one twice as often.
BEFORE = (2, 3)


def check_one_source(path: str | Path, chunk: Chunk) -> None:
    """Check that the rows of a chunk are of one robot.

    Raises
    ------
    InputError : where joints leap to and fro from row to row in any part of it.
    """
    steps = np.diff(chunk.time)
    steps = steps[steps > 0]
    if len(steps) < FEWEST or not np.median(steps) <= LONGEST:
        return
    far, back = _leaps(chunk.position, max(APART, 0.5 * FASTEST * float(np.median(steps)) ** 2))
    for part in (slice(a, b) for a, b in pairwise([*range(0, max(len(back) - PART, 0) + 1, PART), len(back)])):
        share = float(back[part].mean()) if len(back) else 0.0
        if share >= SHARE:
            raise InputError(
                f"{path}: joints leap to and fro from row to row, by {np.median(far[part][back[part]]):.2g} rad, and "
                f"in {100 * share:.0f} % of the rows are back where they were two or three rows before: two robots, or "
                "two sources, seem to be in one file; write the rows of each into a log of its own"
            )


def _leaps(position: np.ndarray, apart: float) -> tuple[np.ndarray, np.ndarray]:
    """Return how far [rad] the joint that leaps furthest does at each row but the first few, (k,), and at which of them
    enough joints leap and are back where they were, (k,) bool.

    Parameters
    ----------
    position : (m, n) [rad], NaN where it is missing. apart : [rad] that is a leap.
    """
    first = max(BEFORE)
    least = min(JOINTS, position.shape[1])
    leap = np.abs(_change(position, 1))
    with np.errstate(invalid="ignore"):
        # Hardly any log has enough of them to be looked at.
        if np.sum((leap > apart).sum(axis=1) >= least) < SHARE * min(PART, len(position)):
            return np.zeros(0), np.zeros(0, bool)
        back = np.zeros((len(position) - first, position.shape[1]), bool)
        for rows in BEFORE:
            between = np.min([np.abs(_change(position, k))[first - k :] for k in range(1, rows)], axis=0)
            back |= (between > apart) & (np.abs(_change(position, rows))[first - rows :] < BACK * between)
    # Positions of nothing but noise are by chance where they were, those of some joints.
    most = 2 * back.sum(axis=1) > (leap[first - 1 :] > apart).sum(axis=1)
    return np.max(leap[first - 1 :], axis=1, initial=0.0, where=back), (back.sum(axis=1) >= least) & most


def _change(position: np.ndarray, rows: int) -> np.ndarray:
    """Return by how much positions (m, n) [rad] changed within so many rows, (m - rows, n); a joint that is counted
    within one turn does not leap by a turn."""
    change = position[rows:] - position[:-rows]
    with np.errstate(invalid="ignore"):
        counted = np.nanmax(np.abs(position), axis=0, initial=0.0) <= 2 * np.pi + 0.1
    return np.where(counted, (change + np.pi) % (2 * np.pi) - np.pi, change)
