"""Rows in which a logger wrote once more what it had written before, while the robot moved on."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.checks import FEWEST, Refused
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording

#: Encoder steps that a joint makes in each row, at least, where a row that repeats the one before is none of motion.
STEPS = 2.0


def check_rows_are_new(samples: Chunk | Recording, stretch: np.ndarray, name: str) -> None:
    """Check that rows of fast motion are measured anew: one that repeats position and torque of all joints is not.

    A joint that has made many of its smallest steps from one change to the next has passed some in every row between.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.

    Raises
    ------
    Refused : where rows repeat before more than half of the changes, with how long values are held.
    """
    if len(samples.time) < FEWEST:
        return
    values = np.concatenate([samples.position, samples.torque], axis=1)
    with np.errstate(invalid="ignore"):
        moved = np.abs(np.diff(samples.position, axis=0))
        changed = np.any(np.diff(values, axis=0) != 0.0, axis=1) | (np.diff(stretch) != 0)
    # Row k + 1 against row k: rows since the change before, the change itself included.
    places = np.flatnonzero(changed)
    if len(places) < 2:
        return
    rows = np.diff(places, prepend=places[0] - 1)
    inside = (np.diff(stretch) == 0)[places]
    smallest = np.where(moved > 0.0, moved, np.inf).min(axis=0)
    steps = np.nanmax(np.nan_to_num(moved[places]) / smallest, axis=1)
    fast = inside & (steps > STEPS * rows)
    if fast.sum() < FEWEST:
        return
    repeated = float(np.mean(rows[fast] > 1))
    if repeated > 0.5:
        held = float(np.median(np.diff(samples.time))) * float(np.median(rows[fast]))
        raise Refused(
            f"{name}: before {100 * repeated:.0f} % of the rows of fast motion in which something changes, rows repeat "
            f"the positions and torques of all joints; the logger holds values, for about {held:.2g} s",
            "write each value once, at the time at which it was measured, and not on a faster grid",
        )
