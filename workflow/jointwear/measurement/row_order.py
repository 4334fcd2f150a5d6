"""Rows that a logger wrote twice, or with a time that is not later than that of the row before."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import fields, replace

import numpy as np

from jointwear.files.wording import count as counted
from jointwear.measurement.formats.chunk import Chunk
from jointwear.statistics.runs import runs

#: Largest share of the rows whose time may be out of order: more is a clock that was set back, or another log.
MOST = 0.01


def rows_in_order(log: Chunk, trajectory: np.ndarray) -> tuple[Chunk, np.ndarray, str]:
    """Return a log without the few rows that do not follow the others in time, its labels, and what went in words.

    Left out are copies of the row before to the last digit, and the fewest rows without which time rises in each
    trajectory; where those are more than `MOST` of all, none of them.

    Parameters
    ----------
    trajectory : (m,) labels.
    """
    columns = {f.name: x for f in fields(log) if isinstance(x := getattr(log, f.name), np.ndarray)}
    copies = _copies(columns.values(), len(log.time))
    late = np.zeros(len(copies), bool)
    late[~copies] = _out_of_order(log.time[~copies], trajectory[~copies])
    if late.mean() > MOST:
        late[:] = False
    kept = ~(copies | late)
    if kept.all():
        return log, trajectory, ""
    told = [
        f"{counted(int(found.sum()), 'row')} {'was' if found.sum() == 1 else 'were'} left out as {words}"
        for found, words in (
            (copies, "copies of the row before, time and all"),
            (late, "out of order in time"),
        )
        if found.any()
    ]
    return replace(log, **{name: x[kept] for name, x in columns.items()}), trajectory[kept], "; ".join(told)


def _copies(columns, count: int) -> np.ndarray:
    """Return which rows (m,) hold in all columns (m, ...) what the row before holds."""
    same = np.ones(max(count - 1, 0), bool)
    for values in columns:
        before, after = values[:-1], values[1:]
        equal = before == after
        if values.dtype.kind == "f":
            equal |= np.isnan(before) & np.isnan(after)
        same &= equal.all(axis=tuple(range(1, equal.ndim)))
    return np.concatenate([np.zeros(min(count, 1), bool), same])


def _out_of_order(time: np.ndarray, trajectory: np.ndarray) -> np.ndarray:
    """Return the fewest rows (m,) without which time rises within each trajectory."""
    found = np.zeros(len(time), bool)
    for run in runs(trajectory):
        if np.all(time[run][1:] > time[run][:-1]) or not np.isfinite(time[run]).all():
            continue
        # The longest rising sequence: for each length the row with the earliest time in which one can end.
        ends: list[float] = []
        last: list[int] = []
        before = np.full(run.stop - run.start, -1)
        for k, stamp in enumerate(time[run].tolist()):
            place = bisect_left(ends, stamp)
            before[k] = last[place - 1] if place else -1
            ends[place : place + 1] = [stamp]
            last[place : place + 1] = [k]
        found[run] = True
        k = last[-1]
        while k >= 0:
            found[run.start + k] = False
            k = before[k]
    return found
