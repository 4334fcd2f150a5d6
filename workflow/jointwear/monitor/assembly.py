"""Statistics of many logs as one history."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.windows import WindowStatistics, merge


@dataclass(frozen=True)
class Piece:
    """Statistics of one log: time of its first and last sample [s] (NaN if none), and what was refused, in words.

    `copy_of`: the log before it that holds the same samples, empty if none does; a copy has no windows.
    """

    log: str
    statistics: WindowStatistics
    first: float
    last: float
    refused: tuple[str, ...] = ()
    copy_of: str = ""


@dataclass(frozen=True)
class History:
    """All windows in order of time, and the pieces they come from; `shifted`: logs were laid end to end."""

    statistics: WindowStatistics
    pieces: tuple[Piece, ...]
    shifted: bool = False


def assemble(pieces: Sequence[Piece]) -> History:
    """Put the statistics of logs, in their order, together.

    Logs with dates go where their dates say. Logs without go on by their own clock; where one begins before the one
    before it ends, its clock was started anew, and it is moved on by whole windows to follow it. A log that holds the
    same samples as a dated one before it, under another name or in another format, counts once.
    """
    placed, end, last, shifted = [], -np.inf, -np.inf, False
    seen: dict[tuple, str] = {}
    for given in pieces:
        piece, statistics = given, given.statistics
        key = fingerprint(piece)
        if key in seen:
            # What was refused in it was refused in the log that it is a copy of, and is told there.
            placed.append(replace(piece, statistics=statistics.part(slice(0, 0)), refused=(), copy_of=seen[key]))
            continue
        if key is not None:
            seen[key] = piece.log
        if statistics.windows and not statistics.dated and piece.first < last:
            length = statistics.length
            shift = length * np.ceil((end - statistics.start.min()) / length - 1e-9)
            statistics = replace(statistics, start=statistics.start + shift, end=statistics.end + shift)
            piece = replace(piece, statistics=statistics, first=piece.first + shift, last=piece.last + shift)
            shifted = True
        if statistics.windows:
            end, last = max(end, float(statistics.end.max())), max(last, piece.last)
        placed.append(piece)
    return History(merge([p.statistics for p in placed]), tuple(placed), shifted)


def fingerprint(piece: Piece) -> tuple | None:
    """Return what two copies of one log have in common and two logs have not; None where nothing tells.

    That is without samples that show friction, or without dates: a clock that starts anew tells no two logs apart.

    Rounded, because formats keep numbers to different digits.
    """
    s = piece.statistics
    if not s.windows or not s.dated or not s.count.any():
        return None
    moments = tuple(f"{x:.4g}" for x in s.square.sum(axis=0))
    return (round(piece.first, 3), round(piece.last, 3), int(s.samples.sum()), *s.count.sum(axis=0).tolist(), *moments)
