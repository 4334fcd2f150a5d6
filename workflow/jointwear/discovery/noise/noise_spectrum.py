"""The noise model put right for what a flexible fit took off the noise, band by band of its spectrum.

A fit with many columns removes slow noise, nearly all of it where it has as many columns as a record has cells at
those frequencies: of 1,300 samples at 50 Hz 240 columns leave a tenth of what lies below 2 Hz. A model of what is left
learns that notch, and whatever moves slowly then looks like structure without a name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np

from jointwear.discovery import assumed
from jointwear.discovery.noise.noise import (
    HIGHEST_ORDER,
    SETTLE,
    Whitener,
    coloured,
    drawn,
    estimate,
    highest_order,
    regress,
    stable,
    whitenable,
)

#: Rounds in which the model is moved, and drawings of its noise in each.
ROUNDS, DRAWS = 5, 8
#: The same where a model of few coefficients is found by these, and the part of a step that is taken after the first.
ROUNDS_OF_LAGS, DAMPED = 3, 0.7
#: Cells of a spectrum, its bands (narrow where the fit took most), and points of a density.
CELLS, BANDS, POINTS = 128, 16, 512
#: Samples with predecessors from which on spectra are compared, in all and of a record.
FEWEST_ROWS, FEWEST_OF_RECORD = 200, 100
#: Edges of the bands in cells.
EDGES = np.unique(np.concatenate([[0], np.round(np.geomspace(1, CELLS, BANDS)).astype(int)]))


def corrected(
    white: Whitener,
    residual: np.ndarray,
    take_off: Callable[[np.ndarray], np.ndarray],
    usable: np.ndarray,
    trajectory: np.ndarray,
    rate: float,
    highest: int = HIGHEST_ORDER,
    drive_of: Callable[[int], list[np.ndarray]] | None = None,
) -> Whitener:
    """Correct a noise model for what a fit took off the noise (indirect inference).

    Noise of a trial model is drawn, put through the same fit and compared with the residual by bands of frequency; the
    density of the trial model is multiplied by the ratio. What the fit took off both makes no difference; where it left
    next to nothing the model is that of the neighbouring frequencies. Its order is chosen anew each time. What lasts
    longer than `assumed.longest_memory` is not noise but structure, for the tests over time to find. Of each
    band a record counts up to `assumed.FULLEST_RECORD` medians: noise is there all the time, a push in some records.
    A residual that falls by more than `assumed.REDDEST` is mostly what the model lacks; more of that than is left is
    not put back, but its coefficients are moved until what the fit leaves of drawn noise has those of the residual.

    Parameters
    ----------
    white : the first trial model, of a low order: a high one has learnt what the fit took off. residual : (N,) [N m]
        after the fit. take_off : series (N, k) -> what the fit leaves of them. usable : (N,) samples that are judged.
    trajectory : (N,) labels. rate : [Hz]. highest : order that the model may have. drive_of : of :func:`drives`, which
        axes share.
    """
    drive_of = drive_of or drives(trajectory)
    ends = white.density(np.array([0.0, 0.5]) * rate, rate)
    if ends[0] > assumed.REDDEST * ends[1]:
        return _by_lags(estimate(residual, usable, trajectory, highest), take_off, drive_of, rate)
    rows = whitenable(usable, trajectory, highest)
    if len(rows) < FEWEST_ROWS:
        return white
    radius = slowest_pole(rate)
    frequency = np.linspace(0.0, 0.5 * rate, POINTS + 1)
    centres = 0.5 * (EDGES[:-1] + EDGES[1:]) * 0.5 * rate / CELLS

    @cache
    def drawn_power(order: int) -> np.ndarray:
        # Whitened by its own model noise is what it was made of.
        return band_power(np.concatenate([piece[SETTLE:] for piece in drive_of(order)])[rows], rows, trajectory)

    model = white
    for _ in range(ROUNDS):
        drive, whole = drive_of(len(model.lags)), drawn_power(len(model.lags))
        trial = Whitener(rows, model.lags, model.sigma)
        left, seen = (
            band_power(trial(x), rows, trajectory) for x in (take_off(coloured(model, drive)), residual[:, None])
        )
        known = left > assumed.NOISE_LEFT * whole
        if not known.any():
            return white
        ratio = np.log(np.maximum(seen[known], 1e-9) / left[known])
        # Below the bands that the fit left something of, noise is as dense as in the lowest of them.
        lowest = np.maximum(frequency, centres[known][0])
        density = model.density(lowest, rate) * np.exp(np.interp(frequency, centres[known], ratio))
        density = np.minimum(density, most_of_noise(density, frequency))
        model = of_density(density, rate, highest, len(rows), radius)
    return Whitener(whitenable(usable, trajectory, len(model.lags)), model.lags, model.sigma)


def drives(trajectory: np.ndarray) -> Callable[[int], list[np.ndarray]]:
    """Return the function order of a model -> what its noise is made of, drawn once; see :func:`drawn`.

    Parameters
    ----------
    trajectory : (m,) labels.
    """
    return cache(lambda order: drawn(trajectory, DRAWS, np.random.default_rng(np.random.SeedSequence([8, order]))))


def most_of_noise(density: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Return the most (k,) that a density (k,) at frequencies (k,) [Hz] may be if it is a sensor's, infinite but slow.

    It has at most the power of flicker noise, which rises as the frequency falls, down to where noise forgets: 13 times
    that of the quick band. What pushes an arm slowly and at all times, wind above all, 50 to 1,300 times, is left to
    the tests for structure.
    """
    most = np.full(len(frequency), np.inf)
    low, high = quick_band()
    if frequency[-1] >= high:
        quick = (frequency >= low) & (frequency <= high)
        flicker = 1.0 / np.hypot(1.0, 2.0 * np.pi * frequency[quick] * assumed.longest_memory())
        most[frequency < assumed.slow()] = float(np.exp(np.mean(np.log(density[quick] / flicker))))
    return most


def quick_band() -> tuple[float, float]:
    """Return the ends [Hz] of the octave whose power is of noise that has nothing to do with what is slow.

    It begins an octave above what is slow.
    """
    return assumed.OCTAVE * assumed.slow(), assumed.OCTAVE**2 * assumed.slow()


def reddest_noise(density: np.ndarray, frequency: np.ndarray, rate: float) -> np.ndarray:
    """Return the density (k,) of noise that forgets as slowly as any and is as dense in the quick band as `density`."""
    shape = 1.0 / np.abs(1.0 - slowest_pole(rate) * np.exp(-2j * np.pi * frequency / rate)) ** 2
    high = min(quick_band()[1], frequency[-1])
    quick = (frequency >= high / assumed.OCTAVE) & (frequency <= high)
    return shape * float(np.exp(np.mean(np.log(density[quick] / shape[quick]))))


def slowest_pole(rate: float) -> float:
    """Return the coefficient of noise that forgets to 37 % within `assumed.longest_memory`."""
    return float(np.exp(-1.0 / (rate * assumed.longest_memory())))


def without_slow_torque(
    whites: Sequence[Whitener | None], usable: np.ndarray, trajectory: np.ndarray, rate: float
) -> list[Whitener | None]:
    """Return noise models of the axes (None where not judged) in which none is slower than a sensor's.

    They stay as they are where most axes are slow: that is what the model of the arm lacks, and no outside torque.

    Parameters
    ----------
    usable : (N, n) samples that are judged. trajectory : (N,) labels. rate : [Hz].
    """
    frequency = np.linspace(0.0, 0.5 * rate, POINTS + 1)
    densities = {axis: w.density(frequency, rate) for axis, w in enumerate(whites) if w is not None}
    limited = {axis: np.minimum(d, most_of_noise(d, frequency)) for axis, d in densities.items()}
    slow = [axis for axis, density in densities.items() if np.any(limited[axis] < density)]
    result = list(whites)
    if 2 * len(slow) > len(densities):
        return result
    radius = slowest_pole(rate)
    for axis in slow:
        highest = highest_order(usable[:, axis], trajectory)
        model = of_density(limited[axis], rate, highest, len(whites[axis].rows), radius)
        rows = whitenable(usable[:, axis], trajectory, len(model.lags))
        result[axis] = replace(whites[axis], rows=rows, lags=model.lags, sigma=model.sigma)
    return result


def _by_lags(
    white: Whitener,
    take_off: Callable[[np.ndarray], np.ndarray],
    drive_of: Callable[[int], list[np.ndarray]],
    rate: float,
) -> Whitener:
    """Return the model whose drawn noise has, after the fit, the coefficients and the variance of `white`."""
    radius = slowest_pole(rate)
    order, rows = len(white.lags), white.rows
    wanted = np.array([*white.lags, np.log(white.sigma)])
    trial = wanted.copy()
    for step in range(ROUNDS_OF_LAGS):
        model = Whitener(rows, stable(trial[:-1], radius), float(np.exp(trial[-1])))
        left = take_off(coloured(model, drive_of(order)))
        fits = [regress(left[:, k], rows, order) for k in range(left.shape[1])]
        came_out = np.mean([[*lags, 0.5 * np.log(variance)] for lags, variance in fits], axis=0)
        trial = np.array([*model.lags, trial[-1]]) + (wanted - came_out) * (1.0 if step == 0 else DAMPED)
    return Whitener(rows, stable(trial[:-1], radius), float(np.exp(trial[-1])))


def band_power(white: np.ndarray, rows: np.ndarray, trajectory: np.ndarray) -> np.ndarray:
    """Return the power (b,) of whitened series (m, k), on their time grid, in the bands of :data:`EDGES`.

    It is the mean over series and records, none of which counts as more than `assumed.FULLEST_RECORD` medians.
    """
    found = []
    for low, high in pairwise([0, *(np.flatnonzero(np.diff(trajectory)) + 1), len(trajectory)]):
        first, last = np.searchsorted(rows, [low, high])
        if last - first < FEWEST_OF_RECORD:
            continue
        series = np.zeros((high - low, white.shape[1]))
        series[rows[first:last] - low] = white[first:last]
        spectrum = np.fft.rfft(series, axis=0)
        power = np.mean(spectrum.real**2 + spectrum.imag**2, axis=1)[1:] / (last - first)
        centre = (np.arange(len(power)) + 0.5) * CELLS / len(power)
        found.append(np.interp(np.arange(CELLS) + 0.5, centre, _smooth(power, len(power) // CELLS)))
    if not found:
        return np.ones(len(EDGES) - 1)
    bands = np.add.reduceat(found, EDGES[:-1], axis=1) / np.diff(EDGES)
    return np.minimum(bands, assumed.FULLEST_RECORD * np.median(bands, axis=0)).mean(axis=0)


def band_freedom(rows: np.ndarray, trajectory: np.ndarray) -> np.ndarray:
    """Return the degrees of freedom (b,) of the power in the bands of :data:`EDGES`, as of :func:`band_power`."""
    edges = [0, *(np.flatnonzero(np.diff(trajectory)) + 1), len(trajectory)]
    counts = np.array([np.diff(np.searchsorted(rows, pair))[0] for pair in pairwise(edges)])
    return np.diff(EDGES) * counts[counts >= FEWEST_OF_RECORD].sum() / CELLS


def steadied(values: np.ndarray, variance: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return the mean (b,) of a random walk with steps of variance `steps` (b - 1,), seen as `values` of `variance`."""
    precision = np.diag(1.0 / variance)
    for i, step in enumerate(steps):
        precision[i : i + 2, i : i + 2] += np.array([[1.0, -1.0], [-1.0, 1.0]]) / step
    return np.linalg.solve(precision, values / variance)


def _smooth(power: np.ndarray, width: int) -> np.ndarray:
    """Return the mean of `width` neighbouring cells of a spectrum around each."""
    if width < 2:
        return power
    beyond = width // 2
    padded = np.concatenate([np.full(beyond, power[0]), power, np.full(beyond, power[-1])])
    return np.convolve(padded, np.full(width, 1.0 / width), mode="same")[beyond : beyond + len(power)]


def of_density(
    density: np.ndarray, rate: float, highest: int, count: int, radius: float, price: float | None = None
) -> Whitener:
    """Return the autoregressive model, without rows, of a density (k,) [(N m)^2/Hz] from 0 to half the rate.

    The order, up to `highest`, is that of the least information criterion of `count` samples, in which a coefficient
    costs `price`, by default that of the Bayesian one; no pole lies beyond `radius`.
    """
    covariance = np.fft.irfft(density)[: highest + 1] * rate / 2
    lags, variance = np.zeros(0), float(covariance[0])
    price = np.log(max(count, 2)) if price is None else price
    best = (np.inf, lags, variance)
    for order in range(highest + 1):
        if order:
            # Levinson and Durbin.
            last = (covariance[order] - lags @ covariance[order - 1 : 0 : -1]) / variance
            lags = np.append(lags - last * lags[::-1], last)
            variance *= 1.0 - last**2
        score = count * np.log(variance) + (order + 1) * price
        if score < best[0] - 2.0:
            best = (score, lags, variance)
    return Whitener(np.zeros(0, dtype=int), stable(best[1], radius), float(np.sqrt(best[2])))
