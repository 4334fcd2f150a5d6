"""Statistics of many logs as one history."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from datetime import datetime, tzinfo

import numpy as np

from jointwear.monitor.local_time import repeats_after, zone_of
from jointwear.monitor.reading.loads_of_windows import LoadsOfWindows, no_loads
from jointwear.monitor.reading.misdated import misdated_words, wrong_of_overlapping
from jointwear.monitor.reading.program_labels import window_programs
from jointwear.monitor.reading.replayed import replayed, replayed_words
from jointwear.monitor.reading.windows import WindowStatistics, merge

#: Time [s] by which logs that follow each other may overlap: samples that a logger writes to both.
TOUCHING = 1.0
#: When summer time ends, north and south of the equator: a Sunday of these months, before this hour of the day.
SUNDAY, TURNS, EARLY, HOUR = 6, (3, 4, 9, 10, 11), 4, 3600.0


@dataclass(frozen=True)
class Piece:
    """Statistics of one log: time of its first and last sample [s] (NaN if none), and what was refused, in words.

    `loads`: that its windows show. `copy_of`: the log before it that holds the same samples, empty if none does; a copy
    has no windows. `gone`: the log is no longer there, only its statistics are. `cut`: it ends within a row.
    """

    log: str
    statistics: WindowStatistics
    first: float
    last: float
    refused: tuple[str, ...] = ()
    copy_of: str = ""
    gone: bool = False
    cut: bool = False
    loads: LoadsOfWindows = field(default_factory=no_loads)


@dataclass(frozen=True)
class History:
    """All windows in order of time, and the pieces they come from; `shifted`: logs were laid end to end."""

    statistics: WindowStatistics
    pieces: tuple[Piece, ...]
    shifted: bool = False


def assemble(pieces: Sequence[Piece], time_zone: str | None = None) -> History:
    """Put the statistics of logs, in their order, together; `time_zone` of stamps that name none, default UTC.

    Logs with dates go where their dates say. Logs without go on by their own clock; where one begins before the one
    before it ends, its clock was started anew, and it is moved on by whole windows to follow it. A log that holds the
    same samples as a dated one before it, under another name or in another format, counts once. One that holds the
    torques of another one under other times is refused (:func:`.replayed`). One with dates that holds samples between
    those of another is refused, as one arm moves in one way at a time: the later one, or the one that is gone, or that
    whose dates are wrong where :func:`.wrong_of_overlapping` tells. So is one that is :func:`.misdated`: as the newest
    one of all it would stand for the state of now. Where summer time ends an hour of `time_zone` comes twice: a log of
    it that holds samples between those of one before it is of the second time.
    """
    zone = zone_of(time_zone)
    pieces = _with_second_hours(pieces, zone)
    placed, end, last, shifted = [], -np.inf, -np.inf, False
    seen: dict[tuple, str] = {}
    keys = [fingerprint(piece) for piece in pieces]
    among = _overlaps(pieces, keys)
    astray = _misdated(pieces, keys, zone) | _wrong_of_two(pieces, keys, among, zone)
    wrong = {keys[k]: pieces[k].log for k in astray}
    astray |= {
        k: f"{piece.log}: holds the samples of {wrong[key]}, whose dates are wrong; leave it out"
        for k, (piece, key) in enumerate(zip(pieces, keys, strict=True))
        if key in wrong and k not in astray
    }
    astray |= _replays(pieces, keys, astray.keys())
    if not astray.keys().isdisjoint({*among, *among.values()}):
        among = _overlaps(pieces, [None if k in astray else key for k, key in enumerate(keys)])
    for number, (given, key) in enumerate(zip(pieces, keys, strict=True)):
        piece, statistics = given, given.statistics
        if key in seen:
            # What was refused in it was refused in the log that it is a copy of, and is told there.
            placed.append(replace(piece, statistics=statistics.part(slice(0, 0)), refused=(), copy_of=seen[key]))
            continue
        words = astray.get(number, "")
        if number in among:
            words = _overlap_words(piece, pieces[among[number]], zone)
        if words:
            placed.append(replace(piece, statistics=statistics.part(slice(0, 0)), refused=(*piece.refused, words)))
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


def _replays(pieces: Sequence[Piece], keys: Sequence[tuple | None], apart: Set[int]) -> dict[int, str]:
    """Return in words, by its place among `pieces`, which log every log replays that does; those `apart` take no
    part."""
    first = [p.first for p in pieces]
    found = replayed([p.statistics for p in pieces], first, keys, apart)
    return {k: replayed_words(pieces[k].log, pieces[other].log, first[k] - first[other]) for k, other in found.items()}


def _overlap_words(piece: Piece, other: Piece, zone: tzinfo) -> str:
    """Return in words that the samples of a log lie between those of another, and what may be the cause."""
    begin = datetime.fromtimestamp(piece.first, tz=zone)
    apart = abs(piece.first - other.first)
    if repeats_after(piece.first, zone):
        cause = (
            "they are of the hour that comes twice where summer time ends, and nothing tells which is the first time. "
            "Let the logger write the offset from UTC (02:30:00+01:00)"
        )
    elif begin.weekday() == SUNDAY and begin.month in TURNS and begin.hour < EARLY and apart < HOUR:
        cause = (
            "is it the hour that comes twice where summer time ends? State the zone of the stamps as 'time_zone' in "
            "the entry of the robot, or let the logger write the offset from UTC"
        )
    else:
        cause = (
            "is one of them dated a day or some hours off, of another robot, or a second export? Mend the dates of the "
            "wrong one or leave it out: this one is left out until then"
        )
    return f"{piece.log}: its samples lie between those of {other.log}, which one arm cannot do; {cause}"


def _with_second_hours(pieces: Sequence[Piece], zone: tzinfo) -> list[Piece]:
    """Return the pieces, those moved on that are of the second time of an hour which comes twice.

    Such a log holds samples between those of one before it, both in that hour, and nothing else is where it belongs.
    Stamps that name their zone, in which two logs of one time are two logs of one time, come with logs of that hour.
    """
    result = list(pieces)
    for k, piece in enumerate(pieces):
        again = repeats_after(piece.first, zone) if piece.statistics.dated and piece.statistics.windows else 0.0
        if not again or again % piece.statistics.length:
            continue
        earlier = [p for p in result[:k] if repeats_after(p.first, zone) and _meet(p, piece)]
        if not earlier or fingerprint(piece) in {fingerprint(p) for p in earlier}:
            continue
        s = piece.statistics
        # A window of the hour has its ends in it; all others are where their stamps say.
        ends = zip(s.start, s.end - TOUCHING, strict=True)
        on = np.array([min(repeats_after(float(a), zone), repeats_after(float(b), zone)) for a, b in ends])
        statistics = replace(s, start=s.start + on, end=s.end + on)
        last = piece.last + repeats_after(piece.last, zone)
        moved = replace(piece, statistics=statistics, first=piece.first + again, last=last)
        if not any(_meet(p, moved) for i, p in enumerate(result) if i != k):
            result[k] = moved
    return result


def _wrong_of_two(
    pieces: Sequence[Piece], keys: Sequence[tuple | None], among: Mapping[int, int], zone: tzinfo
) -> dict[int, str]:
    """Return in words, by its place among `pieces`, what is wrong with the dates of logs that lie between others.

    `among` : what :func:`_overlaps` returns. Logs that are gone are not weighed against others.
    """
    there = {k: other for k, other in among.items() if not (pieces[k].gone or pieces[other].gone)}
    if not there:
        return {}
    known: set[tuple] = set()
    first, last = np.full(len(pieces), np.nan), np.full(len(pieces), np.nan)
    for k, (piece, key) in enumerate(zip(pieces, keys, strict=True)):
        if key is not None and key not in known:
            known.add(key)
            first[k], last[k] = piece.first, piece.last
    found = wrong_of_overlapping([p.log for p in pieces], first, last, there, zone)
    return {
        k: (
            f"{pieces[k].log}: its samples lie between those of {pieces[other].log}, which one arm cannot do, and "
            f"{why}: its dates are wrong; was the clock? Mend them or leave it out"
        )
        for k, (other, why) in found.items()
    }


def _overlaps(pieces: Sequence[Piece], keys: Sequence[tuple | None]) -> dict[int, int]:
    """Return, by its place among `pieces`, every log with samples between those of another, with the other's place.

    Copies, which have the same of the `keys`, are none of them, nor logs that show no friction.
    """
    first, last = (np.array([getattr(p, name) for p in pieces]) for name in ("first", "last"))
    taken = np.zeros(len(pieces), dtype=bool)
    known: set[tuple] = set()
    found: dict[int, int] = {}
    for k in sorted(range(len(pieces)), key=lambda k: pieces[k].gone):
        key = keys[k]
        if key is None or key in known:
            continue
        near = np.flatnonzero(taken & (first < last[k] - TOUCHING) & (last > first[k] + TOUCHING))
        other = next((int(i) for i in near if _one_arm_cannot(pieces[i], pieces[k])), None)
        if other is not None:
            found[k] = other
            continue
        known.add(key)
        taken[k] = True
    return found


def _misdated(pieces: Sequence[Piece], keys: Sequence[tuple | None], zone: tzinfo) -> dict[int, str]:
    """Return in words, by its place among `pieces`, what is wrong with the dates of every log that is misdated."""
    first = np.full(len(pieces), np.nan)
    known: set[tuple] = set()
    for k, (piece, key) in enumerate(zip(pieces, keys, strict=True)):
        if key is not None and key not in known:
            known.add(key)
            first[k] = piece.first
    return misdated_words(first, [p.log for p in pieces], zone)


def _meet(one: Piece, other: Piece) -> bool:
    """Return whether two logs overlap by more than :data:`TOUCHING`, each with samples in the time of the other."""
    apart = one.first >= other.last - TOUCHING or one.last <= other.first + TOUCHING
    return not apart and _one_arm_cannot(one, other)


def _one_arm_cannot(one: Piece, other: Piece) -> bool:
    """Return whether each of two logs has samples in the time of the other; different programs may take turns."""
    programs = [set(window_programs(p.statistics.labels)) - {""} for p in (one, other)]
    if all(programs) and not programs[0] & programs[1]:
        return False
    return _within(one, other) and _within(other, one)


def _within(one: Piece, other: Piece) -> bool:
    """Return whether a log surely has samples between the first and the last of another."""
    s, begin, end = one.statistics, other.first, other.last
    if begin <= one.first <= end or begin <= one.last <= end:
        return True
    return bool(np.any((s.samples > 0) & (s.start >= begin) & (s.end <= end)))


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
