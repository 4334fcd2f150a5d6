"""Loads at the flange that single windows of a log show, and these windows read with those that are not clear.

A log is read once and by itself; whether a load that is not clear is there other logs tell (:mod:`.settled_loads`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from jointwear.monitor.reading.carried import FoundLoad
from jointwear.monitor.reading.windows import WindowStatistics, merge


@dataclass(frozen=True)
class LoadsOfWindows:
    """Loads of windows, k in all.

    Attributes
    ----------
    start : (k,) [s] of the window that shows the load. moments, fall, information : (k, 4), (k,), (k, 4, 4) as of
        :class:`.load_search.Load`. clear : (k,) bool, whether the statistics hold it.
    doubtful : the windows that show a load which is not clear, read with all of their loads; None without such.
    """

    start: np.ndarray
    moments: np.ndarray
    fall: np.ndarray
    information: np.ndarray
    clear: np.ndarray
    doubtful: WindowStatistics | None = None

    def __len__(self) -> int:
        return len(self.start)


#: Fields with one row a load.
PER_LOAD = tuple(f.name for f in fields(LoadsOfWindows) if f.name != "doubtful")


def no_loads() -> LoadsOfWindows:
    """Return no load of no window."""
    return LoadsOfWindows(np.zeros(0), np.zeros((0, 4)), np.zeros(0), np.zeros((0, 4, 4)), np.zeros(0, dtype=bool))


def loads_of_windows(
    found: Sequence[FoundLoad], time: np.ndarray, windows: np.ndarray, length: float
) -> LoadsOfWindows:
    """Return the loads that samples at `time` (m,) [s] show, by those of the `windows` (w,) [s] that they begin in."""
    rows = []
    for one in found:
        starts = np.unique(np.concatenate([np.floor(time[piece] / length) for piece, _ in one.pieces])) * length
        load = one.load
        rows += [
            (start, load.moments, load.fall, load.information, load.clear) for start in starts[np.isin(starts, windows)]
        ]
    return LoadsOfWindows(*(np.array(column) for column in zip(*rows, strict=True))) if rows else no_loads()


def all_loads(parts: Iterable[LoadsOfWindows], doubtful: WindowStatistics | None = None) -> LoadsOfWindows:
    """Return the loads of several parts of a log, and the `doubtful` windows of all of it."""
    rows = [no_loads(), *parts]
    return LoadsOfWindows(*(np.concatenate([getattr(p, name) for p in rows]) for name in PER_LOAD), doubtful)


def doubtful_windows(loads: Sequence[LoadsOfWindows], read: Sequence[WindowStatistics]) -> WindowStatistics | None:
    """Return the windows of parts of a log with a load that is not clear, of those `read` with them; None without."""
    starts = np.concatenate([part.start[~part.clear] for part in loads])
    if not len(starts):
        return None
    whole = merge(read)
    return whole.part(np.isin(whole.start, starts))
