"""Friction that builds up after reversals: the state of one bristle along a recording."""

from __future__ import annotations

import numpy as np


def bristle(position, direction, distance, spring=0, start=1):
    """Return the state z in [-1, 1] of the friction along one record, shape (m,).

    Dahl's dz/dq = (1 - s z)/x0 has the exact solution z = s + (z_r - s) exp(-|q - q_r|/x0) between reversals r; with
    `spring` dz/dq = 1/x0 until the spring slips at z = s. A joint at rest holds z. A record starts with `start` times
    the sense of its first motion over more than `distance`: its past is unknown, and at rest the sense is noise.
    """
    moving = np.flatnonzero(direction)
    z = np.zeros(len(position))
    if not len(moving):
        return z
    sense = direction[moving]
    edges = np.flatnonzero(np.diff(sense)) + 1
    beyond = np.flatnonzero(np.abs(position - position[0]) > distance)
    value = start * (np.sign(position[beyond[0]] - position[0]) if len(beyond) else sense[0])
    starts = np.concatenate([[0], edges])
    lengths = np.diff(np.append(starts, len(moving)))
    origin = position[np.maximum(moving[starts] - 1, 0)]
    travel = np.abs(position[moving] - np.repeat(origin, lengths)) / distance
    left = None if spring else np.exp(-travel)
    # From one reversal to the next only the state at the last sample before it is handed on.
    before = np.empty(len(starts))
    for k, (first, length) in enumerate(zip(starts.tolist(), lengths.tolist(), strict=True)):
        before[k], way, last = value, sense[first], first + length - 1
        value = min(max(value + way * travel[last], -1.0), 1.0) if spring else way + (value - way) * left[last]
    before = np.repeat(before, lengths)
    z[moving] = np.clip(before + sense * travel, -1.0, 1.0) if spring else sense + (before - sense) * left
    still = np.flatnonzero(direction == 0)
    if len(still):
        last = np.searchsorted(moving, still) - 1
        z[still] = np.where(last >= 0, z[moving[np.maximum(last, 0)]], z[moving[0]])
    return z


def travel_since_reversal(position, direction):
    """Return how far a joint has gone from where it last turned round, along one record, shape (m,), NaN before that.

    A joint at rest holds it.
    """
    moving = np.flatnonzero(direction)
    travel = np.full(len(position), np.nan)
    turns = np.flatnonzero(np.diff(direction[moving])) + 1
    if not len(turns):
        return travel
    origin = position[moving[turns] - 1]
    latest = np.searchsorted(moving[turns], np.arange(len(position)), side="right") - 1
    return np.where(latest >= 0, np.abs(position - origin[np.maximum(latest, 0)]), travel)


def relaxing_bristle(position, time, distance, relaxation, start=1):
    """Return the state z in [-1, 1] of friction along one record whose spring creeps too, as seals do, shape (m,).

    Maxwell's spring and damper that slips: dz/dt = v/x0 - z/`relaxation` [s] until abs(z) = 1, so that z falls to 1/e
    within that time at rest. Position and `time` (m,) [s] go evenly from sample to sample; `start` is that of
    :func:`bristle`.
    """
    passed = np.diff(time, prepend=time[0]) / relaxation
    kept = np.exp(-passed)
    held = np.divide(1 - kept, passed, out=np.ones_like(passed), where=passed > 0)
    gained = held * np.diff(position, prepend=position[0]) / distance
    away = position - position[0]
    beyond = np.flatnonzero(np.abs(away) > distance)
    value = start * np.sign(away[beyond[0]] if len(beyond) else away[np.argmax(np.abs(away))])
    z = []
    for keep, gain in zip(kept.tolist(), gained.tolist(), strict=True):
        value = keep * value + gain
        # Bounds in this form take a third of the time of `min` and `max`.
        value = -1.0 if value < -1.0 else 1.0 if value > 1.0 else value
        z.append(value)
    return np.array(z)
