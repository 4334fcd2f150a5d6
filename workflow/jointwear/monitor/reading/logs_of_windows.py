"""Which log each window comes from: what lies in one log alone, or in one that was refused in part, is first of all a
question to that log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.files.wording import listed, name_axes
from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.assembly import Piece
from jointwear.monitor.reading.windows import WindowStatistics

#: Time [s] around refused samples of a log in which its others tell nothing: a fault of the columns or of the unit is
#: in all of what was written with it, and refused where it shows.
AROUND = 86400.0
#: Most logs that a finding names as its cause.
FEW = 2


@dataclass(frozen=True)
class LogsOfWindows:
    """`names` of the logs; `number` (w,) of the log that each window comes from, -1 unknown; `doubtful` (w,) bool,
    windows of a log that was refused near them; `flags` (w, n) bit fields."""

    names: tuple[str, ...]
    number: np.ndarray
    doubtful: np.ndarray
    flags: np.ndarray

    def few(self, rows: np.ndarray) -> list[str]:
        """Return the names of the logs that windows (k,) come from where these are few, else none."""
        numbers = np.unique(self.number[rows])
        if not len(numbers) or numbers[0] < 0 or len(numbers) > FEW:
            return []
        return [self.names[k] for k in numbers]

    def faults(self, rows: np.ndarray) -> str:
        """Return in words what else is odd about the logs of windows (k,), empty where nothing is."""
        flags = self.flags[np.isin(self.number, np.unique(self.number[rows]))]
        told = []
        if (flags & int(Flag.REFUSED)).any():
            told.append("samples of it were refused")
        for flag, words in (
            (Flag.TORQUE_FROZEN, "the torque of {axes} keeps one value in it"),
            (Flag.CONTRADICTED, "the torque of {axes} fits no model in it"),
            (Flag.NOT_FINITE, "values of {axes} are missing in it"),
        ):
            axes = (np.flatnonzero((flags & int(flag) != 0).any(axis=0)) + 1).tolist()
            if axes:
                told.append(words.format(axes="all axes" if len(axes) == flags.shape[1] else name_axes(axes)))
        return listed(told) if told else ""


def logs_of_windows(pieces: Sequence[Piece], statistics: WindowStatistics) -> LogsOfWindows:
    """Return which of the logs in their order the windows come from; one that several share is of the last of them."""
    number = np.full(statistics.windows, -1)
    doubtful = np.zeros(statistics.windows, dtype=bool)
    for k, piece in enumerate(pieces):
        own = piece.statistics
        if not own.windows:
            continue
        there = np.isin(np.rint(statistics.start / statistics.length), np.rint(own.start / own.length))
        number[there] = k
        refused = own.start[(own.flags & int(Flag.REFUSED) != 0).any(axis=1)]
        if len(refused):
            rows = np.flatnonzero(there)
            apart = np.abs(statistics.start[rows][:, None] - refused).min(axis=1)
            doubtful[rows[apart <= AROUND]] = True
    return LogsOfWindows(tuple(p.log for p in pieces), number, doubtful, statistics.flags)
