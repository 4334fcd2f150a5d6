"""Samples that were stamped when a packet of them arrived, as messages over a network are: bursts, and then a wait.

The arm moves from sample to sample of a burst as far as from one burst to the next: the samples are even, and their
stamps are those of the packets.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from jointwear.measurement.formats.chunk import Chunk

#: Part of a long step below which a step is one within a burst; a long step is the ninth of ten.
WITHIN = 0.25
#: Fewest of the steps that lie within bursts: less than half of them in bursts of two, of which some are incomplete.
MANY = 0.4
#: Part of the packets that have to come at the pace of the others, within a factor of two.
STEADY = 0.8
#: Long steps after which a log stood still: the packets before and behind are looked at apart.
PAUSE = 20.0
#: Fewest samples by which packets are told.
FEWEST_OF_LOG = 40


def without_bursts(chunk: Chunk) -> Chunk:
    """Return a chunk with the times of samples that came in bursts spread evenly from packet to packet."""
    time = np.array(chunk.time, dtype=float)
    labels = np.zeros(len(time)) if chunk.trajectory is None else chunk.trajectory
    # Stamps of a damaged log may be any number.
    with np.errstate(invalid="ignore", over="ignore"):
        steps = np.diff(time)
        usual = _long_step(steps)
        if usual is None:
            return chunk
        whole = (steps >= 0) & (steps <= PAUSE * usual) & (np.diff(labels) == 0)
    edges = np.concatenate([[0], np.flatnonzero(~whole) + 1, [len(time)]])
    for a, b in itertools.pairwise(edges):
        time[a:b] = _spread(time[a:b], chunk.position[a:b])
    return replace(chunk, time=time)


def _long_step(steps: np.ndarray) -> float | None:
    """Return the ninth of ten steps (k,) [s] that rise, None unless many others are far shorter."""
    known = steps[np.isfinite(steps) & (steps >= 0)]
    if len(known) < FEWEST_OF_LOG:
        return None
    long = float(np.quantile(known, 0.9))
    return long if np.mean(known <= WITHIN * long) >= MANY else None


def _spread(time: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return times (k,) [s] spread evenly from packet to packet, as they are where they are no packets.

    Parameters
    ----------
    time : (k,) that does not fall. position : (k, n) [rad].
    """
    steps = np.diff(time)
    long = _long_step(steps)
    if long is None:
        return time
    short = steps <= WITHIN * long
    moved = np.nansum(np.abs(np.diff(position, axis=0)), axis=1)
    # Right stamps have next to no motion in what is next to no time.
    if moved.sum() > 0 and moved[short].sum() < 0.5 * short.mean() * moved.sum():
        return time
    ends = np.concatenate([np.flatnonzero(~short), [len(time) - 1]])
    begins = np.concatenate([[0], ends[:-1] + 1])
    count, arrived = ends - begins + 1, time[ends]
    wait = np.diff(arrived)
    pace = wait / count[1:]
    if len(pace) < 3:
        return time
    step = float(np.median(pace))
    if np.mean((pace > 0.5 * step) & (pace < 2.0 * step)) < STEADY:
        return time
    # Where packets are missing the samples are those before the arrival.
    each = np.concatenate([[step], np.where(wait > (count[1:] + 0.5) * step, step, pace)])
    back = np.repeat(ends, count) - np.arange(len(time))
    return np.repeat(arrived, count) - back * np.repeat(each, count)
