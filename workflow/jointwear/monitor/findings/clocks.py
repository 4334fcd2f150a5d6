"""Clocks of loggers: one that was set back, so that logs lie far before those that come before them by name, and one
that is not turned where summer time begins."""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.measurement.formats.local_stamps import UNTURNED
from jointwear.monitor.findings.findings import moment_words
from jointwear.monitor.reading.assembly import History
from jointwear.monitor.reading.misdated import PAUSE

#: Kind of the finding.
CLOCK = "clock"


def clock_findings(history: History) -> list[dict[str, Any]]:
    """Return what is wrong with the clock of the logger, one finding for each fault of the whole history."""
    return [*_set_back(history), *_unturned(history)]


def _unturned(history: History) -> list[dict[str, Any]]:
    """Return a finding where logs hold hours that do not exist in their zone, or none; the first of them stands for
    all."""
    told = [(p, line) for p in history.pieces for line in p.refused if UNTURNED in line]
    if not told:
        return []
    piece, line = told[0]
    begin = piece.first if np.isfinite(piece.first) else float(history.statistics.start[0])
    return [{"time": float(begin), "axes": [], "kind": CLOCK, "words": f"{line}."}]


def _set_back(history: History) -> list[dict[str, Any]]:
    """Return a finding where logs lie :data:`PAUSE` and more before all others though most of these come before them by
    name, or none: they count as of the time that they say, so that a baseline may hold what came after it."""
    if not history.statistics.dated:
        return []
    known = [p for p in history.pieces if np.isfinite(p.first) and not p.copy_of and p.statistics.windows]
    order = np.argsort([p.first for p in known], kind="stable")
    begins = np.array([known[i].first for i in order])
    for cut in np.flatnonzero(np.diff(begins) > PAUSE)[::-1] + 1:
        early, late = order[:cut], order[cut:]
        if np.median(early) > np.median(late) and len(early) < len(late):
            days = (begins[cut] - begins[cut - 1]) / 86400
            logs = "1 log" if len(early) == 1 else f"{len(early)} logs"
            words = (
                f"Of {logs}, from {moment_words(history.statistics, begins[0])} on, the dates lie {days:.0f} days "
                "before those of the others, though they come after most of them by name: was a clock set back? They "
                "count as of the time that they say; mend their dates, or leave them out."
            )
            return [{"time": float(begins[-1]), "axes": [], "kind": CLOCK, "words": words}]
    return []
