"""Derivatives of measured motion by least squares: splines with as few knots as the data ask for.

A filter has to let pass whatever lies below its cut-off, noise included, and needs room at the ends. Where the
sampling resolves the motion, a spline is fitted instead: degree 7, so that the acceleration is smooth and the band
of the fit ends sharply at 1 / (2 spacing), with evenly spaced knots. The spacing of each joint is the one of least
Akaike information criterion over all recordings: knots are added as long as they follow the motion and not the
noise. (A smooth motion has no true number of knots; the Bayesian criterion, made to find one, stops too early for the
acceleration.) The noise of the derivatives follows from that of the samples and from the spacing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import cho_solve_banded, cholesky_banded

DEGREE = 7
#: Spacings of knots that are tried [samples], from the widest [s] on, each this share of the one before.
NARROWEST, WIDEST, SHRINK = 2.5, 1.0, 0.8
#: Rate [Hz] below which no knots fit, so that no motion is resolved.
SLOWEST = NARROWEST / WIDEST
#: Share of a sample's time up to which two times are the same but for rounding.
SAME = 1e-9
#: Closer to an end than this share of the spacing an acceleration is ten times as uncertain as elsewhere.
END = 0.5
#: Spacings of the widest knots of a robot from which on it is at most one and a half times as uncertain, and time [s]
#: beyond which that does not matter: the accelerations of motion so smooth are known everywhere.
CLEAR_OF_END, LONGEST_END = 2.0, 0.1


def widest_band(rate: float) -> float:
    """Return the frequency [Hz] at which the band of a fit with the narrowest spacing ends."""
    steps = np.floor(np.log(NARROWEST / (WIDEST * rate)) / np.log(SHRINK) + 1e-9)
    return 0.5 / (WIDEST * SHRINK**steps) * (1 - 1e-9)


@dataclass(frozen=True)
class Smooth:
    """A fitted signal and its first two derivatives, arrays (m, n), over all pieces in order.

    `spacing` (n,) [s] of the knots, `noise` (n,) standard deviation of the samples about the fit.
    """

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray
    spacing: np.ndarray
    noise: np.ndarray

    @property
    def cutoff(self) -> np.ndarray:
        """Frequency (n,) [Hz] at which the band of the fit ends."""
        return 0.5 / self.spacing

    def derivative_noise(self, order: int, rate: float, band: np.ndarray | None = None) -> np.ndarray:
        """Return the standard deviation (n,) of a derivative: white noise of the samples within the band.

        `band` (n,) [Hz] is another than that of the fit, as that of another signal of the same motion.
        """
        power, end = 2 * order + 1, self.cutoff if band is None else band
        return self.noise * np.sqrt(2 / rate * (2 * np.pi) ** (2 * order) * end**power / power)


class _Fit:
    """Least-squares spline of pieces that are sampled alike at one spacing, for all columns at once."""

    def __init__(self, time: np.ndarray, values: np.ndarray, spacing: float) -> None:
        count = max(int(np.ceil((time[-1] - time[0]) / spacing)), 1)
        inner = np.linspace(time[0], time[-1], count + 1)
        self.knots = np.concatenate([[inner[0]] * DEGREE, inner, [inner[-1]] * DEGREE])
        design = BSpline.design_matrix(time, self.knots, DEGREE)
        size = design.shape[1]
        weights = design.data.reshape(len(time), DEGREE + 1)
        left = design.indices.reshape(len(time), DEGREE + 1)[:, 0]
        normal = np.zeros((DEGREE + 1, size))
        for i in range(DEGREE + 1):
            for k in range(i + 1):
                normal[i - k] += np.bincount(left + k, weights[:, i] * weights[:, k], size)
        # A gap without samples leaves coefficients open: a shade of ridge keeps them finite.
        normal[0] += 1e-10 * normal[0].max()
        factor = cholesky_banded(normal, lower=True)
        self.coefficients = cho_solve_banded((factor, True), design.T @ values)
        self.squares = np.sum((values - design @ self.coefficients) ** 2, axis=0)
        self.size = size

    def derivative(self, time: np.ndarray, order: int, columns: slice) -> np.ndarray:
        """Return a derivative of some columns of the values at `time` (m,) [s], (m, k)."""
        return BSpline(self.knots, self.coefficients[:, columns], DEGREE)(time, order)


def _alike(times: list[np.ndarray], rate: float) -> list[list[int]]:
    """Return the pieces in groups that are sampled at the same times (m,) [s] from their start: one design fits all."""
    groups: list[list[int]] = []
    for i, time in enumerate(times):
        for group in groups:
            first = times[group[0]]
            if len(first) == len(time) and np.abs(first - time).max() <= SAME / rate:
                group.append(i)
                break
        else:
            groups.append([i])
    return groups


def smooth(pieces: list[tuple[np.ndarray, np.ndarray]], rate: float) -> Smooth:
    """Fit pieces of a signal, each (time (k,), values (k, n)), with one spacing of knots a joint.

    Every piece needs more than twice as many samples as a spline has coefficients between two knots.
    """
    total = sum(len(t) for t, _ in pieces)
    n = pieces[0][1].shape[1]
    centred = [(t - t[0], y - y.mean(axis=0)) for t, y in pieces]
    groups = _alike([t for t, _ in centred], rate)
    stacked = [(centred[group[0]][0], np.concatenate([centred[i][1] for i in group], axis=1)) for group in groups]
    # Round-off of a signal that is exact, or of a joint that rests.
    least = total * (1e-10 * np.maximum(np.max([np.ptp(y, axis=0) for _, y in centred], axis=0), 1e-6)) ** 2
    best = np.full(n, np.inf)
    chosen: list[tuple[float, list[_Fit], np.ndarray] | None] = [None] * n
    spacing = WIDEST
    # Down to the narrowest: a fast motion is not seen at all until the knots are close enough.
    while spacing * rate >= NARROWEST:
        fits = [_Fit(t, y, spacing) for t, y in stacked]
        size = sum(f.size * len(group) for f, group in zip(fits, groups, strict=True))
        squares = np.maximum(sum(f.squares.reshape(-1, n).sum(axis=0) for f in fits), least)
        criterion = total * np.log(squares / total) + 2 * size
        better = criterion < best
        for j in np.flatnonzero(better):
            chosen[j] = (spacing, fits, squares[j] / max(total - size, 1))
        best = np.where(better, criterion, best)
        spacing *= SHRINK
    result = np.zeros((3, total, n))
    starts = np.concatenate([[0], np.cumsum([len(t) for t, _ in pieces])])
    for j, (_, fits, _) in enumerate(chosen):
        for fit, group in zip(fits, groups, strict=True):
            time = centred[group[0]][0]
            for order in range(3):
                derived = fit.derivative(time, order, slice(j, None, n))
                for k, i in enumerate(group):
                    result[order, starts[i] : starts[i + 1], j] = derived[:, k]
            for i in group:
                result[0, starts[i] : starts[i + 1], j] += pieces[i][1][:, j].mean()
    return Smooth(*result, np.array([c[0] for c in chosen]), np.sqrt([c[2] for c in chosen]))
