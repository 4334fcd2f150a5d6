"""What the residuals of all other axes have in common at one time: a wrong temperature, weather, oil, a wrong unit.

Wear takes one axis; what moves most of them at once is none. For each axis the common part of the others is estimated
with a heavy tail, so that one worn axis among them does not enter it, shrunk towards zero as far as it may be chance,
multiplied with the slope of this axis, and subtracted together with its variance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.reading.after_baseline import before_baseline
from jointwear.statistics.known import OVER_MEDIAN, known_median

#: Degrees of freedom of the location, and rounds of reweighting.
FREEDOM, ROUNDS = 3.0, 12
#: A priori the common part is usually small (what the baseline shows) and sometimes, with this chance, of this size.
RARE, WIDE = 0.05, 0.08
#: The same of what is rarer still: a hall that is not heated doubles friction.
RAREST, WIDEST = 0.01, 0.4
#: Smallest usual size.
LEAST = 0.0005
#: A priori slope of an axis over the common part of the others, and its standard deviation.
SLOPE, SLOPE_SPREAD = 1.0, 0.35
#: What moves all axes (oil, weather) moves viscous friction so many times as much, in percent of itself, as Coulomb
#: friction: nearly all of what temperature does to friction is viscous (Bittencourt and Gunnarsson 2012).
VISCOUS_TIMES = 2.0
#: Common part above which all axes together are a finding of its own.
FINDING = 0.03
#: Fewest other axes.
FEWEST_OTHERS = 3


@dataclass(frozen=True)
class SharedError:
    """`value` (w, n): what to subtract from the residual of each axis; `variance` (w, n); `common` (w,) of all axes,
    in units of them; `known` (w, n): bool, whether enough other axes are judged to tell."""

    value: np.ndarray
    variance: np.ndarray
    common: np.ndarray
    known: np.ndarray

    def until(self, stop: int) -> SharedError:
        """Return it of the windows before `stop`."""
        return SharedError(self.value[:stop], self.variance[:stop], self.common[:stop], self.known[:stop])


def shared_error(
    residual: np.ndarray,
    variance: np.ndarray,
    baseline: np.ndarray,
    shift: np.ndarray,
    alike: np.ndarray | None = None,
    unit: np.ndarray | float = 1.0,
) -> SharedError:
    """Estimate the shared error.

    Parameters
    ----------
    residual : (w, n) log levels less the normal state (left out in the baseline), NaN where unknown.
    variance : (w, n) of the residual, prediction, shift and window together. baseline : (w,) bool.
    shift : (w,) labels; the slope in a shift rests on the steps between the shifts before it.
    alike : (w, n) part of `variance`, of leaving the baseline's range, that the axes have in common. None: none.
    unit : (n,) residual of each axis for one unit of what all have in common.
    """
    w, n = residual.shape
    alike = np.zeros((w, n)) if alike is None else np.nan_to_num(alike) / np.square(unit)
    residual, variance = residual / unit, variance / np.square(unit) - alike
    value, spread, known = np.zeros((w, n)), np.zeros((w, n)), np.zeros((w, n), dtype=bool)
    told = np.where(before_baseline(baseline)[:, None], np.nan, residual)
    for j in range(n):
        others = [i for i in range(n) if i != j]
        location, error = _location(residual[:, others], variance[:, others])
        known[:, j] = np.isfinite(error)
        usual = _usual(location[baseline], error[baseline])
        common, left = _shrunk(location, error, usual + np.median(alike, axis=1))
        left = np.where(known[:, j], left, np.maximum(left, alike[:, j]))
        slope, slope_variance = _slopes(told[:, j], common, variance[:, j], shift)
        value[:, j] = slope * common
        spread[:, j] = slope**2 * left + slope_variance * common**2
    location, error = _location(residual, variance)
    usual = _usual(location[baseline], error[baseline])
    common = _shrunk(location, error, usual + np.median(alike, axis=1))[0]
    return SharedError(unit * value, np.square(unit) * spread, common, known)


def units_of_levels(coulomb: np.ndarray, alone: np.ndarray) -> np.ndarray:
    """Return what all axes have in common comes to in the level of each (n,), over the usual axis.

    Parameters
    ----------
    coulomb : (n,) share of Coulomb friction in the friction of each axis. alone : (n,) bool, whether the level is that
    of Coulomb friction: it takes what viscous friction, held at its value in the baseline, does, over a smaller level.
    """
    unit = (coulomb + VISCOUS_TIMES * (1 - coulomb)) / np.where(alone, coulomb, 1.0)
    return unit / np.median(unit)


def _location(residual: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the heavy-tailed location (w,) of residuals (w, k) and its variance; infinite with too few."""
    good = np.isfinite(residual) & (variance > 0) & np.isfinite(variance)
    values = np.where(good, residual, 0.0)
    middle = np.nan_to_num(known_median(np.where(good, residual, np.nan), axis=1))
    weight = robust = np.zeros(residual.shape)
    for _ in range(ROUNDS):
        # Axes follow what they have in common each with its own slope: the larger it is, the further they lie apart.
        size = np.where(good, variance, 1.0) + (SLOPE_SPREAD * middle[:, None]) ** 2
        weight = np.where(good, 1.0 / size, 0.0)
        robust = weight * (FREEDOM + 1) / (FREEDOM + weight * (values - middle[:, None]) ** 2)
        total = robust.sum(axis=1)
        middle = np.divide((robust * values).sum(axis=1), total, out=np.zeros_like(total), where=total > 0)
    enough = good.sum(axis=1) >= FEWEST_OTHERS
    total = robust.sum(axis=1)
    scatter = np.divide((robust * weight * (values - middle[:, None]) ** 2).sum(axis=1), np.maximum(total, 1e-300))
    error = np.divide(np.maximum(1.0, scatter), np.maximum(total, 1e-300))
    # Where the axes fall into two camps, the larger one is not sure to be right.
    plain = np.divide((weight * values).sum(axis=1), np.maximum(weight.sum(axis=1), 1e-300))
    error = error + (plain - middle) ** 2
    return np.where(enough, middle, 0.0), np.where(enough, error, np.inf)


def _usual(location: np.ndarray, error: np.ndarray) -> float:
    known = np.isfinite(error)
    if known.sum() < 3:
        return LEAST**2
    size = (OVER_MEDIAN * float(np.median(np.abs(location[known])))) ** 2
    return max(size - float(np.median(error[known])), LEAST**2)


def _shrunk(location: np.ndarray, error: np.ndarray, usual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and variance of the common part under a usual (w,) and two rare, wide priors."""
    safe = np.where(np.isfinite(error), error, 1.0)
    means, variances, logs = [], [], []
    for prior, chance in ((usual, 1 - RARE - RAREST), (WIDE**2 + usual, RARE), (WIDEST**2 + usual, RAREST)):
        share = prior / (prior + safe)
        means.append(share * location)
        variances.append(share * safe)
        logs.append(np.log(chance) - 0.5 * np.log(prior + safe) - 0.5 * location**2 / (prior + safe))
    odds = np.exp(np.stack(logs) - np.max(logs, axis=0))
    odds /= odds.sum(axis=0)
    mean = (odds * np.stack(means)).sum(axis=0)
    square = (odds * (np.stack(variances) + np.stack(means) ** 2)).sum(axis=0)
    known = np.isfinite(error)
    # Where too few axes are judged to tell, something may be shared all the same; a robot of few axes never can tell.
    unknown = usual + RARE * WIDE**2 if known.any() else np.zeros(len(location))
    return np.where(known, mean, 0.0), np.where(known, square - mean**2, unknown)


def _slopes(
    own: np.ndarray, common: np.ndarray, variance: np.ndarray, shift: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the slope (w,) of one axis over the common part and its variance.

    Regressed on the steps between shifts, which slow wear hardly enters, heavy-tailed; each shift uses what was known
    before it.
    """
    names, place = np.unique(shift, return_inverse=True)
    good = np.isfinite(own) & (variance > 0)
    with np.errstate(all="ignore"):
        count = np.bincount(place, good, len(names))
        means = [np.bincount(place, np.where(good, x, 0.0), len(names)) / count for x in (own, common, variance)]
    precision, moment = 1 / SLOPE_SPREAD**2, SLOPE / SLOPE_SPREAD**2
    slopes, variances = np.full(len(names), SLOPE), np.full(len(names), SLOPE_SPREAD**2)
    before = -1
    for s in range(len(names)):
        slopes[s], variances[s] = moment / precision, 1 / precision
        if not count[s] > 0:
            continue
        if before >= 0:
            step, common_step = means[0][s] - means[0][before], means[1][s] - means[1][before]
            size = means[2][s] + means[2][before]
            error = step - slopes[s] * common_step
            weight = (FREEDOM + 1) / (FREEDOM + error**2 / size) / size
            precision += weight * common_step**2
            moment += weight * common_step * step
        before = s
    return slopes[place], variances[place]
