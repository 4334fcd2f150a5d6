"""Spells of shifts in a row in which something about the logs is odd, as findings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.runs import runs


def spells(odd: Sequence[bool] | np.ndarray, fewest: int) -> list[slice]:
    """Return the runs of at least `fewest` shifts that are odd, (s,) bool."""
    odd = np.asarray(odd, dtype=bool)
    return [part for part in runs(odd, shortest=fewest) if odd[part.start]]


def spell_finding(
    statistics: WindowStatistics,
    own: np.ndarray,
    axes: Sequence[int],
    kind: str,
    words: str,
    events: Sequence[Sequence[int]],
) -> dict[str, Any]:
    """Return the finding on a spell of windows `own` (k,).

    Parameters
    ----------
    axes : 1-based, that the finding names. events : for each axis asked the windows of the events that a user entered;
        one of every axis after the begin answers it.
    """
    answered = {"answered": True} if all(any(window >= own[0] for window in e) for e in events) else {}
    time, end = float(statistics.start[own[0]]), float(statistics.end[own[-1]])
    return {"time": time, "end": end, "axes": list(axes), "kind": kind, "words": words, **answered}
