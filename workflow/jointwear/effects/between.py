"""Values of ordered samples at times between them: splines within each record."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from jointwear.files.errors import InputError

#: Degree of the splines between samples.
DEGREE = 5
#: Share of a step by which samples may miss an even grid that counts as even: round-off of their times.
EVEN = 1e-9


class Between:
    """Values (m,) or (m, k) of ordered samples as they were at other times of the same record.

    Splines go through the samples: straight lines would take off what changes fast, noise above all. They are worked
    out once and asked as often as there are delays.

    Parameters
    ----------
    time : (m,) [s], rising within each record. values : finite. records : their slices.

    Raises
    ------
    InputError : names the first sample whose time does not rise, or that is not finite.
    """

    def __init__(self, time: np.ndarray, values: np.ndarray, records: Sequence[slice]) -> None:
        self._time, self._values = time, values
        self._records = [(part, _spline(time, values, part)) for part in records]

    def earlier(self, delay: float) -> np.ndarray:
        """Return the values as they were `delay` [s] earlier; beyond the ends of a record its end values hold."""
        if delay == 0:
            return np.array(self._values, dtype=float)
        result = np.empty(np.shape(self._values))
        for part, spline in self._records:
            result[part] = _earlier(self._time[part], spline, delay)
        return result


def _earlier(time: np.ndarray, spline: BSpline, delay: float) -> np.ndarray:
    """Return the values (m, ...) of the spline of one record `delay` [s] before its times (m,)."""
    count = len(time)
    step = (time[-1] - time[0]) / max(count - 1, 1)
    inner = range(0)
    if spline.k == DEGREE and np.abs(time - np.linspace(time[0], time[-1], count)).max() <= EVEN * step:
        # On an even grid all samples whose neighbours are no end have the same weights. Knots are the samples but for
        # the two beside each end.
        before = int(np.ceil(delay / step))
        inner = range(max(before + 2 * DEGREE - 2, 0), min(count + before - 2 * DEGREE + 1, count))
    if len(inner) <= 0:
        return spline(np.clip(time - delay, time[0], time[-1]))
    result = np.empty((count, *spline.c.shape[1:]))
    first = inner.start - before - 2
    result[inner.start : inner.stop] = sum(
        weight * spline.c[first + k : first + k + len(inner)]
        for k, weight in enumerate(_weights(before - delay / step, DEGREE))
    )
    ends = np.r_[: inner.start, inner.stop : count]
    result[ends] = spline(np.clip(time[ends] - delay, time[0], time[-1]))
    return result


def _weights(share: float, degree: int) -> list[float]:
    """Return the weights of the `degree` + 1 coefficients of a spline on even knots, `share` of a step after a knot."""
    weights = [1.0]
    for p in range(1, degree + 1):
        rise = [(share + p - 1 - k) / p * w for k, w in enumerate(weights)]
        fall = [(k + 1 - share) / p * w for k, w in enumerate(weights)]
        weights = [a + b for a, b in zip([*fall, 0.0], [0.0, *rise], strict=True)]
    return weights


def _spline(time: np.ndarray, values: np.ndarray, part: slice) -> BSpline:
    """Return the spline through the samples of one record; straight lines where there are too few for its degree."""
    t, x = time[part], values[part]
    finite = np.isfinite(t) & np.isfinite(x.reshape(len(x), -1)).all(axis=1)
    if not finite.all():
        raise InputError(f"sample {part.start + int(np.argmin(finite))}: time and values have to be finite")
    rises = np.diff(t) > 0
    if not rises.all():
        late = int(np.argmin(rises)) + 1
        raise InputError(
            f"sample {part.start + late}: its time {t[late]:.9g} s does not lie behind that of the sample before, "
            f"{t[late - 1]:.9g} s; the times of a record have to rise"
        )
    # A single sample is what it is at all times.
    return make_interp_spline(t, x, k=DEGREE if len(t) > DEGREE else min(1, len(t) - 1))
