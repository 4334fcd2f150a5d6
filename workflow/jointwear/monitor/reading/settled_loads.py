"""Loads at the flange that a window does not show clearly by itself, and other windows do.

How much of its torque a load explains goes from window to window: where the variance falls by about what it must, one
program would split into windows with and without its load, two levels of friction. A load is thus believed where the
moments of one that several other windows show clearly leave the window half of its variance or less. Of a window
without the load these moments leave more than there was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.load_search import HALVES
from jointwear.monitor.reading.loads_of_windows import LoadsOfWindows
from jointwear.monitor.reading.windows import PER_WINDOW, WindowStatistics

#: Times that a load must be shown clearly for other windows to be believed to carry it: what one says may be chance.
FEWEST_CLEAR = 3


def with_settled_loads(pieces: Sequence[Piece]) -> list[Piece]:
    """Return logs with their windows read with the loads that those of all logs together show."""
    shown = [p.loads.moments[p.loads.clear] for p in pieces]
    # Copies of a log, and windows too short to show a load alone, show the same one.
    known = np.unique(np.concatenate(shown), axis=0) if shown else np.zeros((0, 4))
    return [_settled(piece, known) for piece in pieces] if len(known) >= FEWEST_CLEAR else list(pieces)


def _settled(piece: Piece, known: np.ndarray) -> Piece:
    """Return a log with its settled windows; `known` (k, 4) moments of clear loads."""
    loads = piece.loads
    if loads.doubtful is None:
        return piece
    waiting, told = loads.start[~loads.clear], shown_by_others(loads, known)
    # Such windows are read with all of their loads or without those that are not clear.
    settled = np.setdiff1d(waiting, waiting[~told])
    return replace(piece, statistics=_with_rows(piece.statistics, loads.doubtful, settled))


def shown_by_others(loads: LoadsOfWindows, known: np.ndarray) -> np.ndarray:
    """Return which (d,) of the loads that are not clear are those of other windows; `known` (k, 4) their moments."""
    rows = ~loads.clear
    apart = loads.moments[rows][:, None, :] - known
    falls = loads.fall[rows][:, None] - np.einsum("dka,dab,dkb->dk", apart, loads.information[rows], apart)
    return np.sum(falls > np.log(HALVES), axis=1) >= FEWEST_CLEAR


def _with_rows(statistics: WindowStatistics, other: WindowStatistics, starts: np.ndarray) -> WindowStatistics:
    """Return windows, those that begin at `starts` (s,) [s] taken from `other`."""
    own = np.flatnonzero(np.isin(statistics.start, starts))
    if not len(own):
        return statistics
    theirs = np.searchsorted(other.start, statistics.start[own])
    values = {name: getattr(statistics, name).copy() for name in PER_WINDOW}
    for name, rows in values.items():
        rows[own] = getattr(other, name)[theirs]
    return replace(statistics, **values)
