"""Long data sets: as much of them is read as a search takes in, spread over the whole of them.

What a search costs grows faster than its samples, in memory too: an hour of six joints at 125 Hz would need more than
most machines have. Whole trajectories are left out before the others become short, because splines and filters give up
the ends of each; of one that is too long its middle is kept.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.files.wording import count
from jointwear.measurement.derived.motion import decimation
from jointwear.measurement.recording import Recording
from jointwear.statistics.runs import runs

#: Samples that are read at most, after rates that are high have been reduced: eight minutes at 100 Hz.
MOST = 48_000
#: Part of them that test trajectories may have where both are long.
TEST_SHARE = 0.2
#: Time [s] of a trajectory below which others are left out before it is cut.
SHORTEST = 20.0


def shortened(recording: Recording, keep_all: bool = False, most: int = MOST) -> tuple[Recording, list[str]]:
    """Return what is read of a recording, and that in words; nothing is said of one that is read as it is.

    Parameters
    ----------
    recording : with `train` and `test` filled in. keep_all : no trajectory may be left out, as groups name each.
    most : samples.
    """
    steps = np.diff(recording.time)[np.diff(recording.trajectory) == 0]
    step = float(np.median(steps)) if len(steps) else 0.0
    if not step > 0:
        # The clock does not run: that is for the checks to tell.
        return recording, []
    rate = 1.0 / step
    every = decimation(rate)
    parts = runs(recording.trajectory)
    size = {int(recording.trajectory[part.start]): (part.stop - part.start) for part in parts}
    labels = {"train": list(recording.train), "test": list(recording.test)}
    total = {role: sum(size[k] for k in own) / every for role, own in labels.items()}
    if total["train"] + total["test"] <= most:
        return recording, []
    room = {
        "test": max(TEST_SHARE * most, most - total["train"]),
        "train": max((1.0 - TEST_SHARE) * most, most - total["test"]),
    }
    length: dict[int, int] = {}
    for role, given in labels.items():
        sizes = np.array([size[k] for k in given])
        own = given if keep_all else _spread(given, sizes, room[role] * every, SHORTEST * rate)
        longest = _level(np.array([size[k] for k in own], dtype=float), room[role] * every)
        length |= {k: int(min(size[k], longest)) for k in own}
    begin = {int(recording.trajectory[part.start]): part.start for part in parts}
    first = {k: begin[k] + (size[k] - length[k]) // 2 for k in begin if k in length}
    read = recording.part(np.concatenate([np.arange(a, a + length[k]) for k, a in first.items()]))
    train, test = (tuple(k for k in own if k in length) for own in labels.values())
    return replace(read, train=train, test=test), [_in_words(size, length, rate)]


def _in_words(size: dict[int, int], length: dict[int, int], rate: float) -> str:
    """Return in words what is read; label -> samples that there are, and that are read."""
    whole, seconds = (sum(own.values()) / rate for own in (size, length))
    cut = sum(length[k] < size[k] for k in length)
    which = "all" if cut == len(length) else str(cut)
    words = f"of {whole:.0f} s of motion {seconds:.0f} s are read, which is as much as a search takes in: "
    words += f"{len(length)} of {count(len(size), 'trajectory', 'trajectories')}"
    return words + (f", of {which} of them the middle" if cut else "")


def _spread(labels: list[int], size: np.ndarray, room: float, shortest: float) -> list[int]:
    """Return the labels, evenly spread, that have room for `shortest` samples each, or for all that they have."""
    needed = np.minimum(size, shortest)
    if needed.sum() <= room:
        return labels
    # Rates are of rounded times.
    count = max(int(room / max(float(np.mean(needed)), 1.0) + 1e-6), 1)
    return [labels[k] for k in np.unique(np.linspace(0, len(labels) - 1, count).round().astype(int))]


def _level(size: np.ndarray, room: float) -> float:
    """Return the length up to which each of `size` (k,) is kept for all of them to fill `room`; infinite if all fit."""
    if size.sum() <= room:
        return np.inf
    ordered = np.sort(size)
    # With the j shortest kept whole, the others share what is left.
    share = (room - np.concatenate([[0.0], np.cumsum(ordered)[:-1]])) / np.arange(len(size), 0, -1)
    return float(share[np.flatnonzero(share < ordered)[0]])
