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
    stops = np.concatenate([edges, [len(moving)]])
    for a, b in zip(starts, stops, strict=True):
        run = moving[a:b]
        origin = position[run[0] - 1] if run[0] > 0 else position[run[0]]
        travel = np.abs(position[run] - origin)
        if spring:
            z[run] = np.clip(value + sense[a] * travel / distance, -1.0, 1.0)
        else:
            z[run] = sense[a] + (value - sense[a]) * np.exp(-travel / distance)
        value = z[run[-1]]
    still = np.flatnonzero(direction == 0)
    if len(still):
        last = np.searchsorted(moving, still) - 1
        z[still] = np.where(last >= 0, z[moving[np.maximum(last, 0)]], z[moving[0]])
    return z
