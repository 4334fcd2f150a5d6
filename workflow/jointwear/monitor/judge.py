"""The judgement: from window statistics to states, estimates and alarms.

Per axis: growth of the Coulomb friction (:mod:`.estimate`), a control chart for slow drift (:mod:`.charts`), the
probability that this axis is the one (:mod:`.locate`), hours to the limit (:mod:`.forecast`). Beside it the paper's
detector (:mod:`.paper_detector`), at the same rate of false alarms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.monitor.charts import FEWEST, Trace, inflation, mean_variance, run_chart, thresholds_for
from jointwear.monitor.estimate import (
    Normal,
    Sums,
    change_columns,
    coulomb_estimates,
    learn_normal,
    other_estimates,
    prior_scale,
)
from jointwear.monitor.forecast import Forecast, forecast
from jointwear.monitor.locate import axis_probability
from jointwear.monitor.paper_detector import paper_alarms
from jointwear.monitor.windows import WindowStatistics
from jointwear.robots.robot import Robot

HEALTHY, CHANGED, UNJUDGED = "healthy", "changed", "cannot be judged"
DETECTORS = ("model", "paper")
#: Limit [%] that counts where the user sets none.
DEFAULT_LIMIT = 20.0
#: Normal quantile of the 80 % interval of a change.
_Q80 = 1.2815515655446004
#: An axis that has changed is told again after this many hours, with a new forecast.
REPEAT_HOURS = 24.0
#: A changed axis counts as healthy again when the mean of this many windows is within two standard deviations of
#: the normal mean.
_BACK = 24


@dataclass(frozen=True)
class JudgeSettings:
    """What the judgement needs to know of robot and user.

    coulomb : (n, 2) nominal Coulomb levels [N m], both positive. viscous : (n,) [N m s/rad].
    limit_percent : growth of the Coulomb friction that the forecast counts down to [%].
    false_alarms_per_1000_h : of one detector, all axes of the robot together.
    """

    coulomb: np.ndarray
    viscous: np.ndarray
    limit_percent: float = DEFAULT_LIMIT
    false_alarms_per_1000_h: float = 1.0


def settings_of(robot: Robot, entry: Mapping[str, Any]) -> JudgeSettings:
    """Return the settings of a robot and its entry in the config."""
    return JudgeSettings(
        coulomb=np.stack([np.abs(robot.coulomb_positive), np.abs(robot.coulomb_negative)], axis=1),
        viscous=np.abs(robot.viscous),
        limit_percent=float(entry.get("limits", {}).get("coulomb_increase_percent", DEFAULT_LIMIT)),
        false_alarms_per_1000_h=float(entry.get("false_alarms_per_1000_h", 1.0)),
    )


@dataclass(frozen=True)
class Judgement:
    """State of every window and axis.

    `estimates`, `std` : name -> (w, n), change since the normal period; `units` : name -> unit. Names: `coulomb`
    [N m], the mean growth of both levels; `coulomb_percent` [%] of the nominal levels; `viscous` [N m s/rad] where
    the motion shows it. `status` (w, n) of :data:`HEALTHY`, :data:`CHANGED`, :data:`UNJUDGED`. `alarms` : records
    with the columns of alarms.csv, `time` in seconds.
    """

    estimates: dict[str, np.ndarray]
    std: dict[str, np.ndarray]
    status: np.ndarray
    alarms: list[dict[str, Any]]
    units: dict[str, str]


def judge(statistics: WindowStatistics, baseline: int, settings: JudgeSettings) -> Judgement:
    """Judge all windows.

    Parameters
    ----------
    baseline : number of windows, from the first, that show the robot healthy.
    """
    coulomb = np.asarray(settings.coulomb, dtype=float)
    level = np.where(coulomb.sum(axis=1) > 0, coulomb.mean(axis=1), 1.0)
    sums = sums_of(statistics, coulomb)
    normal = learn_normal(_first(sums, baseline), prior_scale(coulomb, settings.viscous))
    change, std = coulomb_estimates(sums, normal)
    limit = settings.limit_percent / 100
    unseen = _unseen(change, std, normal, limit, baseline)
    change, std = np.where(unseen, np.nan, change), np.where(unseen, np.nan, std)
    hours = statistics.length / 3600 if statistics.windows else 1.0
    rate = settings.false_alarms_per_1000_h / 1000 * hours
    charted = np.where(np.isfinite(change[:baseline]).sum(axis=0) >= FEWEST, normal.windows, 0)
    threshold, fall = thresholds_for(rate, charted)
    after = change[baseline:], std[baseline:]
    trace = run_chart(*after, threshold, fall, normal)
    reported = _spaced(trace.alarm, max(1, round(REPEAT_HOURS / hours)))
    status = np.full(change.shape, HEALTHY, dtype=object)
    status[np.isnan(change)] = UNJUDGED
    status[baseline:][_still_changed(trace.alarm, *after, normal)] = CHANGED
    alarms = _records(statistics, baseline, trace, reported, after, normal, threshold, level, coulomb, limit)
    alarms += _paper_records(statistics, baseline, rate)
    viscous, viscous_std = other_estimates(sums, normal, "viscous")
    percent = np.where(coulomb.sum(axis=1) > 0, 100.0, np.nan)
    return Judgement(
        estimates={"coulomb": change * level, "coulomb_percent": change * percent, "viscous": viscous},
        std={"coulomb": std * level, "coulomb_percent": std * percent, "viscous": viscous_std},
        status=status,
        alarms=alarms,
        units={"coulomb": "N m", "coulomb_percent": "%", "viscous": "N m s/rad"},
    )


def sums_of(statistics: WindowStatistics, coulomb: np.ndarray) -> Sums:
    """Return the sums of all windows for the regression on `coulomb` (n, 2) and its nuisances."""
    usable = statistics.judgeable & (statistics.count > 0)
    return change_columns(
        statistics.gram, statistics.moment, statistics.residual_square, statistics.freedom, usable, coulomb
    )


def _first(sums: Sums, count: int) -> Sums:
    return Sums(**{name: getattr(sums, name)[:count] for name in Sums.__dataclass_fields__})


def _unseen(change: np.ndarray, std: np.ndarray, normal: Normal, limit: float, baseline: int) -> np.ndarray:
    """Return which windows (w, n) cannot be judged: no estimate, or one so coarse that the limit would not show."""
    poor_axis = np.isfinite(change[:baseline]).sum(axis=0) < FEWEST
    poor_axis |= np.sqrt(1.0 / np.where(normal.weight > 0, normal.weight, np.nan)) > limit / 3
    with np.errstate(invalid="ignore"):
        return ~np.isfinite(change) | (std > limit) | poor_axis | (normal.weight <= 0)


def _spaced(alarm: np.ndarray, least: int) -> np.ndarray:
    """Return the alarms (w, n) that are told: the first of an axis, and later ones `least` windows apart."""
    told = np.zeros_like(alarm)
    for j in range(alarm.shape[1]):
        last = -least
        for k in np.flatnonzero(alarm[:, j]):
            if k - last >= least:
                told[k, j], last = True, k
    return told


def _still_changed(alarm: np.ndarray, change: np.ndarray, std: np.ndarray, normal: Normal) -> np.ndarray:
    """Return where (w, n) an axis has alarmed and has not come back to its normal mean since."""
    result, base = np.zeros(alarm.shape, dtype=bool), mean_variance(normal)
    for j in range(alarm.shape[1]):
        judged = np.flatnonzero(np.isfinite(change[:, j]))
        changed = False
        for place, k in enumerate(judged):
            changed = changed or bool(alarm[k, j])
            recent = judged[max(0, place - _BACK + 1) : place + 1]
            weight = 1.0 / std[recent, j] ** 2
            mean = np.sum(weight * change[recent, j]) / weight.sum()
            error = np.sqrt(inflation(len(recent), normal.memory[j], normal.slow[j]) / weight.sum() + base[j])
            if changed and not alarm[k, j] and len(recent) == _BACK and abs(mean) < 2 * error:
                changed = False
            result[k, j] = changed
    return result


def _records(
    statistics: WindowStatistics,
    baseline: int,
    trace: Trace,
    reported: np.ndarray,
    after: tuple[np.ndarray, np.ndarray],
    normal: Normal,
    threshold: np.ndarray,
    level: np.ndarray,
    coulomb: np.ndarray,
    limit: float,
) -> list[dict[str, Any]]:
    change, std = after
    mean_std = np.sqrt(mean_variance(normal))
    end = statistics.end[baseline:]

    def raised(count: int, j: int) -> float:
        return float(inflation(count, normal.memory[j], normal.slow[j]))

    records = []
    for k, j in np.argwhere(reported):
        judged = np.flatnonzero(np.isfinite(change[: k + 1, j]))
        recent = judged[-int(trace.length[k, j]) :]
        weight = 1.0 / std[recent, j] ** 2
        mean = float(np.sum(weight * change[recent, j]) / weight.sum())
        error = float(np.sqrt(raised(len(recent), j) / weight.sum() + mean_std[j] ** 2))
        known = coulomb[j].sum() > 0
        expected = (
            forecast(
                (end[: k + 1] - statistics.end[baseline - 1]) / 3600,
                change[: k + 1, j],
                std[: k + 1, j],
                limit,
                mean_std=float(mean_std[j]),
                start=0.0,
            )
            if known and mean > 0
            else Forecast(np.nan, np.nan, np.nan)
        )
        probability = axis_probability(trace.statistic[k], threshold)[j]
        values = [level[j] * v for v in (mean, mean - _Q80 * error, mean + _Q80 * error)]
        records.append(
            _record(end[k], int(j) + 1, "coulomb friction", values, "N m", float(probability), expected, DETECTORS[0])
        )
    return records


def _paper_records(statistics: WindowStatistics, baseline: int, rate: float) -> list[dict[str, Any]]:
    verdict = paper_alarms(statistics, baseline, rate)
    unknown = [np.nan] * 3
    return [
        _record(
            statistics.end[k], int(verdict.axis[k]), "torque histogram", unknown, "", np.nan, Forecast(*unknown),
            DETECTORS[1],
        )
        for k in np.flatnonzero(verdict.alarm)
    ]  # fmt: skip


def _record(
    time: float,
    axis: int,
    quantity: str,
    change: list[float],
    unit: str,
    probability: float,
    expected: Forecast,
    detector: str,
) -> dict[str, Any]:
    """One row of alarms.csv. An end that may never be reached stays empty."""
    hours = [v if np.isfinite(v) else np.nan for v in (expected.hours, expected.low, expected.high)]
    return {
        "time": float(time),
        "axis": axis,
        "quantity": quantity,
        "change": float(change[0]),
        "change_low": float(change[1]),
        "change_high": float(change[2]),
        "unit": unit,
        "probability_axis": probability,
        "hours_to_limit": hours[0],
        "hours_to_limit_low": hours[1],
        "hours_to_limit_high": hours[2],
        "detector": detector,
    }
