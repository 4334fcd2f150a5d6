"""Shifts: the runs of windows between two longer pauses, which share what one day brings (weather, product, oil).

A robot that never stops has no pauses; its time is cut into equal parts instead, of a day, or as long as a working
shift where one program runs alone; shorter where the baseline would not hold several of them. Whether it stops is told
by the baseline: a longer run that comes later is cut into days.
"""

from __future__ import annotations

import numpy as np

#: A pause [h] that ends a shift, and the same in windows where they are long.
PAUSE_HOURS, PAUSE_WINDOWS = 2.5, 2.0
#: Fewest shifts of a baseline that an axis is learnt from.
FEWEST_SHIFTS = 3
#: Longest shift [h]; where operation never stops, the length [h] of a part of a steady one; the baseline shall hold
#: this many parts of at least so many windows.
LONGEST_HOURS, PART_HOURS, PARTS, FEWEST_WINDOWS = 24.0, 8.0, 6, 4


def shift_labels(start: np.ndarray, end: np.ndarray, baseline: np.ndarray, steady: bool = False) -> np.ndarray:
    """Return the number of the shift of every window, rising from 0, (w,) int.

    Parameters
    ----------
    start, end : (w,) [s] borders of the windows in order of time. baseline : (w,) bool, windows of the baseline.
    steady : one program runs alone, so that a day brings little that part of it does not.

    Notes
    -----
    Cuts depend on the start of a run, and on the baseline and the runs up to its end, so that a window that arrives
    later moves none.
    """
    if not len(start):
        return np.zeros(0, dtype=np.int64)
    length = float(end[0] - start[0])
    pause = max(PAUSE_HOURS * 3600.0, PAUSE_WINDOWS * length)
    run = np.concatenate([[0], np.cumsum(start[1:] - end[:-1] > pause)])
    longest = LONGEST_HOURS * 3600.0
    begins = np.flatnonzero(np.diff(run, prepend=-1))
    first = start[begins]
    whole = end[np.append(begins[1:], len(run)) - 1] - first
    if baseline.any() and float(np.minimum(whole, _told_until(run, end, baseline) - first).max()) > longest:
        most = PART_HOURS * 3600.0 if steady else longest
        part = float(baseline.sum()) * length / PARTS
        longest = float(np.clip(part, FEWEST_WINDOWS * length, max(most, FEWEST_WINDOWS * length)))
    else:
        longest = max(longest, FEWEST_WINDOWS * length)
    part = np.floor((start - first[run]) / longest + 1e-9).astype(np.int64)
    change = (np.diff(run) != 0) | (np.diff(part) != 0)
    return np.concatenate([[0], np.cumsum(change)])


def _told_until(run: np.ndarray, end: np.ndarray, baseline: np.ndarray) -> float:
    """Return up to which time [s] the lengths of runs tell that a robot never stops: the end of the baseline, as what
    runs on after it would cut all shifts anew. From too few runs nothing is learnt, and nothing has been judged by
    shifts: there the run in which the baseline ends counts as a whole.

    Parameters
    ----------
    run : (w,) number of the run of every window. end : (w,) [s]. baseline : (w,) bool, some of it.
    """
    last = np.flatnonzero(baseline)[-1]
    few = len(np.unique(run[baseline])) < FEWEST_SHIFTS
    return float(end[run == run[last]].max() if few else end[last])


def places_of_shifts(shift: np.ndarray, count: int) -> np.ndarray:
    """Return for each window the last window so far of its own and of the `count` - 1 shifts before, (w, count).

    -1 where there is no such shift.
    """
    w = len(shift)
    result = np.full((w, count), -1, dtype=np.int64)
    result[:, 0] = np.arange(w)
    known, position = np.unique(shift, return_inverse=True)
    last = np.searchsorted(position, np.arange(len(known)), side="right") - 1
    before = position[:, None] - np.arange(1, count)
    result[:, 1:] = np.where(before >= 0, last[np.maximum(before, 0)], -1)
    return result


def shift_starts(shift: np.ndarray) -> np.ndarray:
    """Return which windows are the first of their shift, (w,) bool; `shift` (w,) labels."""
    return np.diff(shift, prepend=shift[:1] - 1) != 0


def running_sums(values: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return sums (w,) of `values` (w,) from the start of each window's shift up to it; `starts` (w,) bool."""
    total = np.cumsum(values)
    before = np.concatenate([[0.0], total[:-1]])
    first = np.maximum.accumulate(np.where(starts, np.arange(len(values)), 0))
    return total - before[first] if len(values) else total
