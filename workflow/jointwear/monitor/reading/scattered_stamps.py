"""Time stamps that scatter about the times of their samples, as where a loaded computer stamps what comes in.

Positions are those of the true times: over the wrong steps they make velocities and accelerations that no axis had, and
with these a friction and an inertia that look like play, a bearing or another speed. Steps that are rounded, or twice
the usual where a sample is lost, are no scatter: most of them are alike.
"""

from __future__ import annotations

import numpy as np

from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.windows import WindowStatistics

#: Median deviation of the steps of time from the usual one, as a share of it, from which stamps scatter. Stamps rounded
#: to ms have 0.06 at 60 Hz and less below; stamps that are off by a seventh of a step (standard deviation) have this.
SCATTER = 0.14
#: Share of the windows of the baseline with a flag from which on it is how the logs are, and no news.
USUAL = 0.1


def stamps_scatter(time: np.ndarray, stretch: np.ndarray) -> bool:
    """Return whether times (m,) [s] scatter within their uninterrupted runs, `stretch` (m,) labels."""
    steps = np.diff(time)[np.diff(stretch) == 0]
    if not len(steps):
        return False
    usual = float(np.median(steps))
    return usual > 0 and float(np.median(np.abs(steps - usual))) > SCATTER * usual


def scattered_since(statistics: WindowStatistics, baseline: np.ndarray | None) -> np.ndarray:
    """Return the windows (w, n) whose stamps scatter as those of the `baseline` (w,) bool do not; none where there is
    no baseline to compare with."""
    return marked_since(statistics, baseline, Flag.SCATTERED)


def marked_since(statistics: WindowStatistics, baseline: np.ndarray | None, flag: Flag) -> np.ndarray:
    """Return the windows (w, n) with a flag that those of the `baseline` (w,) bool do not have; none where there is no
    baseline to compare with."""
    marked = statistics.flags & int(flag) != 0
    usual = baseline is None or not baseline.any() or marked[baseline].any(axis=1).mean() >= USUAL
    return np.zeros_like(marked) if usual else marked
