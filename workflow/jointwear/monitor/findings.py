"""What is no alarm of wear but must be told: a service that a fall proposes, axes that moved together."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import numpy as np

from jointwear.monitor.shared_error import FINDING
from jointwear.monitor.watching import Watch
from jointwear.monitor.windows import WindowStatistics


def moment_words(statistics: WindowStatistics, seconds: float) -> str:
    """Return a time as ISO 8601 UTC, or in hours of the log's clock."""
    if statistics.dated:
        return datetime.fromtimestamp(seconds, tz=UTC).strftime("%Y-%m-%dT%H:%MZ")
    return f"{seconds / 3600:.4g} h"


def findings_of(
    statistics: WindowStatistics, shift: np.ndarray, baseline: np.ndarray, level: Watch
) -> list[dict[str, Any]]:
    """Return the findings, each with `time` [s], `axes` (1-based), `kind` and `words` for the page."""
    return sorted(_services(statistics, level) + _shared(statistics, shift, baseline, level), key=lambda f: f["time"])


def _services(statistics: WindowStatistics, level: Watch) -> list[dict[str, Any]]:
    result = []
    for j, starts in enumerate(level.starts):
        for start in starts:
            if start.proposed:
                time = float(statistics.start[start.window])
                words = (
                    f"Friction of axis {j + 1} fell at {moment_words(statistics, time)}: was it serviced or greased? "
                    "It is learnt anew from there; enter the service under 'events' to confirm it, or look for "
                    "another cause."
                )
                result.append({"time": time, "axes": [j + 1], "kind": "proposed_service", "words": words})
    return result


def _shared(
    statistics: WindowStatistics, shift: np.ndarray, baseline: np.ndarray, level: Watch
) -> list[dict[str, Any]]:
    """One finding for each run of shifts in which all axes moved together."""
    result: list[dict[str, Any]] = []
    before = False
    for s in np.unique(shift[~baseline]):
        rows = shift == s
        mean = float(np.mean(level.shared.common[rows]))
        if abs(mean) > FINDING and not before:
            time = float(statistics.start[rows][0])
            words = (
                f"All axes moved together by {100 * mean:+.0f} % from {moment_words(statistics, time)} on, which is no "
                "wear of one axis: look at the temperature, the oil, the model and the unit of the torque."
            )
            result.append({"time": time, "axes": [], "kind": "shared", "words": words})
        before = abs(mean) > FINDING
    return result
