"""The normal state of one axis: Bayesian regression of the log of a friction level on the conditions of operation.

    y = X b + u_shift + e,   b ~ N(m, S),   u_shift ~ N(0, tau^2),   e ~ N(0, variance of the window)

X holds a constant, temperature (or a warm-up state) and its square, the operating features, and their product with
temperature; :mod:`.conditions` makes it. Windows and whole shifts count with Student-t weights, so that an odd hour or
day of the baseline does not rule it. The prior is a statement on joints at large; where the baseline shows little the
posterior stays wide, and a window beyond what the baseline showed is predicted with a large variance.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

#: Degrees of freedom of the weights, and rounds of reweighting.
FREEDOM, ROUNDS = 4.0, 4


@dataclass(frozen=True)
class Posterior:
    """Normal law of the coefficients: `mean` (p,), `covariance` (p, p)."""

    mean: np.ndarray
    covariance: np.ndarray

    def predict(self, design: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the expected value (w,) of designs (w, p) and its variance (w,), noise of the window not included."""
        return design @ self.mean, ((design @ self.covariance) * design).sum(axis=1)


@dataclass(frozen=True)
class NormalFit:
    """A posterior and what it says of windows that it did not see.

    `left_out` (w,): value less the prediction from all *other* shifts; `left_out_variance` (w,): of that prediction.
    NaN where a window took no part. `shifts` (s,): labels of those that took part.
    """

    posterior: Posterior
    left_out: np.ndarray
    left_out_variance: np.ndarray
    shifts: np.ndarray


@dataclass(frozen=True)
class Noise:
    """`within` (w,) variance of windows; `memory` their lag-1 correlation in a shift; `between` tau^2."""

    within: np.ndarray
    memory: float
    between: float


def fit_normal_state(
    design: np.ndarray, value: np.ndarray, noise: Noise, shift: np.ndarray, prior: Posterior
) -> NormalFit:
    """Fit windows (w,), those that are not finite left out.

    Parameters
    ----------
    design : (w, p). value : (w,) log levels. noise : of the windows. shift : (w,) labels, rising.
    prior : of the coefficients.
    """
    used = np.isfinite(value) & np.isfinite(design).all(axis=1) & np.isfinite(noise.within)
    x, y, label = design[used], value[used], shift[used]
    left, left_variance = np.full(len(value), np.nan), np.full(len(value), np.nan)
    if not used.any():
        return NormalFit(prior, left, left_variance, np.zeros(0, dtype=int))
    # Neighbouring windows that remember each other tell less than as many independent ones.
    variance = noise.within[used] * (1 + noise.memory) / (1 - noise.memory)
    names, place = np.unique(label, return_inverse=True)
    precision0 = np.linalg.inv(prior.covariance)
    window_weight, shift_weight = np.ones(len(y)), np.ones(len(names))
    # Shifts are runs of windows, so that sums over them are sums between their first windows.
    first = np.flatnonzero(np.concatenate([[True], np.diff(place) != 0]))

    def sums(values: np.ndarray) -> np.ndarray:
        return np.add.reduceat(values, first, axis=0)

    for turn in range(ROUNDS):
        between = noise.between / shift_weight
        weight = window_weight / variance
        weighted = weight[:, None] * x
        total, wx, wy = sums(weight), sums(weighted), sums(weight * y)
        share = between / (1 + between * total)
        precision = precision0 + weighted.T @ x - (share[:, None] * wx).T @ wx
        information = precision0 @ prior.mean + weighted.T @ y - (share * wy) @ wx
        covariance = _inverse(precision)
        mean = covariance @ information
        if turn == ROUNDS - 1:
            break
        error = y - x @ mean
        pulled = sums(weight * error)
        inner = error - (between * pulled / (1 + between * total))[place]
        window_weight = (FREEDOM + 1) / (FREEDOM + inner**2 / variance)
        size = (pulled / total) ** 2 / (noise.between + 1 / total)
        shift_weight = (FREEDOM + 1) / (FREEDOM + size)
    # What each shift told, to be taken away from the whole.
    runs = [slice(a, b) for a, b in itertools.pairwise([*first, len(y)])]
    grams = np.stack([weighted[run].T @ x[run] for run in runs])
    grams -= share[:, None, None] * wx[:, :, None] * wx[:, None, :]
    moments = sums(weighted * y[:, None]) - (share * wy)[:, None] * wx
    left_covariance = _inverse(precision - grams)
    left_mean = np.einsum("spq,sq->sp", left_covariance, information - moments)
    left[used] = y - np.einsum("wp,wp->w", x, left_mean[place])
    spread = [(x[run] @ shown) * x[run] for run, shown in zip(runs, left_covariance, strict=True)]
    left_variance[used] = np.concatenate(spread).sum(axis=1)
    return NormalFit(Posterior(mean, covariance), left, left_variance, names)


def introduced(
    posterior: Posterior, design: np.ndarray, value: np.ndarray, variance: np.ndarray, between: float
) -> Posterior:
    """Return the posterior after the first windows of a program whose constant is not known: its level is learnt too.

    Parameters
    ----------
    design : (w, p). value : (w,) log levels. variance : (w,) of the windows. between : variance that they share.
    """
    used = np.isfinite(value) & np.isfinite(design).all(axis=1) & np.isfinite(variance)
    if not used.any():
        return posterior
    x = design[used]
    spread = np.diag(variance[used]) + between
    gain = np.linalg.solve(x @ posterior.covariance @ x.T + spread, x @ posterior.covariance).T
    mean = posterior.mean + gain @ (value[used] - x @ posterior.mean)
    return Posterior(mean, posterior.covariance - gain @ x @ posterior.covariance)


def taught(posterior: Posterior, design: np.ndarray, value: np.ndarray, variance: np.ndarray) -> Posterior:
    """Return the posterior after a shift whose level is its own: only contrasts within the shift are learnt from.

    What changes between shifts, wear among it, does not enter: the weighted mean of the shift is free.

    Parameters
    ----------
    design : (w, p). value : (w,) log levels. variance : (w,) of the windows, memory of neighbours included.
    """
    used = np.isfinite(value) & np.isfinite(design).all(axis=1) & np.isfinite(variance)
    if used.sum() < 2:
        return posterior
    x, y, v = design[used], value[used], variance[used]
    expected, spread = posterior.predict(x)
    error, spread = y - expected, spread + v
    error -= (error / spread).sum() / (1 / spread).sum()
    weight = (FREEDOM + 1) / (FREEDOM + error**2 / spread) / v
    share = weight / weight.sum()
    x, y = x - share @ x, y - share @ y
    # A shift has fewer windows than the normal state has coefficients: the smaller system is solved.
    shown = x @ posterior.covariance
    inner = shown @ x.T
    inner.flat[:: len(inner) + 1] += 1 / weight
    gain = np.linalg.solve(inner, shown).T
    covariance = posterior.covariance - gain @ shown
    return Posterior(posterior.mean + gain @ (y - x @ posterior.mean), 0.5 * (covariance + covariance.T))


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverses of symmetric matrices (..., p, p)."""
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    scale = 1.0 / np.sqrt(np.maximum(diagonal, 1e-300))
    outer = scale[..., :, None] * scale[..., None, :]
    inverse = np.linalg.inv(matrix * outer) * outer
    return 0.5 * (inverse + np.swapaxes(inverse, -1, -2))
