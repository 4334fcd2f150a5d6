"""Learn the normal state of all axes of a robot from the windows of its baseline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.conditions import Conditions, Design, design_of
from jointwear.monitor.normal.dispersion import (
    START,
    USUAL_NONE,
    USUAL_OWN,
    USUAL_SHARED,
    Dispersion,
    between_shifts,
    shift_means,
    within_shifts,
)
from jointwear.monitor.normal.normal_state import NormalFit, Posterior, Windows, fit_normal_state, fit_normal_states
from jointwear.monitor.normal.recall import Recall, Rows, key_of
from jointwear.monitor.normal.series import Series
from jointwear.monitor.normal.shifts import FEWEST_SHIFTS
from jointwear.monitor.normal.warm_up import DRIVES, TIMES, warm_up_state
from jointwear.statistics.known import known_median

#: Rounds in which the regression and the dispersion around it are made to agree.
ROUNDS = 3
#: Fewest windows of the baseline of an axis.
FEWEST_WINDOWS = 8
#: Spread [K] of a logged temperature over the baseline below which it says nothing of warming.
SPREAD = 0.5


@dataclass(frozen=True)
class AxisNormal:
    """Normal state of one axis: `fit` of the baseline, `design` of all windows, `dispersion`; `source`: name of the
    series; `to_coulomb`: relative growth of Coulomb friction for one of the series; `of_viscous`: relative growth of
    the level while viscous friction grows by as much as all friction of the baseline; `missed`: standard deviation by
    which left-out shifts of the baseline miss the prediction of the program that is told worst, :mod:`.missed`."""

    source: str
    series_value: np.ndarray
    series_variance: np.ndarray
    design: Design
    fit: NormalFit
    dispersion: Dispersion
    to_coulomb: float
    unit: float
    of_viscous: float
    missed: float = 0.0

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
    recall: Recall | None = None,
) -> list[AxisNormal | None]:
    """Return the normal state of every axis, None where the baseline shows too little.

    Parameters
    ----------
    series, names : candidates for the level that is judged; the one whose left-out shifts scatter least, counted as
        growth of Coulomb friction, is taken. conditions : of all windows. learnt : (w, n) bool. shift : (w,).
    recall : of what was chosen before.
    """
    # What is learnt rests on the windows up to the end of the baseline, so that nothing later can change it.
    rows = np.flatnonzero(learnt.any(axis=1))
    if not len(rows):
        return [None] * learnt.shape[1]
    until = int(rows[-1]) + 1
    conditions = conditions.telling(learnt)
    early = conditions.until(until)
    shared = early.shared
    parts = [Series(s.value[:until], s.variance[:until], s.unit, s.share) for s in series]
    recall = recall or Recall()
    key = key_of(
        "learnt", *(x for s in parts for x in (s.value, s.variance, s.share)), early.start, early.end,
        early.temperature, early.features, early.speed, early.load, early.regime, early.named, shared,
        learnt[:until], shift[:until],
    )  # fmt: skip
    rows_of = recall(key, lambda: _choose(parts, early, shared, learnt[:until], shift[:until]))
    chosen = [_Chosen.of(row) for row in rows_of]
    warm: dict[tuple[float, float], np.ndarray] = {}
    result: list[AxisNormal | None] = []
    for j, choice in enumerate(chosen):
        if choice is None:
            result.append(None)
            continue
        if choice.tau is not None and (choice.tau, choice.power) not in warm:
            warm[choice.tau, choice.power] = _warm(conditions, learnt, choice.tau, choice.power)
        own = None if choice.tau is None else warm[choice.tau, choice.power]
        one, name = series[choice.series], names[choice.series]
        design = _design(one, conditions, shared, learnt, own, j)
        value, middle = _centred(one, learnt, j)
        fit = _fit(design, value, choice.dispersion, one.variance[:, j], shift)
        to_coulomb, unit = 1.0 / float(one.share[j]), float(one.unit[j] * np.exp(middle))
        level, spread = one.value[:, j] - middle, one.variance[:, j]
        of_viscous = 0.0 if one.added is None else float(one.added[j]) / unit
        result.append(AxisNormal(name, level, spread, design, fit, choice.dispersion, to_coulomb, unit, of_viscous))
    return result


@dataclass(frozen=True)
class _Chosen:
    """How an axis is learnt: place of the series, `dispersion`, warm-up time [h] or None, and power of its drive."""

    series: int
    dispersion: Dispersion
    tau: float | None
    power: float

    @property
    def row(self) -> list[float | None]:
        """The choice as a row of values."""
        d = self.dispersion
        values = (self.series, d.extra, d.memory, d.between, d.spread, self.tau, self.power)
        return [None if x is None else float(x) for x in values]

    @classmethod
    def of(cls, row: list[float | None]) -> _Chosen | None:
        """Return what :attr:`row` said; None of an empty row."""
        return cls(int(row[0]), Dispersion(*row[1:5]), row[5], row[6]) if row else None


def _choose(
    series: Sequence[Series], conditions: Conditions, shared: bool, learnt: np.ndarray, shift: np.ndarray
) -> Rows:
    """Return how each axis is learnt (:class:`_Chosen`), an empty row where the baseline shows too little.

    Parameters
    ----------
    series, conditions, learnt, shift : of :func:`learn_axes`, up to the end of the baseline.
    shared : whether all axes have the same temperature.
    """
    n = learnt.shape[1]
    best: Rows | None = None
    lowest = np.inf
    for tau, power in _times(conditions, shared, learnt):
        warm = None if tau is None else _warm(conditions, learnt, tau, power)
        designs: dict[tuple[int, bytes], Design] = {}
        states = [_learn(one, conditions, shared, learnt, shift, warm, designs) for one in series]
        rows: Rows = []
        total = 0.0
        for j in range(n):
            found = [(states[k][j][1], k) for k in range(len(series)) if states[k][j] is not None]
            if not found:
                rows.append([])
                continue
            scatter, k = min(found)
            rows.append(_Chosen(k, states[k][j][0], tau, power).row)
            total += np.log(scatter)
        if best is None or total < lowest:
            best, lowest = rows, total
    return best or [[] for _ in range(n)]


def _warm(conditions: Conditions, learnt: np.ndarray, tau: float, power: float) -> np.ndarray:
    """Return the warm-up state (w, n) of a time [h] and a power of the speed."""
    drive = _relative(conditions.speed, learnt) ** power
    return warm_up_state(conditions.start, conditions.end, drive, tau)


def _relative(speed: np.ndarray, learnt: np.ndarray) -> np.ndarray:
    """Return speeds (w, n) over the median of the windows that are learnt from; 1 where unknown."""
    with np.errstate(all="ignore"):
        usual = known_median(np.where(learnt, speed, np.nan), axis=0)
        return np.nan_to_num(speed / usual, nan=1.0, posinf=1.0)


def _times(conditions: Conditions, shared: bool, learnt: np.ndarray) -> list[tuple[float | None, float]]:
    """Warm-up times and powers of the speed that drives them; none where every axis logs a temperature that moves."""
    with np.errstate(all="ignore"):
        inside = np.where(learnt, conditions.temperature, np.nan)
        known = np.isfinite(inside).any(axis=0)
        span = np.where(known, np.nanmax(np.nan_to_num(inside, nan=-1e9), axis=0), 0) - np.where(
            known, np.nanmin(np.nan_to_num(inside, nan=1e9), axis=0), 0
        )
    own = known & (span > SPREAD)
    if own.all() and not shared:
        return [(None, 0.0)]
    return [(tau, power) for tau in TIMES for power in DRIVES]


def _design(
    series: Series, conditions: Conditions, shared: bool, learnt: np.ndarray, warm: np.ndarray | None, j: int
) -> Design:
    """Return the design of axis `j`; the warm-up state `warm` (w, n) enters where it logs no temperature of its own."""
    rows = learnt[:, j] & np.isfinite(series.value[:, j])
    own = np.isfinite(conditions.temperature[rows, j])
    use = warm[:, j] if warm is not None and (not own.any() or shared) else None
    return design_of(conditions, j, rows, use)


def _centred(series: Series, learnt: np.ndarray, j: int) -> tuple[np.ndarray, float]:
    """Return the values (w,) of axis `j` that are learnt from, NaN elsewhere, less their median, and it."""
    value = np.where(learnt[:, j], series.value[:, j], np.nan)
    middle = float(np.nanmedian(value))
    return value - middle, middle


def _learn(
    series: Series,
    conditions: Conditions,
    shared: bool,
    learnt: np.ndarray,
    shift: np.ndarray,
    warm: np.ndarray | None,
    known: dict[tuple[int, bytes], Design],
) -> list[tuple[Dispersion, float] | None]:
    """Return for each axis the dispersion, and the scatter of left-out shifts in growth of Coulomb friction.

    Parameters
    ----------
    known : axis and windows that show a series -> design under these conditions; filled as they are worked out.
    """
    n = learnt.shape[1]
    sensed = np.isfinite(np.where(learnt, conditions.temperature, np.nan)).any(axis=0)
    told = USUAL_SHARED if shared else USUAL_OWN
    usual = [told if sensed[j] else USUAL_NONE for j in range(n)]
    axes = [j for j in range(n) if enough(series.value[:, j], learnt[:, j], shift)]
    designs, values = {}, {}
    for j in axes:
        key = j, np.isfinite(series.value[:, j]).tobytes()
        if key not in known:
            known[key] = _design(series, conditions, shared, learnt, warm, j)
        designs[j] = known[key]
        values[j], _ = _centred(series, learnt, j)
    dispersion = dict.fromkeys(axes, START)

    def fitted() -> dict[int, NormalFit]:
        windows = [
            Windows(designs[j].matrix, values[j], dispersion[j].noise(series.variance[:, j]), designs[j].prior)
            for j in axes
        ]
        return dict(zip(axes, fit_normal_states(windows, shift), strict=True))

    for _ in range(ROUNDS):
        means = {}
        for j, fit in fitted().items():
            extra, memory = within_shifts(fit.left_out, series.variance[:, j], shift)
            variance = series.variance[:, j] + extra
            means[j] = shift_means(fit.left_out, fit.mean_variance, variance, shift, memory)
            dispersion[j] = Dispersion(extra, memory, dispersion[j].between, dispersion[j].spread)
        found = between_shifts([means[j] for j in axes], [usual[j] for j in axes])
        for j, (between, spread) in zip(axes, found, strict=True):
            dispersion[j] = Dispersion(dispersion[j].extra, dispersion[j].memory, between, spread)
    result: list[tuple[Dispersion, float] | None] = [None] * n
    for j, fit in fitted().items():
        scatter = 1.0 / float(series.share[j]) * float(np.nanmean(np.abs(fit.left_out)))
        result[j] = dispersion[j], scatter
    return result


def _fit(
    design: Design, value: np.ndarray, dispersion: Dispersion, variance: np.ndarray, shift: np.ndarray
) -> NormalFit:
    return fit_normal_state(design.matrix, value, dispersion.noise(variance), shift, design.prior)


def relearnt(
    axis: AxisNormal,
    learnt: np.ndarray,
    shift: np.ndarray,
    prior: Posterior,
    besides: tuple[np.ndarray | float, float] = (0.0, 0.0),
) -> Posterior:
    """Return what windows `learnt` (w,) after an event teach, from a widened posterior.

    `besides` : what they show besides the level of the axis (log level), of all or (w,) of each, and its variance.
    """
    more, doubt = besides
    value = np.where(learnt, axis.series_value - more, np.nan)
    noise = axis.dispersion.noise(axis.series_variance)
    posterior = fit_normal_state(axis.design.matrix, value, noise, shift, prior).posterior
    covariance = posterior.covariance.copy()
    covariance[0, 0] += doubt
    return Posterior(posterior.mean, covariance)


#: After a service: standard deviation of the constant, and how far the other coefficients go back to their priors.
SERVICE_STEP, SERVICE_SHARE = 0.3, 0.15


def widened(axis: AxisNormal, posterior: Posterior) -> Posterior:
    """Return the posterior as a prior for what comes after a service: new grease, another level."""
    covariance = posterior.covariance + SERVICE_SHARE**2 * axis.design.prior.covariance
    covariance[0, 0] = posterior.covariance[0, 0] + SERVICE_STEP**2
    return Posterior(posterior.mean, covariance)
