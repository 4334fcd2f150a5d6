"""Alarms and states told from what was watched: which quantity, how much, when the limit, what stays open."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import partial
from typing import Any

import numpy as np

from jointwear.monitor.events import Event
from jointwear.monitor.normal.dispersion import Q80
from jointwear.monitor.normal.series import Series, loud_windows
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.decision import TOLERATED
from jointwear.monitor.watching.lasting_alarms import is_open, told_windows
from jointwear.monitor.watching.limits import COULOMB, VISCOUS, LimitDate, Limits
from jointwear.monitor.watching.locate import honest_probability
from jointwear.monitor.watching.paper_detector import paper_alarms
from jointwear.monitor.watching.parts import viscous_scale
from jointwear.monitor.watching.present import coulomb_growth, error_now, mean_now
from jointwear.monitor.watching.shared_error import FINDING
from jointwear.monitor.watching.watching import Watch

HEALTHY, CHANGED, UNJUDGED = "healthy", "changed", "cannot be judged"
#: Unit of a change of viscous friction.
VISCOUS_UNIT = "N m s/rad"
#: The detector whose alarms count, and the paper's, which stands beside it for comparison.
DETECTORS = ("model", "paper")
#: An alarm that lasts is told again, with a new forecast, after this many hours where growth has gone on since by this
#: many of its standard errors; after that when it has risen by this much more; or after a week. What is no wear does
#: not go on (docs/decisions/when_to_alarm.md).
REPEAT_HOURS, REPEAT_CLEAR, REPEAT_GROWTH, REPEAT_LATEST = 24.0, 1.0, 0.02, 168.0
#: Standard errors by which the level lies below normal where a rise of viscous friction is that of new grease.
GREASED = 2.0


class Reason(IntEnum):
    """Why an axis is not judged in a window; 0 where it is, or where what was read says why (`flags`)."""

    NONE = 0
    BASELINE = 1
    LEARNING = 2
    CONDITIONS = 3
    LOUD = 4
    DRIVES = 5
    UNSURE = 6


@dataclass(frozen=True)
class _Told:
    """An alarm that was told: at `hour`, of the level or of viscous friction alone (`by_level`), with the `mean` of its
    shifts; `again`: it had been told before since the axis was learnt anew."""

    hour: float
    by_level: bool
    mean: float
    again: bool = False


def _is_news(last: _Told, now: _Told, error: float) -> bool:
    """Return whether an alarm that was told as `last` is told again as `now`; `error`: standard error of its mean."""
    since = now.hour - last.hour
    if since < REPEAT_HOURS:
        return False
    least = max(REPEAT_CLEAR * error, REPEAT_GROWTH if last.again else 0.0)
    # Level and viscous part have different units. Where the level has joined in, growth has gone on.
    risen = now.mean - last.mean > least if now.by_level == last.by_level else now.by_level
    return risen or since >= REPEAT_LATEST


def _together(level: Watch) -> np.ndarray:
    """Return where (w,) all axes have moved together by more than is a finding."""
    return np.abs(level.shared.common) > FINDING


class Teller:
    """Alarms and states of the axes of one robot; `least` (n,): smallest growth of Coulomb friction that is seen;
    `viscous_alarm` (w, n): alarms of viscous friction by charts of its own."""

    def __init__(
        self,
        statistics: WindowStatistics,
        shift: np.ndarray,
        baseline: np.ndarray,
        level: Watch,
        viscous: Watch,
        series: Mapping[str, Series],
        speed: np.ndarray,
        limit: float,
        events: Sequence[Event],
    ) -> None:
        self._s, self._baseline = statistics, baseline
        self._level, self._viscous, self._series, self._speed = level, viscous, series, speed
        self._events, self._limit = events, limit
        self.viscous_alarm = self._viscous_alarm()
        self._alarm = level.alarm | self.viscous_alarm
        self._shift = shift
        whole = self._known(len(shift))
        self.grown = [whole.grown(j) for j in range(len(level.axes))]
        self.least = self._least_seen()
        self._told = self._spaced()
        self.status = self._states()

    def _known(self, stop: int) -> Limits:
        """Return what of growth is viscous, and when it reaches the limit, by what is known before window `stop`."""
        level, share = self._level.until(stop), self._series["friction"].share
        shift, end = self._shift[:stop], self._s.end[:stop]
        return Limits(level, self._viscous.until(stop), share, shift, end, self._limit, _together(level))

    def _viscous_alarm(self) -> np.ndarray:
        """Alarms (w, n) of viscous friction.

        Also of axes whose judged level holds viscous friction: there it may drown in what Coulomb friction does from
        shift to shift. None where all axes have moved together: another gain or colder oil raises what grows with
        speed as well. None where the level has fallen: new grease is thicker, and what wears does not fall.
        """
        alone = np.array([a is not None for a in self._level.axes])
        with np.errstate(invalid="ignore"):
            greased = self._level.mean < -GREASED * self._level.mean_std
        return self._viscous.alarm & alone & ~_together(self._level)[:, None] & ~greased

    def _least_seen(self) -> np.ndarray:
        """Return the growth (n,) of Coulomb friction from which on two shifts alarm, NaN where no normal is known."""
        level, result = self._level, np.full(len(self._level.axes), np.nan)
        for j, axis in enumerate(level.axes):
            if axis is None:
                continue
            between = axis.dispersion.between**2
            judged = np.isfinite(level.residual[:, j]) & after_baseline(self._baseline)
            # What is not known of the normal state under the conditions that the axis is judged in.
            unknown = (level.std[:, j] ** 2 - level.noise[:, j] - between)[judged]
            normal = float(np.median(unknown) if len(unknown) else np.nanmedian(axis.fit.left_out_variance))
            least = level.threshold[j] * np.sqrt(between / 2 + max(normal, 0.0)) + TOLERATED
            result[j] = axis.to_coulomb * np.expm1(least)
        return result

    def _spaced(self) -> np.ndarray:
        """Return which alarms (w, n) are told."""
        told = np.zeros_like(self._alarm)
        for j in range(told.shape[1]):
            told[:, j] = told_windows(self._alarm[:, j], self._level.starts[j], partial(self._is_news, j))
        return told

    def _is_news(self, j: int, last: int, now: int, again: bool) -> bool:
        """Return :func:`_is_news` of axis `j` at the window `now`, of an alarm that was told in the window `last`."""

        def watched(k: int) -> Watch:
            return self._level if self._level.alarm[k, j] else self._viscous

        def told(k: int) -> _Told:
            by_level = bool(self._level.alarm[k, j])
            return _Told(float(self._s.end[k] / 3600), by_level, float(watched(k).mean[k, j]))

        return _is_news(replace(told(last), again=again), told(now), float(watched(now).mean_std[now, j]))

    def _states(self) -> np.ndarray:
        """Return the status (w, n); an axis that has alarmed stays changed until an event of the config closes it."""
        residual = self._level.residual
        status = np.full(residual.shape, HEALTHY, dtype=object)
        status[~np.isfinite(residual)] = UNJUDGED
        for j in range(residual.shape[1]):
            open_, known = is_open(self._alarm[:, j], self._level.starts[j]), np.isfinite(residual[:, j])
            status[open_, j] = np.where((known | self._level.learning[:, j])[open_], CHANGED, UNJUDGED)
        return status

    def _parts(self, k: int, j: int, episode: bool) -> tuple[str, float, float]:
        """Return the name of the quantity that grew by window `k`, and mean and error of the level; `episode`: its
        episode is one of viscous friction."""
        level, viscous = self._level, self._viscous
        part = VISCOUS, float(viscous.mean[k, j]), float(viscous.mean_std[k, j])
        if not level.alarm[k, j]:
            return part
        # What no longer shows in the viscous part is none of it.
        named = episode and part[1] > part[2]
        if named and level.axes[j].source == "coulomb":
            return part
        return (VISCOUS if named else COULOMB), float(level.mean[k, j]), float(level.mean_std[k, j])

    def reasons(self) -> np.ndarray:
        """Return why each window (w, n) is not judged, of :class:`Reason`."""
        result = np.zeros(self.status.shape, dtype=np.int32)
        moved = self._s.count > 0
        loud = loud_windows(self._s, self._baseline)
        for j, axis in enumerate(self._level.axes):
            hidden = ~np.isfinite(self._level.residual[:, j]) & moved[:, j]
            if axis is None:
                result[hidden, j] = Reason.BASELINE
                continue
            unsure, driving = self._series[axis.source].unsure, self._series["friction"].driving
            if unsure is not None:
                result[hidden & unsure[:, j], j] = Reason.UNSURE
            result[hidden & loud[:, j], j] = Reason.LOUD
            if driving is not None:
                result[hidden & driving[:, j], j] = Reason.DRIVES
            result[hidden & self._level.unseen[:, j], j] = Reason.CONDITIONS
            result[hidden & self._level.learning[:, j], j] = Reason.LEARNING
        return result

    def records(self) -> list[dict[str, Any]]:
        """Return the rows of alarms.csv, each by what was known at its window: later logs do not rewrite it.

        But for what later windows teach of the normal state: a service that a fall proposes, another scale or robot and
        a program or product that the baseline lacks begin some windows before they show, and an event may be entered
        late; from there on all is told anew.
        """
        result = []
        level = self._level
        statistic, threshold = evidence(level)
        for k, j in np.argwhere(self._told):
            known = self._known(k + 1)
            name, mean, error = self._parts(k, j, bool(known.grown(j).named[k]))
            growth, spread = self._growth_then(k, j, name, known)
            unit_of = self._level.axes[j].unit if name == COULOMB else float(self._series["viscous"].unit[j])
            changes = [unit_of * v for v in (growth, growth - Q80 * spread, growth + Q80 * spread)]
            percent, unit = [self._percent_of(j, name) * v for v in changes], "N m"
            if name == VISCOUS and self._speed[j] > 0:
                changes, unit = [v / self._speed[j] for v in changes], VISCOUS_UNIT
            # By what alarms its growth may be none: then, as while all axes move together, it may be chance.
            other_cause = bool(_together(level)[k]) or mean <= Q80 * error
            sure = honest_probability(statistic[k], threshold[k], other_cause)[j] if level.alarm[k, j] else np.nan
            grown, expected = Grown(changes, unit, percent, 100 * self._limit), known.forecast(j, name)
            result.append(record(self._s.end[k], int(j) + 1, name, grown, float(sure), expected, DETECTORS[0]))
        return result

    def _growth_then(self, k: int, j: int, name: str, known: Limits) -> tuple[float, float]:
        """Return by how much a quantity of an axis had grown by window `k`, over its normal value, and the standard
        error: what pages tell as of now, then, by the shifts that alarmed. Where none of their windows in that day
        shows it, the mean of all of them."""
        watched = known.level if name == COULOMB else known.viscous
        shift, end = self._shift[: k + 1], self._s.end[: k + 1]
        judged = np.isfinite(watched.residual[:, j])
        alarmed = np.isin(shift, np.unique(shift[judged])[-max(int(watched.shifts[k, j]), 1) :])
        part = replace(watched, residual=np.where(alarmed[:, None], watched.residual, np.nan))
        if name == COULOMB:
            growth, std, error = coulomb_growth(part, known.viscous, j, shift, end, known.grown(j))
        else:
            growth, std, error = part.residual[:, j], part.std[:, j], error_now(part, j, shift, end)
        found = mean_now(growth, std, end), error
        if np.isfinite(found).all():
            return found
        mean, error = float(watched.mean[k, j]), float(watched.mean_std[k, j])
        return (float(np.expm1(mean)), float(np.exp(mean)) * error) if name == COULOMB else (mean, error)

    def _percent_of(self, j: int, name: str) -> float:
        """Return the growth of a quantity of an axis, of what it was in the normal period, for one N m [%/(N m)]."""
        axis = self._level.axes[j]
        if name == COULOMB:
            return 100 * axis.to_coulomb / axis.unit
        return 100 * viscous_scale(float(self._series["friction"].share[j])) / float(self._series["viscous"].unit[j])

    def now(self) -> tuple[list[str], list[LimitDate | None]]:
        """Return of each axis (n) what its newest alarm is of by what is known today, empty where it is not changed,
        and when its growth reaches the limit, by its last judged window.

        No date where growth cannot be told from zero by now: it would be one of chance.
        """
        n = self.status.shape[1]
        quantities, limits = [""] * n, [None] * n
        for j in range(n):
            judged = np.flatnonzero(np.isfinite(self._level.residual[:, j]))
            if len(judged) and self.status[judged[-1], j] == CHANGED:
                known = self._known(int(judged[-1]) + 1)
                told = np.flatnonzero(self._told[: judged[-1] + 1, j])
                newest = bool(len(told)) and bool(known.grown(j).named[told[-1]])
                quantities[j] = self._parts(told[-1], j, newest)[0] if len(told) else COULOMB
                limits[j] = known.forecast(j, quantities[j], now=True)
        return quantities, limits


def evidence(level: Watch) -> tuple[np.ndarray, np.ndarray]:
    """Return the statistic of every axis for any change, and its threshold, (w, n), NaN where not judged.

    Which axis it is depends on the evidence for any change; the decision asks for more than what is tolerated. A step
    is as sure as its own chart is beyond its threshold: the level says little of it where friction fell before or the
    weather is unsure.
    """
    statistic = np.where(np.isfinite(level.residual), np.maximum(level.mean / level.mean_std, 0.0), np.nan)
    threshold = level.threshold + TOLERATED / level.mean_std
    beyond = np.maximum(level.step, 0.0) ** 2 - level.step_threshold**2
    by_step = level.alarm & (beyond > 0)
    reached = np.sqrt(threshold**2 + np.where(by_step, beyond, 0.0))
    return np.where(by_step, np.fmax(statistic, reached), statistic), threshold


def paper_records(
    statistics: WindowStatistics,
    baseline: np.ndarray,
    rate: float,
    programs: np.ndarray | None,
    events: Sequence[Sequence[int]] = (),
) -> list[dict[str, Any]]:
    """Return the alarms of the paper's detector.

    Parameters
    ----------
    baseline : (w,) bool, the normal period, of one window at least. rate : false alarms a window that are allowed.
    programs : (w,) program of each window, or None. events : of each axis the windows at which it begins anew, whether
        the config says so or a step of its scale or a fall of its friction was found.

    Notes
    -----
    Its components are of all axes together, so that an event of one is one of all: what is normal is learnt anew over
    as many windows as at first, in which it says nothing.
    """
    first, last = np.flatnonzero(baseline)[[0, -1]]
    later = {k for own in events for k in own if last < k < statistics.windows}
    edges = [int(first), *sorted(later), statistics.windows]
    result = []
    for a, b in itertools.pairwise(edges):
        own = None if programs is None else programs[a:b]
        result += _paper_records(statistics.part(slice(a, b)), min(int(last + 1 - first), b - a), rate, own)
    return result


def _paper_records(
    statistics: WindowStatistics, baseline: int, rate: float, programs: np.ndarray | None
) -> list[dict[str, Any]]:
    verdict = paper_alarms(statistics, baseline, rate, programs)
    unknown = Grown([np.nan] * 3, "", [np.nan] * 3)
    return [
        record(statistics.end[k], int(verdict.axis[k]), "torque histogram", unknown, np.nan, None, DETECTORS[1])
        for k in np.flatnonzero(verdict.alarm)
    ]


@dataclass(frozen=True)
class Grown:
    """What a quantity has grown by at an alarm: `change` in `unit` and `percent` of the normal period, each with the
    ends of its 80 % interval; `limit` [%] that the forecast counts down to, NaN where there is none."""

    change: Sequence[float]
    unit: str
    percent: Sequence[float]
    limit: float = np.nan


def record(
    time: float,
    axis: int,
    quantity: str,
    grown: Grown,
    probability: float,
    expected: LimitDate | None,
    detector: str,
) -> dict[str, Any]:
    """Return one row of alarms.csv. An end that may never be reached stays empty."""
    found = [np.nan] * 3 if expected is None else expected.hours_from(time)
    hours = [v if np.isfinite(v) else np.nan for v in found]
    return {
        "time": float(time),
        "axis": axis,
        "quantity": quantity,
        "change": float(grown.change[0]),
        "change_low": float(grown.change[1]),
        "change_high": float(grown.change[2]),
        "unit": grown.unit,
        "growth_percent": float(grown.percent[0]),
        "growth_percent_low": float(grown.percent[1]),
        "growth_percent_high": float(grown.percent[2]),
        "limit_percent": float(grown.limit),
        "probability_axis": probability,
        "hours_to_limit": hours[0],
        "hours_to_limit_low": hours[1],
        "hours_to_limit_high": hours[2],
        "limited_by": "" if expected is None else expected.quantity,
        "detector": detector,
    }
