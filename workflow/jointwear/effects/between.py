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
        splines = [_spline(time, values, part) for part in records]
        begins, knots, powers = 0.0, [], []
        # Records lie one after the other on one axis, so that all are asked at once.
        self._first, self._last, self._shift = (np.zeros(len(time)) for _ in range(3))
        for part, spline in zip(records, splines, strict=True):
            first, last = time[part][0], time[part][-1]
            self._first[part], self._last[part], self._shift[part] = first, last, begins - first
            # At its end and beyond a record keeps its last value.
            own = np.zeros((DEGREE + 1, len(spline.x), *np.shape(values)[1:]))
            own[-len(spline.c) :, :-1], own[-1, -1] = spline.c, values[part][-1]
            knots.append(spline.x + (begins - first))
            powers.append(own)
            begins += last - first + 1.0
        if splines:
            knots.append([begins])
            self._spline = PPoly.construct_fast(np.concatenate(powers, axis=1), np.concatenate(knots))

    def earlier(self, delay: float) -> np.ndarray:
        """Return the values, of their own shape, as they were `delay` [s] earlier; negative: as they will be."""
        if delay == 0 or not len(self._time):
            return np.array(self._values, dtype=float)
        asked = self._time - delay
        inside = np.clip(asked, self._first, self._last)
        found = self._spline(inside + self._shift)
        beyond = np.flatnonzero(asked != inside)
        if len(beyond) and self._turned:
            first, last = self._first[beyond], self._last[beyond]
            mirror = np.clip(2.0 * inside[beyond] - asked[beyond], first, last)
            where = np.ix_(beyond, self._turned)
            found[where] = 2.0 * found[where] - self._spline(mirror + self._shift[beyond])[:, self._turned]
        return found


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
    if spline.k == DEGREE:
        return PPoly.construct_fast(_quintic(np.diff(knots), *(spline(knots, order) for order in range(3))), knots)
    powers = [spline(knots[:-1], order) / factorial(order) for order in range(spline.k, -1, -1)]
    return PPoly.construct_fast(np.array(powers), knots)


def _quintic(step: np.ndarray, value: np.ndarray, slope: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """Return the coefficients (6, m - 1, ...) of polynomials with values, first and second derivatives (m, ...) at the
    ends of steps (m - 1,), from the highest power down: half of the derivatives need not be asked for."""
    h = step.reshape(-1, *[1] * (value.ndim - 1))
    rise, v0, v1, a0, a1 = (
        np.diff(value, axis=0),
        slope[:-1] * h,
        slope[1:] * h,
        0.5 * bend[:-1] * h**2,
        0.5 * bend[1:] * h**2,
    )
    third = 10.0 * rise - 6.0 * v0 - 4.0 * v1 - 3.0 * a0 + a1
    fourth = -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 3.0 * a0 - 2.0 * a1
    fifth = 6.0 * rise - 3.0 * (v0 + v1) - a0 + a1
    return np.stack([fifth / h**5, fourth / h**4, third / h**3, 0.5 * bend[:-1], slope[:-1], value[:-1]])
