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
#: Longest step of time [s] of logs in which single samples are asked for though an acceleration may be as short: such
#: a sample differs from those beside it by this multiple of the range of all others, which is that of an arm at work,
#: this multiple of the usual change from sample to sample: that of noise at rest is 8.
SLOWEST, BEYOND, AT_WORK = 0.1, 2.0, 20.0
#: Share of the samples that are spikes, at most: more of them are a signal.
FEW = 0.02


def spikes(time: np.ndarray, trajectory: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Return which torques are none of the arm, (m, n) bool: those that differ from the torques beside them by more
    than the whole range of all other torques of their joint.

    In logs too slow to show that a spike is shorter than an acceleration, one sample that differs by twice that range.

    Parameters
    ----------
    time : (m,) [s]. trajectory : (m,) labels. torque : (m, n) [N m]; NaN where it is missing.
    """
    found = np.zeros(torque.shape, bool)
    pieces = pieces_of(time, trajectory)
    label = np.repeat(np.arange(len(pieces)), [piece.stop - piece.start for piece in pieces])
    slow = _is_slow(time, label)
    for j, values in enumerate(torque.T):
        known = np.isfinite(values)
        if not _may_hold_any(values[known], label[known]):
            continue
        apart = np.zeros(len(values))
        for piece in pieces:
            rows = piece.start + np.flatnonzero(known[piece])
            apart[rows] = _from_neighbours(time[rows], values[rows])
        beyond = BEYOND if slow else 1.0
        away = _beyond_all_others(apart / beyond, values)
        found[:, j] = away & (not slow or _at_work(values[known & ~away], label[known & ~away]))
    return found


def _is_slow(time: np.ndarray, label: np.ndarray) -> bool:
    """Return whether the usual step of times (m,) [s] in pieces `label` (m,) is too long for one sample between two."""
    steps = np.diff(time)[label[1:] == label[:-1]]
    return len(steps) > 0 and _samples(float(np.median(steps))) < 1


def _samples(step: float) -> int:
    """Return how many samples at steps [s] are shorter than an acceleration, at most those of a spike."""
    return min(int(LONGEST / max(step, 1e-9)) - 1, SAMPLES)


def _at_work(values: np.ndarray, label: np.ndarray) -> bool:
    """Return whether the range of values (k,) is more than that of noise at rest; `label` (k,) of pieces."""
    steps = np.abs(np.diff(values))[label[1:] == label[:-1]]
    return len(steps) > 0 and float(np.ptp(values)) > AT_WORK * float(np.median(steps))


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
    step = float(np.median(steps))
    if step > SLOWEST:
        return np.zeros(len(values))
    many = max(_samples(step), 1)
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
