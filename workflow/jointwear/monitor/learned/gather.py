"""The stretches of motion in the baseline logs of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.clock import Clock, Ordered, part_of
from jointwear.measurement.formats import Chunk, Layout, read_log
from jointwear.measurement.timestamps import utc_seconds
from jointwear.measurement.turns import unwrapped
from jointwear.monitor.judging.baseline import baseline_of
from jointwear.monitor.plan import window_seconds

#: Longest piece of one stretch that is taken [s], so that many hours fit, and shortest that shows anything.
LONGEST, SHORTEST = 20.0, 4.0
#: Share of the samples of a piece that may be missing.
MISSING = 0.02
#: Samples that are read at a time.
ROWS = 50_000


@dataclass(frozen=True)
class Piece:
    """An uninterrupted run of samples of one log, in order of time; `chunk.time` [s] rises."""

    log: str
    chunk: Chunk

    @property
    def begin(self) -> float:
        """Time of the first sample [s]."""
        return float(self.chunk.time[0])

    @property
    def warmth(self) -> float:
        """Mean temperature [degC], NaN where it is not logged."""
        t = self.chunk.temperature
        return float(np.nanmean(t)) if t is not None and np.isfinite(t).any() else float("nan")


def baseline_pieces(logs: Sequence[str], layout: Layout, entry: Mapping[str, Any]) -> tuple[list[Piece], list[str]]:
    """Return the first piece of every window of the baseline, and what was refused.

    Parameters
    ----------
    logs : of the robot, in order. entry : its entry in the config, of which `window`, `baseline` and `time_zone` count.
    """
    length = window_seconds(entry.get("window", "1h"))
    within = _Baseline(baseline_of(entry), length)
    pieces: list[Piece] = []
    refused: list[str] = []
    shift, last = 0.0, -np.inf
    for log in logs:
        found: dict[int, list[Piece]] = {}
        try:
            for given in _stretches(log, layout, length):
                if not given.chunk.dated and given.begin + shift < last:
                    # A log without dates whose clock starts anew follows the one before it.
                    shift = length * np.ceil((last - given.begin) / length)
                piece = Piece(log, replace(given.chunk, time=given.chunk.time + shift))
                window = int(np.floor(piece.begin / length))
                last = max(last, float(piece.chunk.time[-1]))
                if within(window):
                    found.setdefault(window, []).append(piece)
        except InputError as error:
            refused.append(str(error))
        for candidates in found.values():
            pieces.append(max(candidates, key=lambda p: len(p.chunk.time)))
        if within.over:
            break
    return pieces, refused


class _Baseline:
    """Which windows belong to the baseline of an entry; `over` once one beyond it was seen."""

    def __init__(self, baseline: Mapping[str, Any], length: float) -> None:
        def seconds(key: str, default: float) -> float:
            value = baseline.get(key, default)
            return utc_seconds(value) if isinstance(value, str) else float(value)

        self._begin, self._end = seconds("from", -np.inf), seconds("until", np.inf)
        self._most = int(baseline["windows"]) if "windows" in baseline else None
        self._length = length
        self._seen: set[int] = set()
        self.over = False

    def __call__(self, window: int) -> bool:
        if window * self._length < self._begin:
            return False
        if (window + 1) * self._length > self._end:
            self.over = True
            return False
        if self._most is not None and window not in self._seen and len(self._seen) >= self._most:
            self.over = True
            return False
        self._seen.add(window)
        return True


def _stretches(log: str, layout: Layout, length: float):
    """Yield the pieces of one log: uninterrupted, within one window, SHORTEST to LONGEST seconds long."""
    clock = Clock(length, log)
    for chunk in read_log(log, layout, ROWS):
        ordered = clock.order(chunk)
        time = ordered.chunk.time
        if not len(time):
            continue
        window = np.floor(time / length)
        cuts = np.flatnonzero((np.diff(ordered.stretch) != 0) | (np.diff(window) != 0)) + 1
        for a, b in zip([0, *cuts.tolist()], [*cuts.tolist(), len(time)], strict=True):
            stop = a + int(np.searchsorted(time[a:b] - time[a], LONGEST))
            piece = part_of(ordered, slice(a, stop))
            if time[max(stop - 1, a)] - time[a] >= SHORTEST and _complete(piece):
                yield Piece(log, replace(piece.chunk, position=unwrapped(piece.chunk.position)))


def _complete(piece: Ordered) -> bool:
    finite = np.isfinite(piece.chunk.position) & np.isfinite(piece.chunk.torque)
    return bool((~finite).mean(axis=0).max() <= MISSING)
