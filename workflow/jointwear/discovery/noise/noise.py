"""Colour of the torque noise: an autoregressive model an axis, and the filter that whitens data and regressors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

HIGHEST_ORDER = 6
#: The same where the noise of derived accelerations shows, which rises with the fourth power of the frequency up to the
#: end of the band of the derivatives and falls steeply there, and where slow noise is told from what is slow: beside
#: white noise it has many small coefficients, and a model that ends before them leaves a part of it as structure. Of
#: the samples that an order of 16 leaves, as it takes as many beside every gap, a higher one has to leave half.
HIGHEST_ORDER_DERIVED, ORDER_BESIDE_GAPS, LEFT_BY_ORDER = 64, 16, 0.5
#: Columns from which on they are whitened sample by sample: all of them at once, lag by lag, no cache holds. Where each
#: column lies in one piece, so many are whitened at a time.
WIDE = 32
#: Samples after which noise that is drawn has settled.
SETTLE = 200
#: Samples that a noise model needs, in all and for each of its coefficients: with fewer its order is lower.
FEWEST_OF_MODEL, FEWEST_EACH = 200, 30
#: Frequencies over which the gain of a noise model is taken.
POINTS = 2049


@dataclass(frozen=True)
class Whitener:
    """Turns samples of one axis into independent ones of unit variance.

    Attributes
    ----------
    rows : (m,) samples whose `order` predecessors are usable too and of the same trajectory.
    lags : (p,) coefficients of the autoregressive model. sigma : standard deviation of its innovations [N m].
    spread : that of the noise itself by what the fit behind the model left [N m], whatever its colour, NaN unknown.
    """

    rows: np.ndarray
    lags: np.ndarray
    sigma: float
    spread: float = np.nan

    def __call__(self, columns: np.ndarray) -> np.ndarray:
        """Whiten columns (N, k) or (N,) into (m, k) or (m,)."""
        order = len(self.lags)
        if not columns.size or not len(self.rows):
            return columns[self.rows]
        kernel = np.concatenate([-self.lags[::-1], [1.0]]) / self.sigma
        if columns.ndim == 2 and columns.flags.f_contiguous and columns.shape[1] > 1:
            return self._in_pieces(columns.T, kernel).T
        if columns[0].size > WIDE:
            windows = np.lib.stride_tricks.sliding_window_view(columns, order + 1, axis=0)
            return np.einsum("...k,k->...", windows, kernel).take(self.rows - order, axis=0)
        count = len(columns) - order
        result = kernel[0] * columns[:count]
        for lag in range(1, order + 1):
            result += kernel[lag] * columns[lag : lag + count]
        return result.take(self.rows - order, axis=0)

    def _in_pieces(self, series: np.ndarray, kernel: np.ndarray) -> np.ndarray:
        """Return series (k, N), each in one piece, whitened (k, m)."""
        order, result = len(self.lags), np.empty((len(series), len(self.rows)))
        count, places = series.shape[1] - order, self.rows - order
        for first in range(0, len(series), WIDE):
            part = series[first : first + WIDE]
            white = kernel[0] * part[:, :count]
            for lag in range(1, order + 1):
                white += kernel[lag] * part[:, lag : lag + count]
            white.take(places, axis=1, out=result[first : first + WIDE], mode="clip")
        return result

    def density(self, frequency: np.ndarray, rate: float) -> np.ndarray:
        """Return the density (k,) [(N m)^2/Hz, one-sided] of the noise at frequencies (k,) [Hz]."""
        angle = 2 * np.pi * np.outer(frequency, np.arange(1, len(self.lags) + 1)) / rate
        return 2 * self.sigma**2 / (rate * np.abs(1 - np.exp(-1j * angle) @ self.lags) ** 2)

    @property
    def marginal(self) -> float:
        """Standard deviation of the noise itself [N m]."""
        return self.sigma * float(np.sqrt(1.0 / max(_gain(self.lags), 1e-6)))


def _gain(lags: np.ndarray) -> float:
    """Innovation variance over marginal variance of an autoregressive model, by its spectrum."""
    if not len(lags):
        return 1.0
    frequencies = np.linspace(0, np.pi, POINTS)
    transfer = 1 - np.exp(-1j * np.outer(frequencies, np.arange(1, len(lags) + 1))) @ lags
    return 1.0 / float(np.mean(1 / np.maximum(np.abs(transfer) ** 2, 1e-9)))


def whitenable(usable: np.ndarray, trajectory: np.ndarray, order: int) -> np.ndarray:
    """Return the samples (m,), of `usable` and `trajectory` (N,), whose `order` predecessors are usable and of the same
    trajectory."""
    good = usable.copy()
    for lag in range(1, order + 1):
        good[lag:] &= usable[:-lag] & (trajectory[lag:] == trajectory[:-lag])
        good[:lag] = False
    return np.flatnonzero(good)


def order_in_runs(usable: np.ndarray, trajectory: np.ndarray) -> int | None:
    """Return the highest order of a plain noise model, up to :data:`HIGHEST_ORDER`, of samples in short runs.

    Runs of samples in motion end at reversals. Of a log of few samples a second half of them or more may lie within
    :data:`HIGHEST_ORDER` samples of the start of a run: the order is lower there, so that it leaves half. It is None
    where samples are too few for what is in the motion to be told from noise.

    Parameters
    ----------
    usable, trajectory : (N,) samples that are judged, and their labels.
    """
    count = int(usable.sum())
    order = next(
        (k for k in range(HIGHEST_ORDER, 0, -1) if len(whitenable(usable, trajectory, k)) >= LEFT_BY_ORDER * count), 0
    )
    return order if order == HIGHEST_ORDER or count >= FEWEST_OF_MODEL else None


def highest_order(usable: np.ndarray, trajectory: np.ndarray) -> int:
    """Return the highest order of a noise model of derived accelerations that leaves enough of samples with gaps.

    Parameters
    ----------
    usable, trajectory : (N,) samples that are judged, and their labels.
    """
    joined = usable[1:] & usable[:-1] & (trajectory[1:] == trajectory[:-1])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], joined, [False]]).astype(int)))
    runs = edges[1::2] - edges[::2] + 1
    least = np.sum(np.maximum(runs - ORDER_BESIDE_GAPS, 0))
    for order in range(HIGHEST_ORDER_DERIVED, ORDER_BESIDE_GAPS, -1):
        if np.sum(np.maximum(runs - order, 0)) >= LEFT_BY_ORDER * least > 0:
            return order
    return ORDER_BESIDE_GAPS


def estimate(
    residual: np.ndarray, usable: np.ndarray, trajectory: np.ndarray, highest: int = HIGHEST_ORDER
) -> Whitener:
    """Fit the noise model of one axis to a residual (N,).

    Samples that are `usable` (N,) are fitted, within their `trajectory` (N,). The order, up to `highest`, is chosen by
    the Bayesian information criterion on the same samples for all orders.
    """
    rows = whitenable(usable, trajectory, highest)
    while highest and len(rows) < max(FEWEST_OF_MODEL, FEWEST_EACH * highest):
        highest -= 1
        rows = whitenable(usable, trajectory, highest)
    # One triangle holds the squares that are left at every order: what its last column holds from there on.
    past = np.stack([residual[rows - lag] for lag in (*range(1, highest + 1), 0)], axis=1)
    squares = np.linalg.qr(past, mode="r")[:, -1] ** 2
    variance = np.cumsum(squares[::-1])[::-1] / max(len(rows), 1) + 1e-300
    best = (np.inf, 0)
    for order in range(highest + 1):
        score = len(rows) * np.log(variance[order]) + (order + 1) * np.log(max(len(rows), 2))
        if score < best[0] - 2.0:
            best = (score, order)
    lags, left = regress(residual, rows, best[1])
    return Whitener(whitenable(usable, trajectory, best[1]), lags, float(np.sqrt(left)))


def regress(series: np.ndarray, rows: np.ndarray, order: int) -> tuple[np.ndarray, float]:
    """Least-squares coefficients (order,) and innovation variance of an autoregressive model of a series (N,)."""
    target = series[rows]
    if not order:
        return np.zeros(0), float(np.mean(target**2)) + 1e-300
    past = np.stack([series[rows - lag] for lag in range(1, order + 1)], axis=1)
    lags = np.linalg.lstsq(past, target, rcond=None)[0]
    return lags, float(np.mean((target - past @ lags) ** 2)) + 1e-300


def simulate(white: Whitener, trajectory: np.ndarray, draws: int, rng: np.random.Generator) -> np.ndarray:
    """Draw noise of the model, (N, draws), independent between trajectories."""
    return coloured(white, drawn(trajectory, draws, rng))


def drawn(trajectory: np.ndarray, draws: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Draw what noise is made of, (:data:`SETTLE` + n, draws) standard normal numbers for each trajectory (n,)."""
    edges = np.flatnonzero(np.diff(trajectory)) + 1
    return [rng.standard_normal((n + SETTLE, draws)) for n in np.diff([0, *edges, len(trajectory)])]


def coloured(white: Whitener, drive: list[np.ndarray]) -> np.ndarray:
    """Return the noise (N, draws) of the model that is made of :func:`drawn` numbers; whitened it is these again."""
    return np.concatenate(
        [lfilter([1.0], [1.0, *(-white.lags)], piece * white.sigma, axis=0)[SETTLE:] for piece in drive]
    )


def stable(lags: np.ndarray, largest: float) -> np.ndarray:
    """Return the coefficients (p,) shrunk until no pole is larger than `largest`."""
    if not len(lags):
        return lags
    radius = float(np.max(np.abs(np.roots([1.0, *(-lags)]))))
    if radius <= largest:
        return lags
    return lags * (largest / radius) ** np.arange(1, len(lags) + 1)
