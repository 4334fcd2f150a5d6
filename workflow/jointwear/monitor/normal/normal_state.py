"""The normal state of one axis: Bayesian regression of the log of a friction level on the conditions of operation.

    y = X b + u_shift + e,   b ~ N(m, S),   u_shift ~ N(0, tau^2),   e ~ N(0, variance of the window)

X holds a constant, temperature (or a warm-up state) and its square, the operating features, and their product with
temperature; :mod:`.conditions` makes it. Windows and whole shifts count with Student-t weights, so that an odd hour or
day of the baseline does not rule it. The prior is a statement on joints at large; where the baseline shows little the
posterior stays wide, and a window beyond what the baseline showed is predicted with a large variance.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
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

    def given(self, columns: Sequence[int]) -> Posterior:
        """Return what is not known of the coefficients once those of `columns` are: the covariance is less."""
        some = list(columns)
        if not some:
            return self
        shown = self.covariance[:, some]
        rest = self.covariance - shown @ np.linalg.solve(shown[some], shown.T)
        return Posterior(self.mean, 0.5 * (rest + rest.T))


@dataclass(frozen=True)
class NormalFit:
    """A posterior and what it says of windows that it did not see.

    `left_out` (w,): value less the prediction from all *other* shifts; `left_out_variance` (w,): of that prediction;
    `mean_variance` (w,): of the mean of the predictions of all windows of its shift, each by what it tells: windows at
    other temperatures or programs err apart. NaN where a window took no part. `shifts` (s,): labels of those that took
    part.
    """

    posterior: Posterior
    left_out: np.ndarray
    left_out_variance: np.ndarray
    mean_variance: np.ndarray
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
    return fit_normal_states([Windows(design, value, noise, prior)], shift)[0]


@dataclass(frozen=True)
class Windows:
    """Windows of one axis, arguments of :func:`fit_normal_state`."""

    design: np.ndarray
    value: np.ndarray
    noise: Noise
    prior: Posterior

    @property
    def used(self) -> np.ndarray:
        """The windows (w,) that take part."""
        return np.isfinite(self.value) & np.isfinite(self.design).all(axis=1) & np.isfinite(self.noise.within)


def fit_normal_states(axes: Sequence[Windows], shift: np.ndarray) -> list[NormalFit]:
    """Return :func:`fit_normal_state` of several axes; those with the same windows and as many columns go side by side.

    Parameters
    ----------
    shift : (w,) labels, rising.
    """
    alike: dict[tuple, list[int]] = {}
    used = [axis.used for axis in axes]
    for k, axis in enumerate(axes):
        alike.setdefault((used[k].tobytes(), axis.design.shape[1]), []).append(k)
    found: dict[int, NormalFit] = {}
    for places in alike.values():
        found |= zip(places, _fitted([axes[k] for k in places], used[places[0]], shift), strict=True)
    return [found[k] for k in range(len(axes))]


def _fitted(axes: Sequence[Windows], used: np.ndarray, shift: np.ndarray) -> list[NormalFit]:
    """Return the fits of g axes with p columns each, of which the windows `used` (w,) take part."""
    left, left_variance, mean_variance = (np.full((len(axes), len(used)), np.nan) for _ in range(3))
    if not used.any():
        nothing = np.zeros(0, dtype=int)
        rows = zip(left, left_variance, mean_variance, strict=True)
        return [NormalFit(a.prior, *row, nothing) for a, row in zip(axes, rows, strict=True)]
    x, y = np.stack([a.design[used] for a in axes]), np.stack([a.value[used] for a in axes])
    # Neighbouring windows that remember each other tell less than as many independent ones.
    variance = np.stack([a.noise.within[used] * (1 + a.noise.memory) / (1 - a.noise.memory) for a in axes])
    usual = np.array([[a.noise.between] for a in axes])
    names, place = np.unique(shift[used], return_inverse=True)
    precision0 = np.linalg.inv(np.stack([a.prior.covariance for a in axes]))
    expected = _times(precision0, np.stack([a.prior.mean for a in axes]))
    window_weight, shift_weight = np.ones(y.shape), np.ones((len(axes), len(names)))
    # Shifts are runs of windows, so that sums over them are sums between their first windows.
    first = np.flatnonzero(np.concatenate([[True], np.diff(place) != 0]))

    def sums(values: np.ndarray) -> np.ndarray:
        return np.add.reduceat(values, first, axis=1)

    for turn in range(ROUNDS):
        between = usual / shift_weight
        weight = window_weight / variance
        weighted = weight[..., None] * x
        total, wx, wy = sums(weight), sums(weighted), sums(weight * y)
        share = between / (1 + between * total)
        precision = precision0 + _turned(weighted) @ x - _turned(share[..., None] * wx) @ wx
        information = expected + _times(_turned(weighted), y) - _times(_turned(wx), share * wy)
        covariance = _inverse(precision)
        mean = _times(covariance, information)
        if turn == ROUNDS - 1:
            break
        error = y - _times(x, mean)
        pulled = sums(weight * error)
        inner = error - (between * pulled / (1 + between * total))[:, place]
        window_weight = (FREEDOM + 1) / (FREEDOM + inner**2 / variance)
        size = (pulled / total) ** 2 / (usual + 1 / total)
        shift_weight = (FREEDOM + 1) / (FREEDOM + size)
    # What each shift told, to be taken away from the whole.
    runs = [slice(a, b) for a, b in itertools.pairwise([*first, y.shape[1]])]
    grams = np.stack([_turned(weighted[:, run]) @ x[:, run] for run in runs], axis=1)
    grams -= share[..., None, None] * wx[..., :, None] * wx[..., None, :]
    moments = sums(weighted * y[..., None]) - (share * wy)[..., None] * wx
    left_covariance = _inverse(precision[:, None] - grams)
    left_mean = _times(left_covariance, information[:, None] - moments)
    left[:, used] = y - (x * left_mean[:, place]).sum(axis=2)
    spread = [(x[:, run] @ left_covariance[:, k]) * x[:, run] for k, run in enumerate(runs)]
    left_variance[:, used] = np.concatenate(spread, axis=1).sum(axis=2)
    middle = sums(x / variance[..., None]) / sums(1 / variance)[..., None]
    of_means = np.einsum("gsp,gspq,gsq->gs", middle, left_covariance, middle)
    mean_variance[:, used] = of_means[:, place]
    rows = zip(left, left_variance, mean_variance, strict=True)
    told = zip(mean, covariance, strict=True)
    return [NormalFit(Posterior(*one), *row, names) for one, row in zip(told, rows, strict=True)]


def _turned(matrices: np.ndarray) -> np.ndarray:
    """Return the transposes of matrices (..., a, b)."""
    return np.swapaxes(matrices, -1, -2)


def _times(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return matrices (..., a, b) times vectors (..., b), (..., a)."""
    return (matrices @ vectors[..., None])[..., 0]


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
    return 0.5 * (inverse + _turned(inverse))
