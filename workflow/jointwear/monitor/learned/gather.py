"""The stretches of motion in the baseline logs of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import tzinfo
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.clock import Clock, Ordered, part_of
from jointwear.measurement.formats import Chunk, Layout, read_log
from jointwear.measurement.timestamps import utc_seconds
from jointwear.measurement.turns import unwrapped
from jointwear.monitor.judging.baseline import asked_for, baseline_of
from jointwear.monitor.lengths_of_time import window_seconds
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.reading.misdated import misdated_words

#: Longest piece of one stretch that is taken [s], so that many hours fit, and shortest that shows anything.
LONGEST, SHORTEST = 20.0, 4.0
#: Share of the samples of a piece that may be missing.
MISSING = 0.02
#: Samples that are read at a time.
ROWS = 50_000
#: Samples that tell when a log begins.
FIRST_ROWS = 5_000


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

    As in the monitor, logs with dates count in order of time, and one that is
    :func:`~jointwear.monitor.reading.misdated.misdated` is refused: it would end the baseline, or begin it.

    Parameters
    ----------
    logs : of the robot, in order. entry : its entry in the config, of which `window`, `baseline` and `time_zone` count.
    """
    length = window_seconds(entry.get("window", "1h"))
    within = _Baseline(baseline_of(entry), length)
    pieces: list[Piece] = []
    logs, refused = _in_time(logs, layout, length, zone_of(entry.get("time_zone")))
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


def _in_time(logs: Sequence[str], layout: Layout, length: float, zone: tzinfo) -> tuple[list[str], list[str]]:
    """Return the logs in order of time, as they are given where one has no dates, and in words those that are misdated.

    Parameters
    ----------
    logs : in order of their names. length : of a window [s]. zone : of the days in the names.
    """
    firsts = [_first(log, layout, length) for log in logs]
    if not all(dated for _, dated in firsts):
        return list(logs), []
    first = np.array([time for time, _ in firsts])
    words = misdated_words(first, logs, zone)
    left = [k for k in range(len(logs)) if k not in words]
    # A log of which nothing can be read stands behind the one before it by name.
    place = np.fmax.accumulate([-np.inf, *first[left]])[1:]
    place = np.where(np.isfinite(first[left]), first[left], place)
    return [logs[left[k]] for k in np.argsort(place, kind="stable")], list(words.values())


def _first(log: str, layout: Layout, length: float) -> tuple[float, bool]:
    """Return the time of the first sample of a log [s], NaN where it cannot be read, and whether it may have dates."""
    clock = Clock(length, log)
    try:
        for chunk in read_log(log, layout, FIRST_ROWS):
            time = clock.order(chunk).chunk.time
            if len(time):
                return float(time[0]), chunk.dated
    except InputError:
        pass  # Told where its motion is read.
    return float("nan"), True


class _Baseline:
    """Which windows belong to the baseline of an entry; `over` once one beyond it was seen."""

    def __init__(self, baseline: Mapping[str, Any], length: float) -> None:
        def seconds(key: str) -> float | None:
            value = baseline.get(key)
            return None if value is None else utc_seconds(value) if isinstance(value, str) else float(value)

        self._given = seconds("from"), seconds("until"), int(baseline.get("windows", 0))
        self._length = length
        self._seen: list[int] = []
        self._own: set[int] = set()
        self.over = False

    def __call__(self, window: int) -> bool:
        if window not in self._seen:
            self._seen = sorted([*self._seen, window])
            start = self._length * np.array(self._seen, dtype=float)
            begin, until, windows = self._given
            own = asked_for(start, start + self._length, begin, until, windows)
            self._own = set(np.array(self._seen)[own].tolist())
            self.over = bool(np.any(~own & (start >= (-np.inf if begin is None else begin))))
        return window in self._own


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
