"""Logs that end within a row, or hold much less than the others of a robot that always logs for as long: cut off while
they were written, or copied before they were whole. What they hold is judged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import significant
from jointwear.monitor.reading.assembly import History, Piece

#: Kinds of the findings.
SHORT, CUT = "short_logs", "cut_logs"
#: Fewest logs that tell how long one usually is, share of them that has to be so, and by how much these may differ.
FEWEST_LOGS, MOST, SAME_LENGTH = 10, 0.8, 0.02
#: Share of that length below which a log ends early.
EARLY = 0.9


def short_log_findings(history: History) -> list[dict[str, Any]]:
    """Return findings on logs that end within a row, and on those that end early, where most logs last equally long,
    and less than a window.

    A log that fills its window or more ends where the work does, unless a row of it is torn. The newest one may still
    be being written.
    """
    known = [p for p in history.pieces if np.isfinite(p.first) and not p.copy_of and p.statistics.windows]
    known.sort(key=lambda p: p.first)
    return _cut(known[:-1]) + _early(known, history.statistics.length)


def _cut(logs: Sequence[Piece]) -> list[dict[str, Any]]:
    """Return the finding on those of the logs that end within a row, or none."""
    torn = [p for p in logs if p.cut]
    if not torn:
        return []
    one = f"{torn[-1].log} ends"
    words = (
        f"{one if len(torn) == 1 else f'{len(torn)} logs end, the latest of them {torn[-1].log},'} within a row: cut "
        "off while written or copied? What is there is judged."
    )
    return [{"time": torn[0].first, "end": torn[-1].last, "axes": [], "kind": CUT, "words": words}]


def _early(known: Sequence[Piece], length: float) -> list[dict[str, Any]]:
    """Return the finding on logs that are shorter than others, or none.

    Parameters
    ----------
    known : logs in order of time. length : of a window [s].
    """
    lasted = np.array([p.last - p.first for p in known])
    if len(known) < FEWEST_LOGS:
        return []
    usual = float(np.median(lasted))
    if not 0 < usual < length or np.mean(np.abs(lasted / usual - 1) <= SAME_LENGTH) < MOST:
        return []
    early = np.flatnonzero((lasted[:-1] < EARLY * usual) & ~np.array([p.cut for p in known[:-1]]))
    if not len(early):
        return []
    shortest = early[np.argmin(lasted[early])]
    logs, where = ("1 log ends", "") if len(early) == 1 else (f"{len(early)} logs end", "the shortest, ")
    words = (
        f"{logs} early, {where}{known[shortest].log}, after {significant(lasted[shortest], 2)} s of "
        f"{significant(usual, 2)} s: cut off while written or copied? What is there is judged."
    )
    return [{"time": known[early[0]].first, "end": known[early[-1]].last, "axes": [], "kind": SHORT, "words": words}]
