"""Learn the normal state of all axes of a robot from the windows of its baseline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.conditions import Conditions, Design, design_of
from jointwear.monitor.dispersion import (
    START,
    USUAL_NONE,
    USUAL_OWN,
    USUAL_SHARED,
    Dispersion,
    between_shifts,
    shift_means,
    within_shifts,
)
from jointwear.monitor.normal_state import NormalFit, Posterior, fit_normal_state
from jointwear.monitor.series import Series
from jointwear.monitor.warm_up import DRIVES, TIMES, warm_up_state
from jointwear.statistics.known import known_median

#: Rounds in which the regression and the dispersion around it are made to agree.
ROUNDS = 3
#: Fewest windows and shifts of the baseline of an axis.
FEWEST_WINDOWS, FEWEST_SHIFTS = 8, 3
#: Spread [K] of a logged temperature over the baseline below which it says nothing of warming.
SPREAD = 0.5


@dataclass(frozen=True)
class AxisNormal:
    """Normal state of one axis: `fit` of the baseline, `design` of all windows, `dispersion`; `source`: name of the
    series; `to_coulomb`: relative growth of Coulomb friction for one of the series."""

    source: str
    series_value: np.ndarray
    series_variance: np.ndarray
    design: Design
    fit: NormalFit
    dispersion: Dispersion
    to_coulomb: float
    unit: float

    @property
    def noise(self) -> np.ndarray:
        """Variance (w,) of the windows about the level of their shift."""
        return self.series_variance + self.dispersion.extra


def enough(value: np.ndarray, learnt: np.ndarray, shift: np.ndarray) -> bool:
    """Return whether the windows (w,) that are learnt from show an axis well enough."""
    rows = learnt & np.isfinite(value)
    return bool(rows.sum() >= FEWEST_WINDOWS and len(np.unique(shift[rows])) >= FEWEST_SHIFTS)


def learn_axes(
    series: Sequence[Series],
    names: Sequence[str],
    conditions: Conditions,
    learnt: np.ndarray,
    shift: np.ndarray,
) -> list[AxisNormal | None]:
    """Return the normal state of every axis, None where the baseline shows too little.

    Parameters
    ----------
    series, names : candidates for the level that is judged; the one whose left-out shifts scatter least, counted as
        growth of Coulomb friction, is taken. conditions : of all windows. learnt : (w, n) bool. shift : (w,).
    """
    n = learnt.shape[1]
    best: list[AxisNormal | None] | None = None
    lowest = np.inf
    for tau, power in _times(conditions, learnt):
        warm = None
        if tau is not None:
            drive = _relative(conditions.speed, learnt) ** power
            warm = warm_up_state(conditions.start, conditions.end, drive, tau)
        states: list[list[AxisNormal | None]] = []
        for one, name in zip(series, names, strict=True):
            states.append(_learn(one, name, conditions, learnt, shift, warm))
        chosen = [min((s[j] for s in states if s[j] is not None), key=_scatter, default=None) for j in range(n)]
        total = sum(np.log(_scatter(a)) for a in chosen if a is not None)
        if best is None or total < lowest:
            best, lowest = chosen, total
    return best or [None] * n


def _relative(speed: np.ndarray, learnt: np.ndarray) -> np.ndarray:
    """Return speeds (w, n) over the median of the windows that are learnt from; 1 where unknown."""
    with np.errstate(all="ignore"):
        usual = known_median(np.where(learnt, speed, np.nan), axis=0)
        return np.nan_to_num(speed / usual, nan=1.0, posinf=1.0)


def _times(conditions: Conditions, learnt: np.ndarray) -> list[tuple[float | None, float]]:
    """Warm-up times and powers of the speed that drives them; none where every axis logs a temperature that moves."""
    with np.errstate(all="ignore"):
        inside = np.where(learnt, conditions.temperature, np.nan)
        known = np.isfinite(inside).any(axis=0)
        span = np.where(known, np.nanmax(np.nan_to_num(inside, nan=-1e9), axis=0), 0) - np.where(
            known, np.nanmin(np.nan_to_num(inside, nan=1e9), axis=0), 0
        )
    own = known & (span > SPREAD)
    if own.all() and not conditions.shared:
        return [(None, 0.0)]
    return [(tau, power) for tau in TIMES for power in DRIVES]


def _learn(
    series: Series,
    name: str,
    conditions: Conditions,
    learnt: np.ndarray,
    shift: np.ndarray,
    warm: np.ndarray | None,
) -> list[AxisNormal | None]:
    n = learnt.shape[1]
    sensed = np.isfinite(np.where(learnt, conditions.temperature, np.nan)).any(axis=0)
    told = USUAL_SHARED if conditions.shared else USUAL_OWN
    usual = [told if sensed[j] else USUAL_NONE for j in range(n)]
    axes = [j for j in range(n) if enough(series.value[:, j], learnt[:, j], shift)]
    designs, fits = {}, {}
    dispersion = dict.fromkeys(axes, START)
    for j in axes:
        rows = learnt[:, j] & np.isfinite(series.value[:, j])
        own = np.isfinite(conditions.temperature[rows, j])
        use = warm[:, j] if warm is not None and (not own.any() or conditions.shared) else None
        designs[j] = design_of(conditions, j, rows, use)
    for _ in range(ROUNDS):
        means = {}
        for j in axes:
            value = np.where(learnt[:, j], series.value[:, j], np.nan)
            value = value - float(np.nanmedian(value))
            noise = dispersion[j].noise(series.variance[:, j])
            fits[j] = fit_normal_state(designs[j].matrix, value, noise, shift, designs[j].prior)
            extra, memory = within_shifts(fits[j].left_out, series.variance[:, j], shift)
            variance = series.variance[:, j] + extra
            means[j] = shift_means(fits[j].left_out, fits[j].left_out_variance, variance, shift, memory)
            dispersion[j] = Dispersion(extra, memory, dispersion[j].between, dispersion[j].spread)
        found = between_shifts([means[j] for j in axes], [usual[j] for j in axes])
        for j, (between, spread) in zip(axes, found, strict=True):
            dispersion[j] = Dispersion(dispersion[j].extra, dispersion[j].memory, between, spread)
    result: list[AxisNormal | None] = [None] * n
    for j in axes:
        value = np.where(learnt[:, j], series.value[:, j], np.nan)
        middle = float(np.nanmedian(value))
        fit = fit_normal_state(
            designs[j].matrix, value - middle, dispersion[j].noise(series.variance[:, j]), shift, designs[j].prior
        )
        result[j] = AxisNormal(
            name, series.value[:, j] - middle, series.variance[:, j], designs[j], fit, dispersion[j],
            1.0 / float(series.share[j]), float(series.unit[j] * np.exp(middle)),
        )  # fmt: skip
    return result


def _scatter(axis: AxisNormal) -> float:
    return axis.to_coulomb * float(np.nanmean(np.abs(axis.fit.left_out)))


def relearnt(axis: AxisNormal, learnt: np.ndarray, shift: np.ndarray, prior: Posterior) -> NormalFit:
    """Return the fit of windows `learnt` (w,) after a service, from a widened posterior."""
    value = np.where(learnt, axis.series_value, np.nan)
    return fit_normal_state(axis.design.matrix, value, axis.dispersion.noise(axis.series_variance), shift, prior)


#: After a service: standard deviation of the constant, and how far the other coefficients go back to their priors.
SERVICE_STEP, SERVICE_SHARE = 0.3, 0.15


def widened(axis: AxisNormal, posterior: Posterior) -> Posterior:
    """Return the posterior as a prior for what comes after a service: new grease, another level."""
    covariance = posterior.covariance + SERVICE_SHARE**2 * axis.design.prior.covariance
    covariance[0, 0] = posterior.covariance[0, 0] + SERVICE_STEP**2
    return Posterior(posterior.mean, covariance)
