"""Numbers in coarser steps than in the first log: positions to a tenth of a degree, torques to 1 N m.

What rounding adds looks like a fault of the robot: to the torque of a light axis play or a damaged bearing, to
accelerations, and with them to the torques of all axes, a part that is carried. It is a fact of the log, and no axis
is called loud, and no part found, for it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jointwear.measurement.derived.encoder_step import encoder_step
from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.scattered_stamps import marked_since
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Samples, from all of a log, by which the steps of numbers are told.
LOOK = 4000
#: Different values, from the one to the other, and samples of each, on average, that lie a step apart though they are
#: few: a torque of 3 N m in steps of 1.
FEW, OFTEN = (3, 20), 10
#: Times the step of the first log from which numbers are coarser: one digit less is ten, one bit two.
COARSER = 3.0
#: Windows of the baseline with the coarser steps from which these are no news: steps that are no whole number of the
#: last digit are told as the one or the other, and which of them the first log has is chance.
ALREADY = 2
#: Times the noise of the baseline that windows with coarser numbers have where these matter.
NEWS = 1.25


def written_steps(values: np.ndarray) -> list[float | None]:
    """Return the steps in which values (m, n) are written, (n,), None where there are none."""
    return [_written_step(column) for column in values[:: max(len(values) // LOOK, 1)].T]


def _written_step(values: np.ndarray) -> float | None:
    known = values[np.isfinite(values)]
    own = np.unique(known)
    if FEW[0] <= len(own) < FEW[1] and len(known) >= OFTEN * len(own):
        return float(np.diff(own).min())
    return encoder_step(known)


def coarser(values: np.ndarray, first: Sequence[float | None]) -> np.ndarray:
    """Return the axes (n,) whose values (m, n) are written in far coarser steps than those of the first log; none where
    `first` says nothing of it."""
    if not first:
        return np.zeros(values.shape[1], dtype=bool)
    pairs = zip(written_steps(values), first, strict=True)
    return np.array([now is not None and (then is None or now > COARSER * then) for now, then in pairs])


def rounded_since(statistics: WindowStatistics, baseline: np.ndarray | None, flag: Flag) -> np.ndarray:
    """Return the windows (w, n) whose positions or torques, as `flag` says, are coarser and noisier for it, unlike
    those of the `baseline` (w,) bool; none where there is no baseline to compare with."""
    marked = marked_since(statistics, baseline, flag)
    if not marked.any():
        return marked
    marked &= marked[baseline].sum(axis=0) < ALREADY
    noise = np.sqrt(statistics.noise_variance)
    usual = known_median(np.where(baseline[:, None], noise, np.nan), axis=0)
    with np.errstate(invalid="ignore"):
        louder = noise > NEWS * usual
    # Every torque depends on every position.
    felt = louder.any(axis=1)[:, None] if flag == Flag.COARSE_POSITION else louder
    return marked & felt


def loud_by_rounding(statistics: WindowStatistics, baseline: np.ndarray) -> np.ndarray:
    """Return the windows (w, n) that coarser numbers may have made loud."""
    position = rounded_since(statistics, baseline, Flag.COARSE_POSITION).any(axis=1)
    return rounded_since(statistics, baseline, Flag.COARSE_TORQUE) | position[:, None]
