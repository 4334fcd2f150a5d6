"""Torques of a few samples that stand far out of all others: bytes that were lost, or a current switched on or off.

One such sample among thousands is taken for the noise of its joint, in which nothing can be seen then.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
from scipy.ndimage import median_filter

from jointwear.files.wording import count
from jointwear.measurement.derived.even_steps import pieces_of
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording, elapsed_time

S = TypeVar("S", Recording, Chunk)

#: Samples of a spike, at most, and the longest time [s] from the sample before it to the one behind: an acceleration of
#: an arm takes longer.
SAMPLES, LONGEST = 3, 0.05
#: Share of the samples that are spikes, at most: more of them are a signal.
FEW = 0.02


def spikes(time: np.ndarray, trajectory: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Return which torques are none of the arm, (m, n) bool: those that differ from the torques beside them by more
    than the whole range of all other torques of their joint.

    Parameters
    ----------
    time : (m,) [s]. trajectory : (m,) labels. torque : (m, n) [N m]; NaN where it is missing.
    """
    found = np.zeros(torque.shape, bool)
    pieces = pieces_of(time, trajectory)
    label = np.repeat(np.arange(len(pieces)), [piece.stop - piece.start for piece in pieces])
    for j, values in enumerate(torque.T):
        known = np.isfinite(values)
        if not _may_hold_any(values[known], label[known]):
            continue
        apart = np.zeros(len(values))
        for piece in pieces:
            rows = piece.start + np.flatnonzero(known[piece])
            apart[rows] = _from_neighbours(time[rows], values[rows])
        found[:, j] = _beyond_all_others(apart, values)
    return found


def _may_hold_any(values: np.ndarray, label: np.ndarray) -> bool:
    """Return whether finite values (k,) have a step as large as a spike has on its way out; `label` (k,) of pieces."""
    few = int(FEW * len(values))
    if len(values) <= 2 * SAMPLES or not few:
        return False
    # A spike differs from the median of its neighbours by at most as many steps as it has samples, and by more than the
    # range of all others, which is no less than what is left of it without so many at either end as may be spikes.
    low, high = np.partition(values, [few, len(values) - 1 - few])[[few, len(values) - 1 - few]]
    steps = np.abs(np.diff(values))
    return SAMPLES * float(steps.max(where=label[1:] == label[:-1], initial=0.0)) > float(high - low)


def _from_neighbours(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return by how much finite values (k,) at times (k,) [s] differ from the median of those around them."""
    if len(values) <= 2 * SAMPLES:
        return np.zeros(len(values))
    steps = np.diff(time, prepend=time[0])
    # As many samples as may be a spike, with one on either side, within the longest time.
    many = min(int(LONGEST / max(float(np.median(steps)), 1e-9)) - 1, SAMPLES)
    if many < 1:
        return np.zeros(len(values))
    return np.abs(values - median_filter(values, 2 * many + 1, mode="reflect"))


def _beyond_all_others(apart: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return which values (m,) are `apart` (m,) from their neighbours by more than the range of those that are not."""
    found = np.zeros(len(values), bool)
    known = np.isfinite(values)
    few = int(FEW * known.sum())
    if not few:
        return found
    # The range of all others is at least that of what is less apart than the mean: mostly there is no spike.
    apart = np.where(known, apart, -1.0)
    usual = values[known & (apart <= apart.mean(where=known))]
    if known.sum() - len(usual) >= few and apart.max() <= np.ptp(usual):
        return found
    order = np.argsort(apart)[::-1][:few]
    rest = known.copy()
    rest[order] = False
    # The range of what is left once the k that stand out most are gone.
    low = np.minimum.accumulate(np.concatenate([[values[rest].min()], values[order[::-1]]]))[::-1]
    high = np.maximum.accumulate(np.concatenate([[values[rest].max()], values[order[::-1]]]))[::-1]
    gone = np.flatnonzero(apart[order] > (high - low)[1:])
    if len(gone):
        found[order[: gone[-1] + 1]] = True
    return found


def spikes_of(recording: Recording) -> np.ndarray:
    """Return :func:`spikes` of a recording, (m, n) bool."""
    return spikes(elapsed_time(recording.time, recording.trajectory), recording.trajectory, recording.torque)


def without_spikes_of(samples: Chunk, stretch: np.ndarray) -> Chunk:
    """Return :func:`without_spikes` of samples of a log.

    Parameters
    ----------
    stretch : (m,) label of the uninterrupted run that each sample belongs to.
    """
    return without_spikes(samples, spikes(samples.time, stretch, samples.torque))


def without_spikes(samples: S, found: np.ndarray) -> S:
    """Return the samples with NaN for the torques that are none of the arm, `found` (m, n) bool."""
    return replace(samples, torque=np.where(found, np.nan, samples.torque)) if found.any() else samples


def spikes_in_words(found: np.ndarray) -> list[str]:
    """Return in words which joints have spikes (m, n) bool, and where the first is."""
    words = []
    for j in np.flatnonzero(found.any(axis=0)):
        torques = int(found[:, j].sum())
        differ = "differs from those beside it" if torques == 1 else "differ from those beside them"
        words.append(
            f"{count(torques, 'torque')} of joint {j + 1} {differ} by more than the whole range of all others, first "
            f"at sample {np.argmax(found[:, j]) + 1}: left out"
        )
    return words
