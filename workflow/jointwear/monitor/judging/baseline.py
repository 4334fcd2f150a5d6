"""Which windows show the robot healthy: chosen once, then fixed in calendar time and kept.

`from`, `until` and `windows` of the config are turned into an interval once there are enough windows. Interval and
statistics are kept beside the state, so that neither logs that are deleted after a while nor logs that arrive late
move what counts as normal; a change of these keys chooses anew, of the kept windows too. Where the interval holds too
little, it goes on until it holds enough, and says so.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.json_documents import parse_json
from jointwear.files.storage import open_dataset
from jointwear.files.wording import count
from jointwear.measurement.timestamps import moment_of, utc_seconds
from jointwear.monitor.findings.findings import moment_words
from jointwear.monitor.local_time import zone_of
from jointwear.monitor.normal.learning import FEWEST_WINDOWS
from jointwear.monitor.normal.shifts import FEWEST_SHIFTS, shift_labels
from jointwear.monitor.reading.window_files import read_statistics, write_statistics
from jointwear.monitor.reading.windows import WindowStatistics, merge

#: Kind of the finding on a baseline that the config puts before all logs.
ELSEWHERE = "baseline_elsewhere"
#: What ends that nothing is judged because of a `key` of the baseline.
_ADVICE = "Set 'baseline.{key}' to a time between the first window and the newest"


@dataclass(frozen=True)
class Baseline:
    """`mask` (w,) of the windows; `complete`: nothing more is learnt; `words`: what a user must know, or empty;
    `advice`: what ends that nothing is judged, where it is not logs that have to come."""

    mask: np.ndarray
    complete: bool
    words: str = ""
    advice: str = ""


def border(statistics: WindowStatistics, baseline: Mapping[str, Any], key: str) -> float | None:
    """Return `from` or `until` of the config in seconds of the windows, None where it is not given.

    Raises
    ------
    InputError : where a date is given for logs that have none, or seconds for logs that have one.
    """
    value = baseline.get(key)
    if not isinstance(value, str):
        if value is not None and key == "until" and statistics.dated and float(value) <= statistics.start[0]:
            newest = moment_words(statistics, float(statistics.end[-1]))
            raise InputError(
                f"config: 'baseline.until' is {value:g}, which is no date, but the logs have dates; give one, as "
                f"{newest} for all that there is, or a number of windows, as 'windows: {max(1, round(float(value)))}'"
            )
        return None if value is None else float(value)
    if not statistics.dated:
        raise InputError(
            f"config: 'baseline.{key}' is {value}, but the logs have no dates; give seconds of the log's clock, "
            "or 'windows'"
        )
    return utc_seconds(value)


def baseline_of(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return `baseline` of an entry of ``monitor.robots``; `from` and `until` without a zone get its `time_zone`."""
    zone = zone_of(entry.get("time_zone"))
    dates = {k: v for k, v in entry["baseline"].items() if k in ("from", "until") and isinstance(v, str)}
    moments = {k: datetime.fromtimestamp(utc_seconds(v, zone), tz=UTC).isoformat() for k, v in dates.items()}
    return {**entry["baseline"], **moments}


def asked_for(start: np.ndarray, end: np.ndarray, begin: float | None, until: float | None, windows: int) -> np.ndarray:
    """Return the windows (w,) bool that `from`, `until` and `windows` of a baseline ask for, however few they are.

    Parameters
    ----------
    start, end : (w,) [s] borders of the windows in order of time. begin, until : [s], None where it is not given.
    windows : how many at most, 0 where that is not given.
    """
    mask = np.ones(len(start), dtype=bool) if begin is None else start >= begin
    if until is not None:
        mask &= end <= until
    return mask & (np.cumsum(mask) <= windows) if until is None or windows else mask


def choose_baseline(statistics: WindowStatistics, given: Mapping[str, Any]) -> Baseline:
    """Return the baseline that the config asks for, longer where it holds too little.

    Parameters
    ----------
    statistics : all windows. given : `from`, `until`, `windows` of the config.
    """
    begin, until = border(statistics, given, "from"), border(statistics, given, "until")
    after = np.ones(statistics.windows, dtype=bool) if begin is None else statistics.start >= begin
    if begin is not None and begin >= statistics.end[-1]:
        nothing = np.zeros(statistics.windows, dtype=bool)
        return Baseline(nothing, False, _yet_to_begin(statistics, begin), _ADVICE.format(key="from"))
    asked = int(given.get("windows", 0))
    mask = asked_for(statistics.start, statistics.end, begin, until, asked)
    if until is None and mask.sum() < asked:
        more = asked - int(mask.sum())
        words = (
            f"The baseline asks for {count(asked, 'window')}, the logs fill {int(mask.sum())}: nothing is judged until "
            f"{more} more {'has' if more == 1 else 'have'} come."
        )
        return Baseline(mask, False, words)
    if _enough(statistics, mask):
        # As long as no window has come from after its end, more of the time that was asked for may come.
        over = until is None or bool(np.any(statistics.end > until)) or 0 < asked <= mask.sum()
        if over:
            return Baseline(mask, True)
        return Baseline(mask, False, _still_learning(statistics, until), _ADVICE.format(key="until"))
    longer = mask.copy()
    for k in np.flatnonzero(after & ~mask):
        longer[k] = True
        if _enough(statistics, longer):
            words = (
                f"The baseline holds {_held_words(statistics, mask)}, "
                "too few to know what is normal; it goes on until "
                f"{moment_words(statistics, float(statistics.end[k]))}. Until then nothing is judged."
            )
            if until is not None and until <= statistics.start[0]:
                words += (
                    f" 'until' ({moment_words(statistics, until)}) lies before the first log: is its year right? Give "
                    "a time at which the robot was healthy."
                )
            return Baseline(longer, True, words)
    words = (
        f"The baseline holds {_held_words(statistics, longer)}; "
        f"{FEWEST_WINDOWS} windows with motion in {FEWEST_SHIFTS} shifts are needed to know what is normal. "
        "Nothing is judged until they have come."
    )
    return Baseline(longer, False, words)


def learnt_elsewhere(statistics: WindowStatistics, baseline: Baseline, given: Mapping[str, Any]) -> bool:
    """Return whether a baseline was learnt of windows that all come after the end which the config gives it: mostly a
    year that was mistyped. Parameters are those of :func:`choose_baseline`, and what it returned."""
    rows, until = np.flatnonzero(baseline.mask), border(statistics, given, "until")
    return bool(len(rows)) and baseline.complete and until is not None and until <= float(statistics.start[rows[0]])


def _yet_to_begin(statistics: WindowStatistics, begin: float) -> str:
    """Return in words that the baseline begins, at `begin` [s], after the newest window."""
    first, newest = (moment_words(statistics, float(t)) for t in (statistics.start[0], statistics.end[-1]))
    return (
        f"'from' of the baseline ({moment_words(statistics, begin)}) is later than the newest log ({newest}): no "
        f"window belongs to the baseline, and nothing is judged. Give a time from {first} to {newest}, or leave 'from' "
        "out."
    )


def _still_learning(statistics: WindowStatistics, until: float) -> str:
    """Return in words that the newest window ends before the baseline does, at `until` [s]."""
    return (
        f"The baseline ends at {moment_words(statistics, until)}, not before the newest window does, at "
        f"{moment_words(statistics, float(statistics.end[-1]))}: all that has come belongs to it, and nothing is "
        "judged until a window has come from after its end."
    )


def _enough(statistics: WindowStatistics, mask: np.ndarray) -> bool:
    """Return whether windows and shifts of the most often moving axis suffice."""
    seen = _with_motion(statistics, mask)
    return bool(seen.sum() >= FEWEST_WINDOWS) and _shifts(statistics, mask, seen) >= FEWEST_SHIFTS


def _with_motion(statistics: WindowStatistics, mask: np.ndarray) -> np.ndarray:
    """Return the windows (w,) of a mask (w,) in which some axis moves."""
    return mask & (statistics.count.max(axis=1) > 0) if statistics.axes else mask


def _shifts(statistics: WindowStatistics, mask: np.ndarray, seen: np.ndarray | None = None) -> int:
    """Return how many shifts the windows `seen` (w,) of a baseline `mask` (w,) lie in; default all of it."""
    seen = mask if seen is None else seen
    return len(np.unique(shift_labels(statistics.start, statistics.end, mask)[seen])) if mask.any() else 0


def _held_words(statistics: WindowStatistics, mask: np.ndarray) -> str:
    """Return in words how many windows a baseline holds, and of them with motion where some are without."""
    held, moved, shifts = int(mask.sum()), int(_with_motion(statistics, mask).sum()), _shifts(statistics, mask)
    words = f"{count(held, 'window')} in {count(shifts, 'shift')}"
    return words if moved == held else f"{words}, {moved or 'none'} of them with motion"


def keep_baseline(statistics: WindowStatistics, baseline: Baseline, given: Mapping[str, Any], path: Path) -> None:
    """Keep a complete baseline of dated logs as a file."""
    if not (baseline.complete and statistics.dated) or path.exists():
        return
    rows = statistics.part(baseline.mask)
    more = {"given": _text(given), "interval": [float(rows.start[0]), float(rows.end[-1])]}
    write_statistics(rows, path, "windows of the baseline", dict(given), {**more, "words": baseline.words})


def with_kept_baseline(
    statistics: WindowStatistics, given: Mapping[str, Any], path: Path
) -> tuple[WindowStatistics, Baseline]:
    """Return all windows, those of the kept baseline that the logs no longer hold among them, and the baseline.

    Parameters
    ----------
    given : as of :func:`keep_baseline`; `made_with`, what the windows were made with, may be among its keys.

    Raises
    ------
    InputError : where logs of the kept baseline are gone and its windows do not compare with those of now.
    """
    kept = _kept(path) if statistics.dated and path.exists() else None
    if kept is None:
        path.unlink(missing_ok=True)
        return statistics, choose_baseline(statistics, given)
    gone = ~_covered(kept.rows, statistics)
    if not kept.compares(statistics, given):
        lost = int(np.sum(gone & (kept.rows.count.max(axis=1) > 0)))
        if lost:
            raise InputError(
                f"{path}: {count(lost, 'window')} of the baseline came of logs that are gone, read with another robot "
                "file, other keys that decide how logs are read, or another survey; put these logs back, undo the "
                "change, or move this file away to choose the baseline among the logs that are left"
            )
        path.unlink()
        return statistics, choose_baseline(statistics, given)
    rows = kept.rows
    whole = merge([rows.part(gone), statistics]) if gone.any() else statistics
    if kept.given != _text(given):
        path.unlink()
        return whole, choose_baseline(whole, given)
    begin, end = kept.interval
    # What arrived late for the time of the baseline does not change it.
    known = np.isin(np.rint(whole.start / whole.length), np.rint(rows.start / rows.length))
    return whole, Baseline(known & (whole.start >= begin) & (whole.end <= end), True, kept.words)


def _covered(rows: WindowStatistics, statistics: WindowStatistics) -> np.ndarray:
    """Return which windows of `rows` share time with a window of `statistics`, (w,) bool."""
    if not statistics.windows:
        return np.zeros(rows.windows, dtype=bool)
    next_one = np.searchsorted(statistics.end, rows.start, side="right")
    return (next_one < statistics.windows) & (
        statistics.start[np.minimum(next_one, statistics.windows - 1)] < rows.end - 1e-6
    )


def _text(given: Mapping[str, Any]) -> str:
    """Return the keys of a baseline in one wording: a time is one moment however it is written."""
    moments = {key: float(moment_of(given[key])) for key in ("from", "until") if given.get(key) is not None}
    return json.dumps({**given, **moments}, sort_keys=True)


@dataclass(frozen=True)
class _Kept:
    """A kept baseline: its windows, what was `given` for it as text, its interval [s] and what was said of it."""

    rows: WindowStatistics
    given: str
    interval: tuple[float, float]
    words: str

    def compares(self, statistics: WindowStatistics, given: Mapping[str, Any]) -> bool:
        """Return whether its windows were made as those of `statistics`."""
        rows = self.rows
        alike = rows.axes == statistics.axes and np.isclose(rows.length, statistics.length)
        made_with = parse_json(self.given, "baseline", dict).get("made_with")
        return bool(
            alike
            and np.allclose(rows.torque_reference, statistics.torque_reference)
            and made_with == given.get("made_with")
        )


def _kept(path: Path) -> _Kept | None:
    """Return the kept baseline, or None where the file cannot be read."""
    try:
        with open_dataset(path) as dataset:
            given, words = str(dataset.given), str(dataset.words)
            begin, end = (float(x) for x in np.atleast_1d(dataset.interval))
        parse_json(given, path, dict)
        return _Kept(read_statistics(path), given, (begin, end), words)
    except (InputError, AttributeError, ValueError):
        return None
