"""Values of ordered samples at times between them: splines within each record."""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline

from jointwear.files.errors import InputError

#: Degree of the splines between samples.
DEGREE = 5


class Between:
    """Values (m,) or (m, k) of ordered samples as they were at other times of the same record.

    Splines go through the samples: straight lines would take off what changes fast, noise above all. They are worked
    out once, as polynomials between their knots, and asked as often as there are delays.

    Parameters
    ----------
    time : (m,) [s], rising within each record. values : finite. records : their slices.
    turned : columns of `values` (m, k) that go on beyond the ends of a record turned about them, as their slope has it
        and noise stays as large; all others keep their end values.

    Raises
    ------
    InputError : names the first sample whose time does not rise, or that is not finite.
    """

    def __init__(
        self, time: np.ndarray, values: np.ndarray, records: Sequence[slice], turned: Sequence[int] = ()
    ) -> None:
        self._time, self._values, self._turned = time, values, list(turned)
        self._records = [(part, _spline(time, values, part)) for part in records]

    def earlier(self, delay: float) -> np.ndarray:
        """Return the values as they were `delay` [s] earlier; negative: as they will be."""
        if delay == 0:
            return np.array(self._values, dtype=float)
        result = np.empty(np.shape(self._values))
        for part, spline in self._records:
            time = self._time[part]
            asked = time - delay
            inside = np.clip(asked, time[0], time[-1])
            found = spline(inside)
            beyond = np.flatnonzero(asked != inside)
            if len(beyond) and self._turned:
                mirror = np.clip(2.0 * inside[beyond] - asked[beyond], time[0], time[-1])
                where = np.ix_(beyond, self._turned)
                found[where] = 2.0 * found[where] - spline(mirror)[:, self._turned]
            result[part] = found
        return result


def _spline(time: np.ndarray, values: np.ndarray, part: slice) -> PPoly:
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
    spline = make_interp_spline(t, x, k=DEGREE if len(t) > DEGREE else min(1, len(t) - 1))
    # A polynomial takes a quarter of the time of the sum over splines; powers from the highest down.
    knots = spline.t[spline.k : len(spline.t) - spline.k]
    powers = [spline(knots[:-1], order) / factorial(order) for order in range(spline.k, -1, -1)]
    return PPoly.construct_fast(np.array(powers), knots, extrapolate=True)
