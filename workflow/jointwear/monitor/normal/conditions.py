"""Conditions of operation, window by window, and the design matrix that the normal state is regressed on.

Columns, with the standard deviation of their coefficients a priori. Friction as a log, so that a coefficient of an
operating feature that is itself a log is an elasticity:

- 1: a constant, as good as free;
- temperature less that of the baseline [K], and its square: :data:`SLOPE`, :data:`CURVE`;
- the warm-up state (:mod:`.warm_up`) and a wave of one day, for the hall, where no temperature of the axis itself is
  logged: :data:`WARM`, :data:`DAY`; two warm-up states for the delay of the thermometer where one is: :data:`BEHIND`;
- operating features (:func:`operating_features`): :data:`FEATURES`;
- the load at the flange (:mod:`.payload`): :data:`LOAD`;
- a constant of each program but the most frequent (:mod:`.regimes`): :data:`PROGRAM`; its products with the load, since
  a part that is carried on some moves of a program weighs on an axis there and not elsewhere, and with the speed, at
  which programs that use other parts of the friction curve differ: :data:`LOAD_PROGRAM`, :data:`SPEED_PROGRAM`;
- temperature below, and above, all that the baseline had [K]: what all axes have in common of it, and its own:
  :data:`BEYOND`. Later shifts teach it by what it does within each of them;
- by how much all axes together are faster or slower than any window of the baseline in the same program
  (:mod:`.override`): :data:`OVERRIDE`;
- products of the features with temperature, or with the warm-up state: :data:`PRODUCT` times that of the feature.

The sizes are those that friction of joints shows (see Bittencourt and Gunnarsson 2012 for speed, load and temperature;
Simoni et al. 2015 for warming): wide enough to learn any joint, narrow enough that little is learnt from nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.normal_state import Posterior
from jointwear.monitor.normal.override import path_speed, unseen_speed
from jointwear.monitor.normal.payload import GravityTorque
from jointwear.monitor.normal.warm_up import warm_up_state
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

CONSTANT, SLOPE, CURVE, WARM, DAY = 3.0, 0.02, 5e-4, 0.2, 0.03
#: A thermometer on a housing follows the oil with a delay, so that a cold morning does not tell of a cold day: times
#: [h] of warming whose states stand for it beside a temperature of the axis itself, short and long as joints have,
#: and the standard deviation of their coefficients.
BEHIND_TIMES, BEHIND = (0.7, 2.0), 0.1
LOAD, PROGRAM = 0.2, 0.05
LOAD_PROGRAM, SPEED_PROGRAM = 0.5, 0.2
#: The same of programs that the log names, as much as friction may differ between any two motions; and of programs that
#: the motion shows and the baseline did not have, where speed and load are told from what the others showed.
NAMED_PROGRAM, LATE_PROGRAM = 0.3, 0.15
#: Of the features: speed (log of its mean, log of the ratio of root mean square and mean), gravity and inertial torque
#: (root mean square over the friction), gravity against the motion (mean over the friction).
FEATURES = np.array([0.3, 0.3, 0.15, 0.05, 0.15])
#: Per log of the speed beyond those of the baseline: 25 to 40 % of the friction were seen at 0.85.
OVERRIDE = 1.5
#: Change of a feature's coefficient per K, as a share of its own prior; per unit of the warm-up state.
PRODUCT, PRODUCT_WARM = 0.02, 0.4
#: Beyond the range of the baseline's temperatures the curve may bend once more: standard deviation per K beyond. Share
#: of the variance of that, and of the next one's, which the axes of a robot have in common: all their oils thicken in
#: the cold, and the same law is carried too far.
BEYOND, COMMON_OF_TEMPERATURE = 0.004, 0.7
#: Share of that variance that no shift takes away, half of the standard deviation: what temperature does within shifts
#: tells of one more bend, and the law between the temperatures of one day and those of another may have several.
LASTING = 0.25
#: Difference [K] up to which temperatures are the same.
SAME = 1e-6
#: A thermometer on a housing and the oil inside are out of step while the temperature changes: hours [h] of the mean
#: that the temperature is held against, and standard deviation per K that it is off that mean by more than it was in
#: the baseline.
LAG, TRANSIT = 8.0, 0.007


@dataclass(frozen=True)
class Conditions:
    """`start`, `end` (w,) [s]; `temperature` (w, n) [degC], NaN unknown; `features` (w, n, f), NaN at rest; `speed`
    (w, n) root mean square of the moving axis [rad/s]; `load` (w,) share of :mod:`.payload`; `regime` (w,) of
    :mod:`.regimes`, or None; `named`: by the log."""

    start: np.ndarray
    end: np.ndarray
    temperature: np.ndarray
    features: np.ndarray
    speed: np.ndarray
    load: np.ndarray
    regime: np.ndarray | None
    named: bool = False

    @property
    def hours(self) -> float:
        """Length of a window [h], 1 where there is none."""
        return float(self.end[0] - self.start[0]) / 3600 if len(self.start) else 1.0

    @property
    def shared(self) -> bool:
        """Whether all axes that have a temperature have the same one."""
        known = np.isfinite(self.temperature).any(axis=0)
        if known.sum() < 2:
            return False
        some = self.temperature[:, known]
        with np.errstate(invalid="ignore"):
            return bool(np.all(np.abs(some - some[:, :1])[np.isfinite(some).all(axis=1)] < SAME))

    def telling(self, learnt: np.ndarray) -> Conditions:
        """Return them without the temperatures of axes that show one value in all windows `learnt` (w, n) they are
        learnt from: these teach nothing of what another one does, and are as good as not logged."""
        seen = learnt & np.isfinite(self.temperature)
        low, high = (
            limit(self.temperature, axis=0, initial=end, where=seen)
            for limit, end in ((np.min, np.inf), (np.max, -np.inf))
        )
        return replace(self, temperature=np.where(high - low > SAME, self.temperature, np.nan))

    def until(self, window: int) -> Conditions:
        """Return those of the windows before `window`."""
        names = ("start", "end", "temperature", "features", "speed", "load")
        regime = None if self.regime is None else self.regime[:window]
        return replace(self, **{name: getattr(self, name)[:window] for name in names}, regime=regime)


def operating_features(
    statistics: WindowStatistics, friction: np.ndarray, static: GravityTorque
) -> tuple[np.ndarray, np.ndarray]:
    """Return the operating features (w, n, 5) and the root mean square speed (w, n); `friction` (n,) [N m] scales,
    `static` tells what a load makes of the gravity torque (:func:`.payload.of_load`)."""
    gram = statistics.gram
    with np.errstate(invalid="ignore", divide="ignore"):
        count = np.where(statistics.count > 0, statistics.count, np.nan).astype(float)
        speed = np.sqrt(gram[..., 2, 2] / count)
        mean = (gram[..., 0, 2] + gram[..., 1, 2]) / count
        gravity, against = _gravity(gram / count[..., None, None], static)
        features = np.stack(
            [
                np.log(mean),
                np.log(speed / mean),
                gravity / friction,
                np.sqrt(gram[..., 4, 4] / count) / friction,
                against / friction,
            ],
            axis=-1,
        )
    return features, speed


def _gravity(mean: np.ndarray, static: GravityTorque) -> tuple[np.ndarray, np.ndarray]:
    """Return the root mean square of the gravity torque, and its mean against the motion, (w, n) [N m].

    Parameters
    ----------
    mean : (w, n, p, p) products of the regressors, mean over the samples.
    """
    factor, constant = 1 + static.share, static.constant
    forward, backward = mean[..., 0, 3], -mean[..., 1, 3]
    middle = factor * (forward + backward) + constant
    varying = np.maximum(mean[..., 3, 3] - (forward + backward) ** 2, 0.0)
    against = factor * (forward - backward) + constant * (mean[..., 0, 0] - mean[..., 1, 1])
    return np.hypot(middle, factor * np.sqrt(varying)), against


@dataclass(frozen=True)
class Design:
    """Design (w, p) of one axis, prior of its coefficients, and the variance (w,) a priori of leaving the baseline's
    range, of temperatures and of how fast they change, `beyond`; the part of it that no column stands for, so that
    nothing is learnt of it, `besides` (w,).

    `programs`: columns of programs that the log names or the baseline lacks, and of speeds that it lacks; their normal
    is learnt when they first run. `thermal`: columns of temperature, warming and hour, with products. `alike`: those of
    bends beyond the baseline's temperatures that the axes of a robot have in common."""

    matrix: np.ndarray
    prior: Posterior
    beyond: np.ndarray
    besides: np.ndarray
    programs: tuple[int, ...] = ()
    thermal: tuple[int, ...] = ()
    alike: tuple[int, ...] = ()


def _lagged(temperature: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the exponential mean (w,) over :data:`LAG` of temperatures (w,) up to each window; NaN as they are.

    Parameters
    ----------
    start : (w,) begin of the windows [s].
    """
    result = np.full(len(temperature), np.nan)
    known = np.flatnonzero(np.isfinite(temperature))
    kept = np.exp(-np.diff(start[known]) / 3600 / LAG)
    means = list(temperature[known[:1]])
    for value, share in zip(temperature[known[1:]].tolist(), kept.tolist(), strict=True):
        means.append(value + share * (means[-1] - value))
    result[known] = means
    return result


def _outside(values: np.ndarray, baseline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return by how much values (w,) lie below and above the range of those of the `baseline` (w,); NaN as they are."""
    low, high = np.nanmin(values[baseline]), np.nanmax(values[baseline])
    return np.maximum(low - values, 0.0), np.maximum(values - high, 0.0)


def _behind(conditions: Conditions) -> np.ndarray:
    """Return the warm-up states (w, k) of :data:`BEHIND_TIMES`, of an operation that is always the usual one."""
    usual = np.ones((len(conditions.start), 1))
    states = [warm_up_state(conditions.start, conditions.end, usual, tau) for tau in BEHIND_TIMES]
    return np.concatenate(states, axis=1)


@dataclass
class _Columns:
    """Columns (w,) of a design, each with the standard deviation of its coefficient a priori."""

    values: list[np.ndarray]
    scales: list[float]

    def add(self, values: Iterable[np.ndarray], scales: Iterable[float]) -> range:
        """Add columns and return their places."""
        before = len(self.values)
        self.values.extend(values)
        self.scales.extend(scales)
        return range(before, len(self.values))

    def prior(self) -> Posterior:
        scale = np.array(self.scales)
        return Posterior(np.zeros(len(scale)), np.diag(scale**2))


def design_of(conditions: Conditions, axis: int, baseline: np.ndarray, warm: np.ndarray | None) -> Design:
    """Return the design of one axis.

    Parameters
    ----------
    axis : 0-based. baseline : (w,) bool, windows that set the middle. warm : (w,) warm-up state, or None.
    """
    columns = _Columns([np.ones(len(conditions.start))], [CONSTANT])
    temperature = conditions.temperature[:, axis]
    known = bool(np.isfinite(temperature[baseline]).any())
    warmer = temperature - float(known_median(temperature[baseline])) if known else None
    warm = None if warm is None else warm - float(np.mean(warm[baseline]))
    thermal = _add_thermal(columns, conditions, baseline, warmer, warm)
    features = conditions.features[:, axis]
    usual = known_median(features[baseline], axis=0) if np.isfinite(features[baseline]).any() else np.zeros(5)
    centred = features - usual
    columns.add(centred.T, FEATURES)
    if warmer is not None:
        thermal += columns.add((centred * warmer[:, None]).T, FEATURES * PRODUCT)
    elif warm is not None:
        thermal += columns.add((centred * warm[:, None]).T, FEATURES * PRODUCT_WARM)
    programs = _add_programs(columns, conditions, baseline, centred[:, 0])
    beyond = besides = np.zeros(len(conditions.start))
    bends: list[range] = []
    if known:
        bends, size = _add_bends(columns, temperature, baseline)
        hurried = _hurried(conditions, temperature, baseline)
        beyond, besides = size + hurried, LASTING * size + hurried
    thermal += [place for pair in bends for place in pair]
    matrix, alike = np.stack(columns.values, axis=1), tuple(pair[0] for pair in bends)
    return Design(matrix, columns.prior(), beyond, besides, tuple(programs), tuple(thermal), alike)


def _add_bends(columns: _Columns, temperature: np.ndarray, baseline: np.ndarray) -> tuple[list[range], np.ndarray]:
    """Add the bends beyond the temperatures (w,) of the baseline, of each side that later windows reach.

    Returns the places of each, first that of what the axes have in common, and the variance (w,) a priori of all.
    """
    share = (1 - LASTING) * np.array([COMMON_OF_TEMPERATURE, 1 - COMMON_OF_TEMPERATURE])
    sides = _outside(temperature, baseline)
    bends = [columns.add([side, side], BEYOND * np.sqrt(share)) for side in sides if (side > 0).any()]
    return bends, (BEYOND * (sides[0] + sides[1])) ** 2


def _add_thermal(
    columns: _Columns,
    conditions: Conditions,
    baseline: np.ndarray,
    warmer: np.ndarray | None,
    warm: np.ndarray | None,
) -> list[int]:
    """Add the columns of temperature, warming and hour and return their places.

    Parameters
    ----------
    warmer : (w,) [K] than the middle of the baseline, None where no temperature is known. warm : (w,) warm-up state
        less that of the baseline, or None.
    """
    thermal: list[int] = []
    if warmer is not None:
        thermal += columns.add([warmer, warmer**2], [SLOPE, CURVE])
    if warmer is not None and warm is None:
        states = _behind(conditions).T
        thermal += columns.add([one - float(np.mean(one[baseline])) for one in states], [BEHIND] * len(states))
    if warm is not None:
        turn = 2 * np.pi * (0.5 * (conditions.start + conditions.end) / 86400.0)
        thermal += columns.add([warm, np.cos(turn), np.sin(turn)], [WARM, DAY, DAY])
    return thermal


def _hurried(conditions: Conditions, temperature: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """Return the variance (w,) of temperatures that change as the baseline did not have it."""
    below, above = _outside(temperature - _lagged(temperature, conditions.start), baseline)
    return (TRANSIT * (below + above)) ** 2


def _add_programs(columns: _Columns, conditions: Conditions, baseline: np.ndarray, speed: np.ndarray) -> list[int]:
    """Add the columns of speeds that the baseline lacks, of the load and of programs.

    Returns the places of those whose normal is learnt when they first run.

    Parameters
    ----------
    speed : (w,) log of the speed less that of the baseline.
    """
    learnt: list[int] = []
    override = unseen_speed(path_speed(conditions.features), conditions.regime, baseline)
    if override.any():
        learnt += columns.add([override], [OVERRIDE])
    load = conditions.load - float(np.median(conditions.load[baseline]))
    columns.add([load], [LOAD])
    if conditions.regime is None:
        return learnt
    regime = conditions.regime
    names, counts = np.unique(regime[baseline & (regime >= 0)], return_counts=True)
    usual = names[np.argmax(counts)] if len(names) else -1
    for name in np.unique(regime[regime >= 0]):
        if name == usual:
            continue
        late = name not in names
        inside = (regime == name).astype(float)
        own = columns.add([inside], [NAMED_PROGRAM if conditions.named else LATE_PROGRAM if late else PROGRAM])
        if conditions.named or late:
            learnt += own
        columns.add([load * inside, np.where(inside > 0, speed, 0.0)], [LOAD_PROGRAM, SPEED_PROGRAM])
    columns.add([np.where(regime >= 0, 0.0, np.nan)], [PROGRAM])
    return learnt
