"""Order in time: what becomes of repeated, late, missing and restarted stamps. The rules, stated once:

- a stamp that is not finite, repeats the one before, or arrives late (at most :data:`.LATE` samples in a row earlier
  than one already seen) is left out and the window flagged;
- so is one that is astray: at most :data:`.LATE` samples in a row ahead of all that follow, which go on where the log
  was before; or first or last ones that lie far from all others, further than :data:`.FAR` and :data:`.FAR_TIMES` the
  log, as of a clock that was not set yet. Of a log that comes in chunks each end of one is looked at;
- time that goes back for longer is a clock that was set back. With a date the new stamps are believed; without one
  the log goes on where it was. Either way a new stretch begins and the window is flagged;
- a step longer than :data:`GAP` times the usual one is a gap: a new stretch, flagged where it lies within a window;
- a change of the trajectory label is a new stretch; without a date it also begins a new window, so that no window
  mixes two trajectories.

A stretch is uninterrupted: filters and differences never reach across its ends.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from jointwear.files.errors import InputError
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats.chunk import Chunk, joined, rows_of
from jointwear.measurement.late_samples import LATE, ahead_of, first_long_run, lone_end, lone_start

GAP = 5.0
#: Rows of the chunk before among which a row that stands in the log already is looked for.
REMEMBERED = 2000
#: Restarts in one chunk that are too many for a clock.
MOST_RESTARTS = 50
#: Largest time [s] that is believed, some 3000 years.
LONGEST = 1e11
#: Shortest usual step [s] that is believed.
SHORTEST_STEP = 1e-5


@dataclass(frozen=True)
class Ordered:
    """A chunk in order: `stretch` (m,) labels rise through the log, `flags` (m,) bit fields."""

    chunk: Chunk
    stretch: np.ndarray
    flags: np.ndarray


class Clock:
    """Puts the chunks of one log in order, one after the other.

    Parameters
    ----------
    length : of a window [s], to which trajectories without a date are aligned.
    name : of the log, for messages.
    """

    def __init__(self, length: float, name: str = "log") -> None:
        self._length, self._name = length, name
        self._stretch = 0
        self._last: float | None = None
        self._first: float | None = None
        self._label: int | None = None
        self._shift = 0.0
        self._step = np.nan
        self._untold = 0
        self._tail: np.ndarray | None = None

    def order(self, chunk: Chunk) -> Ordered:
        """Return the next chunk with its time in order.

        Raises
        ------
        InputError : if the stamps are no time: all not finite, absurdly large, or falling back all the time.
        """
        raw = np.asarray(chunk.time, dtype=float)
        finite = np.isfinite(raw)
        if np.any(np.abs(raw[finite]) > LONGEST):
            raise InputError(f"{self._name}: the time reaches {np.abs(raw[finite]).max():.4g} s; state its unit")
        if len(raw) > 1 and finite.sum() < 0.5 * len(raw):
            raise InputError(f"{self._name}: {100 * (1 - finite.mean()):.0f} % of the time stamps are not finite")
        steps = np.diff(raw[finite])
        if np.any(steps > 0):
            self._step = float(np.median(steps[steps > 0]))
            if self._step < SHORTEST_STEP:
                raise InputError(f"{self._name}: the samples lie {self._step:.3g} s apart; state the unit of the time")
        label = chunk.trajectory
        cuts = [0, len(raw)] if label is None else [0, *(np.flatnonzero(np.diff(label)) + 1), len(raw)]
        time, keep = raw.copy(), finite.copy()
        flags = np.where(finite, 0, int(Flag.NOT_FINITE))
        again = self._seen_before(chunk) & finite
        keep &= ~again
        flags[again] |= int(Flag.DUPLICATE_STAMPS)
        stretch = np.zeros(len(raw), dtype=np.int64)
        self._restarts = 0
        for a, b in itertools.pairwise(cuts):
            if label is not None and label[a] != self._label:
                self._begin(float(raw[a]) if finite[a] else np.nan, int(label[a]), chunk.dated)
            self._order_part(time, keep, flags, stretch, slice(a, b), chunk.dated)
        # What was left out is told by its neighbour that stays.
        left_out = np.flatnonzero(~keep & (flags != 0))
        staying = np.flatnonzero(keep)
        if len(staying):
            place = np.minimum(np.searchsorted(staying, left_out), len(staying) - 1)
            np.bitwise_or.at(flags, staying[place], flags[left_out])
            flags[staying[0]] |= self._untold
            self._untold = 0
        elif len(left_out):
            self._untold |= int(np.bitwise_or.reduce(flags[left_out]))
        return part_of(Ordered(replace(chunk, time=time), stretch, flags), keep)

    def _seen_before(self, chunk: Chunk) -> np.ndarray:
        """Return which rows (m,) of a chunk stand in the log already, stamp, positions and torques alike.

        Where a clock is set back stamps come again with other values.
        """
        label = np.zeros(len(chunk.time)) if chunk.trajectory is None else chunk.trajectory
        rows = np.column_stack([chunk.time, label, chunk.position, chunk.torque])
        known = 0 if self._tail is None or self._tail.shape[1] != rows.shape[1] else len(self._tail)
        every = np.concatenate([self._tail, rows]) if known else rows
        self._tail = rows[-REMEMBERED:]
        same = np.zeros(len(every), dtype=bool)
        if np.all(np.diff(every[:, 0]) > 0):
            return same[known:]
        order = np.argsort(every[:, 0], kind="stable")
        begins = np.concatenate([[True], np.diff(every[order, 0]) != 0])
        first = np.empty(len(every), dtype=np.int64)
        first[order] = order[begins][np.cumsum(begins) - 1]
        later = np.flatnonzero(first < np.arange(len(every)))
        one, other = every[later], every[first[later]]
        same[later] = np.all((one == other) | (np.isnan(one) & np.isnan(other)), axis=1)
        return same[known:]

    def _begin(self, first: float, label: int, dated: bool) -> None:
        """Begin a trajectory."""
        if self._last is not None:
            self._stretch += 1
            if not dated and np.isfinite(first):
                border = self._length * (np.floor(self._last / self._length) + 1)
                self._shift = border - first
                self._last = self._first = None
        self._label = label

    def _order_part(
        self,
        time: np.ndarray,
        keep: np.ndarray,
        flags: np.ndarray,
        stretch: np.ndarray,
        part: slice,
        dated: bool,
    ) -> None:
        """Order the samples of one trajectory within a chunk, in place."""
        index = np.flatnonzero(keep[part]) + part.start
        restarted = False
        while len(index):
            values = time[index] + self._shift
            before = -np.inf if self._last is None else self._last
            highest = np.maximum.accumulate(np.concatenate([[before], values]))[:-1]
            late = values < highest
            back = first_long_run(late)
            # Where the clock was put on by the first stamp of what follows, that one has to stay.
            base = np.inf if self._last is None and (restarted or self._shift) else before
            astray = 0 if back is None else ahead_of(values, back, base)
            if back is not None and astray:
                index = self._without(index, np.arange(back - astray, back), keep, flags)
                self._count_restart()
                continue
            if restarted:
                # The sample at which the clock was found set back opens a stretch of its own.
                flags[index[0]] |= int(Flag.CLOCK_RESET)
            now = slice(0, len(index) if back is None else back)
            wrong = late[now] | (values[now] == highest[now])
            flags[index[now][wrong]] |= int(Flag.DUPLICATE_STAMPS)
            keep[index[now][wrong]] = False
            good, kept = index[now][~wrong], values[now][~wrong]
            lone = self._lone(kept, restarted)
            good, kept = self._without(good, lone, keep, flags), np.delete(kept, lone)
            if len(good):
                self._first = float(kept[0]) if self._first is None else self._first
                stamps = np.concatenate([[before], kept])
                gaps = np.diff(stamps)
                is_gap = np.isfinite(gaps) & (gaps > GAP * self._step)
                # Between two windows a gap is no loss: many logs hold a part of every hour.
                inside = np.diff(np.floor(stamps / self._length)) == 0
                flags[good[is_gap & inside]] |= int(Flag.GAP)
                stretch[good] = self._stretch + np.cumsum(is_gap)
                self._stretch = int(stretch[good[-1]])
                time[good] = kept
                self._last = float(kept[-1])
            if back is None:
                return
            self._count_restart()
            index = index[back:]
            self._stretch += 1
            if not dated:
                step = self._step if np.isfinite(self._step) else 1.0
                self._shift += (self._last or 0.0) + step - float(time[index[0]] + self._shift)
            self._last = self._first = None
            restarted = True

    def _count_restart(self) -> None:
        """Count what looks like a clock that was set back.

        Raises
        ------
        InputError : if there are too many in one chunk.
        """
        self._restarts += 1
        if self._restarts > MOST_RESTARTS:
            raise InputError(
                f"{self._name}: the time runs backwards again and again; it is not the time of the samples"
            )

    def _without(self, index: np.ndarray, astray: np.ndarray, keep: np.ndarray, flags: np.ndarray) -> np.ndarray:
        """Return samples `index` without those at places `astray`, as `keep` and `flags` (m,) are made to tell."""
        keep[index[astray]] = False
        flags[index[astray]] |= int(Flag.DUPLICATE_STAMPS)
        return np.delete(index, astray)

    def _lone(self, kept: np.ndarray, restarted: bool) -> np.ndarray:
        """Return which places of rising stamps `kept` (k,) [s], what a chunk goes on with, are far from all others."""
        last = self._last
        begins = lone_start(kept) if last is None and not restarted else 0
        known = kept[begins:] if last is None else np.concatenate([[last], kept])
        # A few stamps alone do not tell which of them are astray.
        enough = last is not None or len(known) > 2 * LATE
        ends = lone_end(known, known[0] if self._first is None else self._first) if enough else 0
        return np.r_[:begins, len(kept) - ends : len(kept)]


def join(parts: list[Ordered]) -> Ordered:
    """Return parts of one log that follow each other as one; a bag may carry velocity in some of them only."""
    if len(parts) == 1:
        return parts[0]
    chunk = joined([p.chunk for p in parts], fill=True)
    return Ordered(chunk, np.concatenate([p.stretch for p in parts]), np.concatenate([p.flags for p in parts]))


def part_of(ordered: Ordered, chosen: slice | np.ndarray) -> Ordered:
    """Return some of the samples (m,); `chosen`, a slice, an index or a mask."""
    return Ordered(rows_of(ordered.chunk, chosen), ordered.stretch[chosen], ordered.flags[chosen])
