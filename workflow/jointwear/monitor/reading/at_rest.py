"""Axes that stand still while the noise of their velocity leaves the dead band now and then.

A dead band of five standard deviations is left by one sample in a million, and by one in a thousand where the noise has
grown since the first log. Such samples are of no motion: they are taken out of the statistics, as if the dead band had
kept them out, so that their axis is at rest, and says nothing of speeds, programs and friction.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.survey import AT_REST
from jointwear.monitor.reading.windows import WindowStatistics

#: Share of the samples of a window below which an axis that travels no further than one at rest does not move: where
#: no path is known (samples far apart), the others are of motion.
SELDOM = 0.05
#: What the regression makes of moving samples.
OF_MOTION = (
    "gram", "moment", "square", "count", "residual_square", "freedom", "lag_square", "lag_count", "score", "blocks",
    "stretches", "pulse_near", "pulse_far", "near_count", "far_count", "turns",
)  # fmt: skip


def without_noise_at_rest(statistics: WindowStatistics) -> WindowStatistics:
    """Return the windows with axes at rest that leave their dead band by noise alone: these have no moving samples."""
    still = (statistics.count > 0) & (statistics.travel < AT_REST) & (statistics.share_used < SELDOM)
    if not still.any():
        return statistics
    blank = {name: getattr(statistics, name).copy() for name in OF_MOTION}
    for values in blank.values():
        values[still] = 0
    return replace(statistics, **blank, flags=np.where(still, statistics.flags | int(Flag.AT_REST), statistics.flags))
