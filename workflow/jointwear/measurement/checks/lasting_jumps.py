"""Rows that do not follow each other: a position that jumps to another place and goes on from there."""

from __future__ import annotations

import numpy as np

from jointwear.files.wording import count, numbered
from jointwear.measurement.derived.jumps import lasting_jumps
from jointwear.measurement.recording import Recording, elapsed_time
from jointwear.measurement.refused import Refused


def check_rows_follow(recording: Recording) -> None:
    """Check that no position jumps to another place for good: where rows were lost or put in another order, recordings
    were joined, or a joint counts anew, every velocity about it is wrong, and maybe the posture.

    Raises
    ------
    Refused : with the joints, the first such sample, and how far it lies from the one before.
    """
    time, position = elapsed_time(recording.time, recording.trajectory), recording.position
    jumped = lasting_jumps(time, recording.trajectory, position)
    rows = np.flatnonzero(jumped.any(axis=1))
    if not len(rows):
        return
    row = rows[0]
    joints = np.flatnonzero(jumped[row])
    before = [np.flatnonzero(np.isfinite(position[:row, j]))[-1] for j in joints]
    far = float(np.abs(position[row, joints] - position[before, joints]).max())
    more = f", and so at {count(len(rows) - 1, 'more sample')}" if len(rows) > 1 else ""
    raise Refused(
        f"data set '{recording.name}': the position of {numbered('joint', joints + 1)} jumps by {far:.3g} rad at "
        f"sample {row + 1} ({recording.time[row]:.9g} s) and goes on from there{more}: rows were lost or put in "
        "another order, recordings were joined, or a joint counts anew",
        "mend the rows; where another recording begins there, give it a label of its own under 'trajectory'",
        by_keys=True,
    )
