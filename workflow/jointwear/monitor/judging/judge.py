"""The judgement: from window statistics to states, estimates and alarms.

Friction of every axis, window by window (:mod:`.series`), is held against its normal state under the conditions of
that window (:mod:`.learning`), what all other axes have in common is taken out (:mod:`.shared_error`), and growth over
the last shifts is decided on (:mod:`.decision`), at a stated rate of false alarms. Beside it the paper's detector
(:mod:`.paper_detector`), at the same rate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from jointwear.files.errors import InputError
from jointwear.monitor.events import Event
from jointwear.monitor.findings.findings import findings_of
from jointwear.monitor.findings.greasing import greasing_findings
from jointwear.monitor.findings.missed_torque import unsure_percent_findings
from jointwear.monitor.findings.odd_motion import odd_motion_findings
from jointwear.monitor.findings.offsets import offset_findings
from jointwear.monitor.findings.read_findings import driving_findings, reading_findings
from jointwear.monitor.findings.seen_growth import coarse_findings, loose_findings, missed_findings
from jointwear.monitor.findings.still_growth import standstill_findings
from jointwear.monitor.judging.judge_settings import JudgeSettings
from jointwear.monitor.judging.observed import Observed, observe
from jointwear.monitor.judging.open_alarms import grown_before_findings, open_alarm_findings
from jointwear.monitor.normal.learning import AxisNormal, learn_axes
from jointwear.monitor.normal.missed import with_missed, with_scatter
from jointwear.monitor.normal.override import override_findings, path_speed
from jointwear.monitor.normal.products import product_findings
from jointwear.monitor.normal.programs import program_findings
from jointwear.monitor.normal.recall import Recall
from jointwear.monitor.normal.series import Series, usual_speed
from jointwear.monitor.reading.logs_of_windows import LogsOfWindows
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.reading.zeros import changed_zero, zero_finding
from jointwear.monitor.watching.allowance import BACKLASH_SHARE, LEVEL_SHARE, VISCOUS_SHARE
from jointwear.monitor.watching.another_robot import Exchange, first_exchange, without_exchange
from jointwear.monitor.watching.asked import Anew, Asked, Period
from jointwear.monitor.watching.backlash import (
    BACKLASH,
    COARSEST,
    backlash_findings,
    backlash_records,
    backlash_series,
    lasting,
    raised_status,
)
from jointwear.monitor.watching.decision import LEAST
from jointwear.monitor.watching.gain_of_all import gain_of_all
from jointwear.monitor.watching.gain_of_axes import gains_of_axes, without_gain
from jointwear.monitor.watching.limits import LimitDate
from jointwear.monitor.watching.parts import ViscousGrowth, viscous_scale
from jointwear.monitor.watching.present import back_to_normal, coulomb_growth, error_now
from jointwear.monitor.watching.records import CHANGED, VISCOUS_UNIT, Teller, paper_records
from jointwear.monitor.watching.scale import ScaleStep, scale_steps
from jointwear.monitor.watching.shared_error import units_of_levels
from jointwear.monitor.watching.watching import Watch, before_events, watch
from jointwear.statistics.known import known_median

#: Rounds in which changed scales of the torque are looked for, and at which rate of false alarms per 1,000 h: a scale
#: makes axes be learnt anew, and no stated rate may decide what is learnt.
MOST_STEPS, SCALE_RATE = 3, 1.0


@dataclass(frozen=True)
class Judgement:
    """State of every window and axis.

    `estimates`, `std` : name -> (w, n), change since the normal period; `units` : name -> unit. Names: `coulomb`
    [N m], the growth of friction that counts as Coulomb friction; `coulomb_percent` [%] of the level in the normal
    period; `viscous` [N m s/rad] where the motion shows it, `viscous_percent` [%] of that in the normal period;
    `backlash` [%], of the torque pulses at reversals of the load. `now_error` : name -> (n,), standard deviation of the
    mean over the last day. `status` (w, n) of :data:`HEALTHY`, :data:`CHANGED`, :data:`UNJUDGED`. `alarms` : records
    with the columns of alarms.csv, `time` in seconds, each by what was known then. `grown` (n): what the newest
    alarm of friction is of by what is known today, empty of an axis that is not changed. `limits` (n): when its growth
    reaches a limit, by the last window in which the axis was judged, None where no date is due.
    `back` (n,) bool: what alarmed since the last event is as it was before; its alarm stays open all the same.
    `reason` (w, n): why not judged, :class:`~jointwear.monitor.watching.records.Reason`. `findings` :
    what is no alarm but must be told: `time` [s], `axes` (1-based), `kind`, `words`.
    """

    estimates: dict[str, np.ndarray]
    std: dict[str, np.ndarray]
    status: np.ndarray
    alarms: list[dict[str, Any]]
    units: dict[str, str]
    grown: list[str]
    limits: list[LimitDate | None]
    reason: np.ndarray
    now_error: dict[str, np.ndarray] = field(default_factory=dict)
    back: np.ndarray | None = None
    findings: list[dict[str, Any]] = field(default_factory=list)


def judge(
    statistics: WindowStatistics,
    baseline: int | np.ndarray,
    settings: JudgeSettings,
    known: dict[str, list[AxisNormal | None]] | None = None,
    recall: Recall | None = None,
    logs: LogsOfWindows | None = None,
) -> Judgement:
    """Judge all windows.

    Parameters
    ----------
    baseline : number of windows, from the first, that show the robot healthy, or which ones, (w,) bool.
    known : normal states by name of the series, of a call that differs in the stated rate alone; filled where empty.
    recall : of what the baseline told before, :mod:`.recall`. logs : that the windows come from, default unknown.

    Raises
    ------
    InputError : if there is no window.
    """
    if not statistics.windows:
        raise InputError("there is no window to judge")
    statistics, seen, gains = _without_gains(statistics, baseline, settings)
    first, shift = seen.baseline, seen.shift
    normal = _normal_states(statistics, seen, {} if known is None else known, recall)
    stated = settings.false_alarms_per_1000_h
    rate = stated / 1000 * seen.conditions.hours
    limit = settings.limit_percent / 100
    friction = _watch_level(normal, seen, stated, recall, gains, LEAST * limit)
    level, normal = friction.watch, friction.normal
    asked = Asked(BACKLASH_SHARE * rate, services=False, coarsest=COARSEST)
    backlash = _watched(normal["backlash"], seen, asked, friction.found, recall)
    backlash = lasting(backlash, seen.regime, shift)
    # New grease has another viscosity: where a fall of the level starts anew, the viscous part does too. A fall of its
    # own starts nothing.
    fallen = [[s.window for s in starts if s.proposed] for starts in level.starts]
    # Thicker oil adds to the viscous friction of every axis its share of it, not the same part of its whole friction.
    asked = Asked(VISCOUS_SHARE * rate, services=False, unit=1.0 / _of_viscous(seen))
    viscous = _watched(normal["viscous"], seen, asked, fallen, recall)
    usual = usual_speed(statistics, first)
    teller = Teller(statistics, shift, first, level, viscous, seen.series, usual, limit, settings.events)
    alarms = teller.records() + backlash_records(statistics, backlash)
    if first.any():
        anew = [{*own, *level.anew(j)} for j, own in enumerate(seen.events)]
        alarms += paper_records(statistics, first, rate, seen.regime, anew)
    estimates, std, now_error = _estimates(level, viscous, teller.grown, seen.series, usual, shift, statistics.end)
    estimates[BACKLASH] = 100 * np.expm1(backlash.residual)
    std[BACKLASH] = np.where(np.isfinite(backlash.residual), 100 * np.exp(backlash.residual) * backlash.std, np.nan)
    quantities, limits = teller.now()
    status = raised_status(teller.status, backlash, CHANGED)
    return Judgement(
        estimates=estimates,
        std=std,
        status=status,
        alarms=alarms,
        units={
            "coulomb": "N m",
            "coulomb_percent": "%",
            "viscous": VISCOUS_UNIT,
            "viscous_percent": "%",
            BACKLASH: "%",
        },
        grown=quantities,
        limits=limits,
        now_error=now_error,
        back=back_to_normal(
            [(level, level.alarm), (viscous, teller.viscous_alarm), (backlash, backlash.alarm)], shift, statistics.end
        ),
        reason=teller.reasons(),
        findings=[
            *_findings(statistics, seen, friction, viscous, teller, status == CHANGED, limit, settings.events, logs),
            *open_alarm_findings(statistics, settings.events, alarms, estimates),
            *grown_before_findings(statistics, level),
            *standstill_findings(statistics, limits, alarms, settings.events),
        ],
    )


def _of_viscous(seen: Observed) -> np.ndarray:
    """Return the growth (n,) of viscous friction, of itself, for one unit of its series."""
    return np.array([viscous_scale(float(share)) for share in seen.series["viscous"].share])


def _without_gains(
    statistics: WindowStatistics, baseline: int | np.ndarray, settings: JudgeSettings
) -> tuple[WindowStatistics, Observed, list[ScaleStep]]:
    """Return the windows without gains of single axes that friction and bodies show by themselves, what they show then,
    and these gains."""
    seen, steps = observe(statistics, baseline, settings), []
    for _ in range(MOST_STEPS):
        friction, told = seen.series["beside_bodies"], {(s.axis, s.window) for s in steps}
        found = gains_of_axes(friction, seen.scale, seen.regime, seen.shift, seen.baseline, seen.events)
        fresh = [s for s in found if (s.axis, s.window) not in told]
        if not fresh:
            break
        for step in fresh:
            statistics = without_gain(statistics, step, settings.coulomb[step.axis], float(settings.viscous[step.axis]))
        steps += fresh
        seen = observe(statistics, baseline, settings)
    return statistics, seen, steps


def _findings(
    statistics: WindowStatistics,
    seen: Observed,
    friction: _Level,
    viscous: Watch,
    teller: Teller,
    changed: np.ndarray,
    limit: float,
    events: Sequence[Event],
    logs: LogsOfWindows | None,
) -> list[dict[str, Any]]:
    """Return what is no alarm but must be told; `changed` (w, n) bool; `limit` of growth, as a share."""
    first, shift, level = seen.baseline, seen.shift, friction.watch
    changes = friction.steps, friction.exchanges
    most = np.isfinite(level.residual).mean(axis=1) > 0.5
    shown = None if seen.conditions.named else seen.regime
    program, doubtful = seen.regime, None if logs is None else logs.doubtful
    grown = np.expm1(level.residual)
    zero = changed_zero(statistics, program, shift, first, seen.events, doubtful)
    return [
        *findings_of(
            statistics, shift, first, level, *changes, teller.status == CHANGED, shown, program, doubtful, events, logs
        ),
        *greasing_findings(statistics, shift, first, level, viscous, _of_viscous(seen)),
        *coarse_findings(statistics, first, teller.least, limit),
        *loose_findings(statistics, first, level),
        *missed_findings(statistics, first, viscous),
        *(unsure_percent_findings(statistics, first, seen.coulomb, changed[-1]) if first.any() else []),
        *(backlash_findings(seen.hidden, float(statistics.start[0])) if first.any() else []),
        *program_findings(statistics, first, most),
        *product_findings(statistics, seen.conditions.regime, seen.products, most, logs),
        *override_findings(statistics, path_speed(seen.conditions.features), seen.regime, first, most),
        *reading_findings(statistics, first, shift, program, logs),
        *zero_finding(statistics, zero),
        *odd_motion_findings(statistics, seen.regime, shift, first, seen.events),
        *driving_findings(statistics, seen.series["friction"].driving, shift),
        *offset_findings(statistics, seen.offset, _usual_friction(seen), seen.regime, shift, first, seen.events, grown),
    ]


def _usual_friction(seen: Observed) -> np.ndarray:
    """Return the friction (n,) [N m] at the usual speed in the middle of the baseline, NaN where it is not seen."""
    friction = seen.series["friction"]
    with np.errstate(all="ignore"):
        return friction.unit * np.exp(known_median(np.where(seen.baseline[:, None], friction.value, np.nan), axis=0))


def _normal_states(
    statistics: WindowStatistics, seen: Observed, known: dict[str, list[AxisNormal | None]], recall: Recall | None
) -> dict[str, list[AxisNormal | None]]:
    """Return the normal states of the axes by name of the series; those that are not `known` are learnt and kept."""
    levels = ("coulomb", "friction")
    told = np.array([not reason for reason in seen.hidden])
    quiet = before_events(seen.baseline, seen.events, statistics.axes)
    for name, candidates in (
        ("level", [seen.series[n] for n in levels]),
        ("scale", [seen.scale]),
        ("viscous", [seen.series["viscous"]]),
        ("backlash", [backlash_series(statistics, told)]),
    ):
        if name not in known:
            known[name] = learn_axes(candidates, levels[: len(candidates)], seen.conditions, quiet, seen.shift, recall)
            if name in ("level", "viscous"):
                known[name] = [axis and with_scatter(axis, seen.conditions.regime, seen.shift) for axis in known[name]]
            if name == "viscous":
                known[name] = [axis and with_missed(axis, seen.conditions.regime, seen.shift) for axis in known[name]]
    return known


def _watched(
    normal: list[AxisNormal | None],
    seen: Observed,
    asked: Asked,
    found: Sequence[Sequence[int]],
    recall: Recall | None,
) -> Watch:
    """Watch one quantity; `found` are the windows from which it is learnt anew."""
    period, anew = Period(seen.conditions, seen.baseline, seen.shift), Anew(seen.events, found, seen.kept)
    return watch(normal, period, asked, anew, recall)


@dataclass(frozen=True)
class _Level:
    """The watched level of friction: changes of `steps` of the torque's scale and `exchanges` of robots, for each axis
    the windows from which these make it learnt anew, `found`, and the normal states by name that all is held against.
    """

    watch: Watch
    steps: list[ScaleStep]
    exchanges: list[Exchange]
    found: list[list[int]]
    normal: Mapping[str, list[AxisNormal | None]]


def _watch_level(
    normal: Mapping[str, list[AxisNormal | None]],
    seen: Observed,
    stated: float,
    recall: Recall | None,
    gains: Sequence[ScaleStep],
    least: float,
) -> _Level:
    """Watch the level of friction at the `stated` rate [false alarms per 1,000 h], learnt anew where the scale of the
    torque changed, as `gains` say or is found here, or the logs of another robot begin; `least`: growth from
    which on somebody has to act.
    """
    steps: list[ScaleStep] = [*gains]
    exchanges: list[Exchange] = []
    found = _windows_of(steps, [], len(normal["level"]))
    scale_rate, settled = SCALE_RATE / 1000 * seen.conditions.hours, False
    by_itself = np.array([axis is not None and axis.source == "coulomb" for axis in normal["level"]])
    unit = units_of_levels(seen.series["friction"].share, by_itself)
    asked = Asked(LEVEL_SHARE * scale_rate, unit=unit, least=least)
    alone = Asked(asked.rate, services=False, common=False)
    for _ in range(MOST_STEPS):
        level = _watched(normal["level"], seen, asked, found, recall)
        scaled = _watched(normal["scale"], seen, replace(alone, rate=scale_rate), found, recall)
        plain = _watched(normal["level"], seen, alone, found, recall)
        one = first_exchange(plain, seen.shift, seen.baseline)
        if one is not None and one not in exchanges:
            exchanges.append(one)
            if one.end is not None:
                normal = {name: without_exchange(axes, one) for name, axes in normal.items()}
        else:
            changed = gain_of_all(plain, scaled, seen.shift, seen.baseline)
            changed = changed or scale_steps(level, plain, scaled, seen.shift, seen.baseline)
            told = {(s.axis, s.window) for s in steps} | {(j, e.window) for e in exchanges for j in e.axes}
            fresh = [s for s in changed if (s.axis, s.window) not in told]
            if not fresh:
                settled = True
                break
            steps += fresh
        found = _windows_of(steps, exchanges, len(found))
    if not settled or stated != SCALE_RATE:
        rate = stated / 1000 * seen.conditions.hours
        level = _watched(normal["level"], seen, replace(asked, rate=LEVEL_SHARE * rate), found, recall)
    return _Level(level, steps, exchanges, found, normal)


def _windows_of(steps: Sequence[ScaleStep], exchanges: Sequence[Exchange], axes: int) -> list[list[int]]:
    """Return for each axis the windows from which it is learnt anew."""
    begins = [(s.axis, s.window) for s in steps if s.window > 0]
    begins += [(j, e.window) for e in exchanges if e.end is None for j in e.axes]
    return [sorted({window for axis, window in begins if axis == j}) for j in range(axes)]


def _estimates(
    level: Watch,
    viscous: Watch,
    grown: Sequence[ViscousGrowth],
    series: Mapping[str, Series],
    speed: np.ndarray,
    shift: np.ndarray,
    end: np.ndarray,
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return estimates and their standard deviations (w, n), and those of their means over the last day (n,)."""
    w, n = level.residual.shape
    names = ("coulomb", "coulomb_percent", "viscous", "viscous_percent")
    values, std = ({name: np.full((w, n), np.nan) for name in names} for _ in range(2))
    now = {name: np.full(n, np.nan) for name in names}

    def tell(j: int, growth: np.ndarray, error: np.ndarray, of_now: float, scales: dict[str, float]) -> None:
        for name, scale in scales.items():
            values[name][:, j], std[name][:, j], now[name][j] = scale * growth, scale * error, scale * of_now

    for j in range(n):
        axis, share = level.axes[j], float(series["friction"].share[j])
        if axis is not None:
            scales = {"coulomb": axis.unit, "coulomb_percent": 100 * axis.to_coulomb}
            tell(j, *coulomb_growth(level, viscous, j, shift, end, grown[j]), scales)
        if viscous.axes[j] is not None and speed[j] > 0:
            error = error_now(viscous, j, shift, end)
            scales = {"viscous": series["viscous"].unit[j] / speed[j], "viscous_percent": 100 * viscous_scale(share)}
            tell(j, viscous.residual[:, j], viscous.std[:, j], error, scales)
    for name in names:
        std[name] = np.where(np.isfinite(values[name]), std[name], np.nan)
    return values, std, now
