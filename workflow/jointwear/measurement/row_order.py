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
    trajectory; where those are more than `MOST` of all, none of them. Of rows of one time in a row the first stays, as
    of a clock that stood still, or the last, as of rows that are stamped when they are written: the one that makes the
    steps to the rows before and after them more alike.

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
    repeated = late & _stamped_as_others(log.time, trajectory, ~(copies | late))
    kept = ~(copies | late)
    if kept.all():
        return log, trajectory, ""
    told = [
        f"{counted(int(found.sum()), 'row')} {'was' if found.sum() == 1 else 'were'} left out as {words}"
        for found, words in (
            (copies, "copies of the row before, time and all"),
            (repeated, "stamped with the repeated time of another row"),
            (late & ~repeated, "out of order in time"),
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
        # The longest rising sequence: for each length the row with the earliest time in which one can end, the first
        # of one time.
        ends: list[float] = []
        last: list[int] = []
        before = np.full(run.stop - run.start, -1)
        for k, stamp in enumerate(time[run].tolist()):
            place = bisect_left(ends, stamp)
            before[k] = last[place - 1] if place else -1
            if ends[place : place + 1] != [stamp]:
                ends[place : place + 1] = [stamp]
                last[place : place + 1] = [k]
        found[run] = True
        k = last[-1]
        while k >= 0:
            found[run.start + k] = False
            k = before[k]
        found[run] = ~_last_where_likelier(time[run], ~found[run])
    return found


def _last_where_likelier(time: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Return the rows (m,) that stay, of those of one time in a row the last where the step before them is longer."""
    rows, result = np.flatnonzero(kept), kept.copy()
    for earlier, row, later in zip(rows, rows[1:], rows[2:], strict=False):
        same = np.flatnonzero(time[row:later] != time[row])
        last = row + (same[0] if len(same) else later - row) - 1
        if time[row] - time[earlier] > time[later] - time[row]:
            result[row], result[last] = False, True
    return result


def _stamped_as_others(time: np.ndarray, trajectory: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Return which rows (m,) lie in a row of one time, of one trajectory, of which one row is kept (m,)."""
    other = (time[1:] != time[:-1]) | (trajectory[1:] != trajectory[:-1])
    block = np.concatenate([np.zeros(min(len(time), 1), int), np.cumsum(other)])
    return ~kept & (np.bincount(block, kept)[block] > 0)
