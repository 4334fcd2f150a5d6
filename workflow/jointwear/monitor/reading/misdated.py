"""Logs whose dates cannot be right: by where they stand by name, or by what their names say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import date, datetime, tzinfo

import numpy as np

from jointwear.monitor.days_in_names import days_of

#: Pause [s] without a log, a quarter of a year, beyond which dates are another clock's.
PAUSE = 90 * 86400.0
#: Fewest logs in order of time by name that say that names follow time: by chance one order in 120 does.
FEWEST_LOGS = 5
#: Fewest that do where each begins on the day that its name holds: one before and one after.
FEWEST_NAMED = 2
#: A day, and what times differ by in writing alone [s].
DAY, ROUND_OFF = 86400.0, 1e-3


def misdated(first: np.ndarray, logs: Sequence[str], zone: tzinfo) -> dict[int, tuple[int, int]]:
    """Return every log that is dated :data:`PAUSE` and more off while the logs before and after it by name are not,
    with the nearest ones of these.

    Names tell only where all other logs, more than half and at least :data:`FEWEST_LOGS`, follow each other in time as
    they do by name; two are enough where all begin on the days that their names hold, or as many days off them, and the
    one that is off does not. A clock that is wrong from some log on is none of this: nobody knows which of the two
    dates is right.

    Parameters
    ----------
    first : (p,) times of the first samples [s] in order of the names; NaN of logs that take no part.
    logs : (p,) names. zone : of the days in the names.
    """
    order = np.argsort(first, kind="stable")[: int(np.isfinite(first).sum())]
    groups = np.split(order, np.flatnonzero(np.diff(first[order]) > PAUSE) + 1)
    others = np.sort(max(groups, key=len))
    if len(others) < FEWEST_NAMED or 2 * len(others) <= len(order) or np.any(np.diff(first[others]) < 0):
        return {}
    astray = np.setdiff1d(order, others).tolist()
    if len(others) < FEWEST_LOGS:
        off = np.array([_days_off(day, time, zone) for day, time in zip(days_of(logs), first, strict=True)])
        usual = off[others]
        if not np.ptp(usual) <= 1:
            return {}
        astray = [k for k in astray if off[k] < usual.min() or off[k] > usual.max()]
    found = {}
    for k in astray:
        next_one = int(np.searchsorted(others, k))
        if 0 < next_one < len(others):
            found[k] = (int(others[next_one - 1]), int(others[next_one]))
    return found


def misdated_words(first: np.ndarray, logs: Sequence[str], zone: tzinfo) -> dict[int, str]:
    """Return in words what is wrong with the dates of every log that is :func:`misdated`, of which parameters are."""
    found = {}
    for k, (before, after) in misdated(first, logs, zone).items():
        days = min((first[k] - first[before], first[k] - first[after]), key=abs) / DAY
        found[k] = (
            f"{logs[k]}: its dates lie {abs(days):.0f} days {'after' if days > 0 else 'before'} those of "
            f"{logs[before]} and {logs[after]}, between which it stands by name; was the clock wrong? Mend "
            "its dates or leave it out"
        )
    return found


def wrong_of_overlapping(
    logs: Sequence[str], first: np.ndarray, last: np.ndarray, overlapping: Mapping[int, int], zone: tzinfo
) -> dict[int, tuple[int, str]]:
    """Return of logs whose samples lie between those of others, where it can be told, those whose dates are wrong, each
    with the other one and what tells it.

    By dates in the names: all other logs that have one, at least :data:`FEWEST_LOGS`, begin on that day, or as many
    days off it, and one of the two does not. By order: all other logs follow each other in time as they do by name, and
    one of the two can be moved to where it stands by name while there is no room for the other one; where there is for
    both, by whole days, as a wrong date keeps the time of day.

    Parameters
    ----------
    logs : (p,) names in their order. first, last : (p,) times of the first and last samples [s], NaN of logs that take
        no part. overlapping : place of a log -> that of one before it. zone : of the days in the names.
    """
    doubtful = {*overlapping, *overlapping.values()}
    sound = [k for k in np.flatnonzero(np.isfinite(first)).tolist() if k not in doubtful]
    if len(sound) < FEWEST_LOGS:
        return {}
    off = np.array([_days_off(day, time, zone) for day, time in zip(days_of(logs), first, strict=True)])
    usual = off[sound][np.isfinite(off[sound])]
    found: dict[int, tuple[int, str]] = {}
    if len(usual) >= FEWEST_LOGS:
        for pair in overlapping.items():
            wrong = [k for k in pair if not usual.min() <= off[k] <= usual.max()]
            if len(wrong) == 1 and np.isfinite(off[list(pair)]).all():
                found[wrong[0]] = (next(k for k in pair if k != wrong[0]), "its name says another day")
    left = {k: other for k, other in overlapping.items() if not {k, other} & set(found)}
    if left and np.all(np.diff(first[sound]) >= 0):
        early, late = sorted(set(left.values())), sorted(left)
        wrong = _out_of_place(first, last, sound, early, late)
        told = "it belongs elsewhere by the order of the names"
        for k, other in left.items():
            if wrong:
                found |= {k: (other, told)} if wrong is late else {other: (k, told)}
    return found


def _days_off(named: date | None, first: float, zone: tzinfo) -> float:
    """Return by how many days a log begins after the day that its name holds, NaN where it holds none."""
    if named is None or not np.isfinite(first):
        return np.nan
    try:
        return float((datetime.fromtimestamp(first, tz=zone).date() - named).days)
    except (ValueError, OverflowError, OSError):
        return np.nan


def _out_of_place(
    first: np.ndarray, last: np.ndarray, sound: Sequence[int], early: list[int], late: list[int]
) -> list[int] | None:
    """Return which of two runs of logs, `early` or `late` by name, has wrong dates, None where nothing tells.

    Parameters are those of :func:`wrong_of_overlapping`; `sound` are the places of the logs that are in order.
    """
    taking = np.flatnonzero(np.isfinite(first))
    whole = [np.array_equal(taking[(taking >= run[0]) & (taking <= run[-1])], run) for run in (early, late)]
    if not all(whole) or early[-1] >= late[0]:
        return None

    def between(run: list[int], other: list[int] | None) -> tuple[float, float]:
        """Return the end of the log before a run and the begin of the one after it by name, without the other run."""
        known = [*sound, *(other or ())]
        before, after = [k for k in known if k < run[0]], [k for k in known if k > run[-1]]
        return max((last[k] for k in before), default=-np.inf), min((first[k] for k in after), default=np.inf)

    def moved(run: list[int], low: float, high: float, step: float) -> bool:
        """Return whether a run lies between `low` and `high` once it is moved by a multiple of `step` [s], or any."""
        begin, end = first[run].min(), last[run].max()
        if end - begin > high - low + ROUND_OFF:
            return False
        # A run that may go on for ever, at either end of all logs, has room.
        if not step or not np.isfinite(high - low):
            return True
        return bool(begin + step * np.ceil((low - begin - ROUND_OFF) / step) + end - begin <= high + ROUND_OFF)

    def stands(run: list[int]) -> bool:
        low, high = between(run, None)
        return bool(low <= first[run].min() + ROUND_OFF and last[run].max() <= high + ROUND_OFF)

    ordered = stands(early), stands(late)
    if ordered[0] != ordered[1]:
        return late if ordered[0] else early
    for step in (0.0, DAY):
        room = moved(early, *between(early, late), step), moved(late, *between(late, early), step)
        if room[0] != room[1]:
            return early if room[0] else late
    return None
