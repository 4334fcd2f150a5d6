"""Positions and torques in rows of their own, as where two streams of a logger are put together by their times."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.formats.chunk import JOINT_ROLES, Chunk

#: Share of the rows that hold positions and torques, at most, where they stand in rows of their own; shares of the rows
#: with positions alone, and with torques alone, at least: positions that are far rarer than torques show no motion
#: between them.
TOGETHER, POSITIONS, TORQUES = 0.05, 0.3, 0.1
#: Usual steps between positions that a torque may lie in: others are missing there.
STEPS = 3.0


def in_one_row(chunk: Chunk) -> Chunk:
    """Return a chunk with the rows of the torques alone, and what else was measured at their times, where positions and
    torques stand in rows of their own; all others as they are.

    What stands in other rows goes on from one of them to the next by cubic splines, within a trajectory.
    """
    there = np.isfinite(chunk.position).any(axis=1)
    felt = np.isfinite(chunk.torque).any(axis=1)
    rows = max(len(chunk.time), 1)
    shares = [(there & felt).sum() / rows, (there & ~felt).sum() / rows, (felt & ~there).sum() / rows]
    if shares[0] > TOGETHER or shares[1] < POSITIONS or shares[2] < TORQUES:
        return chunk
    arrays = {
        name: None if (x := getattr(chunk, name)) is None else x[felt] for name in ("time", "trajectory", "program")
    }
    labels = np.zeros(rows, int) if chunk.trajectory is None else chunk.trajectory
    for role in JOINT_ROLES:
        values = getattr(chunk, role)
        if values is not None:
            arrays[role] = values[felt] if role == "torque" else _at(chunk.time, values, labels, felt)
    return replace(chunk, **arrays)


def _at(time: np.ndarray, values: np.ndarray, labels: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return what a role (m, n) is in the `wanted` (m,) rows, NaN where none is near."""
    from scipy.interpolate import CubicSpline

    result = values.copy()
    for label in np.unique(labels[wanted]):
        ask = np.flatnonzero(wanted & (labels == label))
        for j, column in enumerate(values.T):
            known = np.flatnonzero((labels == label) & np.isfinite(column) & np.isfinite(time))
            known = known[np.concatenate([[True], np.diff(time[known]) > 0])] if len(known) else known
            if len(known) < 4 or not np.all(np.diff(time[known]) > 0):
                continue
            at, steps = time[known], np.diff(time[known])
            after = np.searchsorted(at, time[ask], side="left")
            inside = (time[ask] >= at[0]) & (time[ask] <= at[-1])
            near = inside & (steps[np.clip(after - 1, 0, len(steps) - 1)] <= STEPS * np.median(steps))
            empty = ask[near & ~np.isfinite(column[ask])]
            result[empty, j] = CubicSpline(at, column[known])(time[empty])
    return result[wanted]
