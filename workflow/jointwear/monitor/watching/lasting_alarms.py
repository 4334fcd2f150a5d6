"""Alarms that last: until when one is open, and in which of its windows it is told.

A row of alarms.csv is of one segment: from a start at which the axis is learnt anew an alarm is a new one, however soon
after the last it comes. What leaves alarms open (another program) begins none.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from jointwear.monitor.watching.watched_axis import Start


def is_open(alarm: np.ndarray, starts: Sequence[Start]) -> np.ndarray:
    """Return the windows (w,) from the first alarm on until a start that closes it.

    Parameters
    ----------
    alarm : (w,) bool, of one axis. starts : of that axis, in order of time.
    """
    result = np.zeros(len(alarm), dtype=bool)
    edges = [0, *[s.window for s in starts if s.closes], len(alarm)]
    for a, b in itertools.pairwise(edges):
        result[a:b] = np.logical_or.accumulate(alarm[a:b])
    return result


def told_windows(alarm: np.ndarray, starts: Sequence[Start], news: Callable[[int, int, bool], bool]) -> np.ndarray:
    """Return the windows (w,) in which an alarm is told: the first of each segment, and those that are news after it.

    Parameters
    ----------
    alarm, starts : as of :func:`is_open`.
    news : of the window last told, the present one, and whether the last had been told again, whether that is news.
    """
    result = np.zeros(len(alarm), dtype=bool)
    edges = [0, *[s.window for s in starts if not s.kept], len(alarm)]
    for a, b in itertools.pairwise(edges):
        last, again = None, False
        for k in a + np.flatnonzero(alarm[a:b]):
            if last is None or news(last, int(k), again):
                result[k], last, again = True, int(k), last is not None
    return result
