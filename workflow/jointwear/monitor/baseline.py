"""Which windows show the robot healthy: chosen once, then fixed in calendar time and kept.

`from`, `until` and `windows` of the config are turned into an interval once there are enough windows. Interval and
statistics are kept beside the state, so that neither logs that are deleted after a while nor logs that arrive late
move what counts as normal; a change of these keys chooses anew. Where the interval holds too little, it goes on until
it holds enough, and says so.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.files.storage import open_dataset
from jointwear.files.wording import count
from jointwear.measurement.timestamps import utc_seconds
from jointwear.monitor.findings import moment_words
from jointwear.monitor.learning import FEWEST_SHIFTS, FEWEST_WINDOWS
from jointwear.monitor.shifts import shift_labels
from jointwear.monitor.window_files import read_statistics, write_statistics
from jointwear.monitor.windows import WindowStatistics, merge


@dataclass(frozen=True)
class Baseline:
    """`mask` (w,) of the windows; `complete`: nothing more is learnt; `words`: what a user must know, or empty."""

    mask: np.ndarray
    complete: bool
    words: str = ""

    @property
    def count(self) -> int:
        """Number of windows up to the end of the baseline."""
        return int(np.flatnonzero(self.mask)[-1]) + 1 if self.mask.any() else 0


def border(statistics: WindowStatistics, baseline: Mapping[str, Any], key: str) -> float | None:
    """Return `from` or `until` of the config in seconds of the windows, None where it is not given.

    Raises
    ------
    InputError : where a date is given for logs that have none.
    """
    value = baseline.get(key)
    if not isinstance(value, str):
        return None if value is None else float(value)
    if not statistics.dated:
        raise InputError(
            f"config: 'baseline.{key}' is {value}, but the logs have no dates; give seconds of the log's clock, "
            "or 'windows'"
        )
    return utc_seconds(value)


def choose_baseline(statistics: WindowStatistics, given: Mapping[str, Any]) -> Baseline:
    """Return the baseline that the config asks for, longer where it holds too little.

    Parameters
    ----------
    statistics : all windows. given : `from`, `until`, `windows` of the config.
    """
    begin, until = border(statistics, given, "from"), border(statistics, given, "until")
    after = np.ones(statistics.windows, dtype=bool) if begin is None else statistics.start >= begin
    asked = int(given.get("windows", 0))
    mask = after & (statistics.end <= until) if until is not None else np.zeros(statistics.windows, dtype=bool)
    if until is None or asked:
        first = np.flatnonzero(after)[:asked] if until is None else np.flatnonzero(mask)[:asked]
        mask = np.isin(np.arange(statistics.windows), first)
    if until is None and mask.sum() < asked:
        words = (
            f"The baseline asks for {asked} windows, the logs fill {int(mask.sum())}: nothing is judged until "
            f"{asked - int(mask.sum())} more have come."
        )
        return Baseline(mask, False, words)
    if _enough(statistics, mask):
        return Baseline(mask, True)
    longer = mask.copy()
    for k in np.flatnonzero(after & ~mask):
        longer[k] = True
        if _enough(statistics, longer):
            words = (
                f"The baseline holds {_held_words(statistics, mask)}, "
                "too few to know what is normal; it goes on until "
                f"{moment_words(statistics, float(statistics.end[k]))}. Until then nothing is judged."
            )
            return Baseline(longer, True, words)
    words = (
        f"The baseline holds {_held_words(statistics, longer)}; "
        f"{FEWEST_WINDOWS} windows with motion in {FEWEST_SHIFTS} shifts are needed to know what is normal. "
        "Nothing is judged until they have come."
    )
    return Baseline(longer, False, words)


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
    more = {"given": json.dumps(dict(given), sort_keys=True), "interval": [float(rows.start[0]), float(rows.end[-1])]}
    write_statistics(rows, path, "windows of the baseline", dict(given), {**more, "words": baseline.words})


def with_kept_baseline(
    statistics: WindowStatistics, given: Mapping[str, Any], path: Path
) -> tuple[WindowStatistics, Baseline]:
    """Return all windows, those of the kept baseline that the logs no longer hold among them, and the baseline."""
    kept = _kept(statistics, given, path)
    if kept is None:
        path.unlink(missing_ok=True)
        return statistics, choose_baseline(statistics, given)
    rows, (begin, end), words = kept
    gone = ~np.isin(np.rint(rows.start / rows.length), np.rint(statistics.start / statistics.length))
    whole = merge([rows.part(gone), statistics]) if gone.any() else statistics
    # What arrived late for the time of the baseline does not change it.
    known = np.isin(np.rint(whole.start / whole.length), np.rint(rows.start / rows.length))
    return whole, Baseline(known & (whole.start >= begin) & (whole.end <= end), True, words)


def _kept(
    statistics: WindowStatistics, given: Mapping[str, Any], path: Path
) -> tuple[WindowStatistics, tuple[float, float], str] | None:
    if not statistics.dated or not path.exists():
        return None
    try:
        with open_dataset(path) as dataset:
            same = str(dataset.given) == json.dumps(dict(given), sort_keys=True)
            interval = tuple(float(x) for x in np.atleast_1d(dataset.interval))
            words = str(dataset.words)
        rows = read_statistics(path)
    except (InputError, AttributeError):
        return None
    alike = rows.axes == statistics.axes and np.isclose(rows.length, statistics.length)
    scaled = alike and np.allclose(rows.torque_reference, statistics.torque_reference)
    return (rows, interval, words) if same and scaled else None
