"""Watch one quantity of all axes: normal state, shared error, evidence, alarms, services that a fall proposes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointwear.monitor.normal.conditions import COMMON_OF_TEMPERATURE
from jointwear.monitor.normal.dispersion import inflated
from jointwear.monitor.normal.learning import AxisNormal
from jointwear.monitor.normal.recall import Recall, key_of
from jointwear.monitor.normal.shift_scale import own_scale, shift_scale
from jointwear.monitor.normal.shifts import running_sums, shift_starts
from jointwear.monitor.reading.after_baseline import after_baseline, before_baseline
from jointwear.monitor.watching.asked import Anew, Asked, Period
from jointwear.monitor.watching.decision import Evidence
from jointwear.monitor.watching.falls import (
    CLEAR_RATE,
    FALL_RATE,
    Dip,
    after_dips,
    doubted,
    gone_again,
    proposed,
    with_service,
)
from jointwear.monitor.watching.growth_so_far import shrunk, stands_out
from jointwear.monitor.watching.null_runs import Axis, null_thresholds
from jointwear.monitor.watching.shared_error import FINDING, SharedError, shared_error
from jointwear.monitor.watching.watched_axis import Common, Start, WatchedAxis

#: Windows of a shift, and standard deviation of the normal state [log], where the baseline does not say.
_USUAL_WINDOWS, _USUAL_NORMAL = 8.0, 0.01
#: Fields of :class:`Watch` that are arrays of windows.
_OF_WINDOWS = (
    "residual", "std", "noise", "growth", "fall", "mean", "mean_std", "shifts", "alarm", "learning", "unseen", "step",
    "baseline",
)  # fmt: skip


@dataclass(frozen=True)
class Watch:
    """What became of one quantity, arrays (w, n).

    `residual`: log level less normal state and shared error, NaN where not judged; `std` of a window; `noise`: the
    part of its variance that windows do not share; `growth`, `fall`, `mean`, `mean_std`, `shifts` of
    :class:`~.decision.Evidence`; `alarm`: bool; `learning`, `unseen`: why a window is not judged.
    `threshold`, `step_threshold` (n,), of `growth` and of `step`, the last shifts less those before;
    `starts`: per axis; `axes`: normal states, None where the `baseline` (w,) shows too little; `dips`: per axis, falls
    that have gone again and changed nothing.
    """

    residual: np.ndarray
    std: np.ndarray
    noise: np.ndarray
    growth: np.ndarray
    fall: np.ndarray
    mean: np.ndarray
    mean_std: np.ndarray
    shifts: np.ndarray
    alarm: np.ndarray
    learning: np.ndarray
    unseen: np.ndarray
    threshold: np.ndarray
    step: np.ndarray
    step_threshold: np.ndarray
    shared: SharedError
    axes: list[AxisNormal | None]
    baseline: np.ndarray
    starts: list[list[Start]] = field(default_factory=list)
    dips: list[list[Dip]] = field(default_factory=list)

    def anew(self, axis: int) -> list[int]:
        """Return the windows at which the level of a 0-based axis is another: its starts, and both ends of a dip."""
        return [*(s.window for s in self.starts[axis]), *(k for d in self.dips[axis] for k in (d.window, d.back))]

    def until(self, stop: int) -> Watch:
        """Return it as if windows from `stop` on were not there.

        What axes are held against stays: normal states, and starts before `stop`, also those that windows from `stop`
        on proposed.
        """
        return replace(
            self,
            **{name: getattr(self, name)[:stop] for name in _OF_WINDOWS},
            shared=self.shared.until(stop),
            starts=[[s for s in own if s.window < stop] for own in self.starts],
            dips=[[dip for dip in own if dip.back < stop] for own in self.dips],
        )


def watch(
    axes: list[AxisNormal | None], period: Period, asked: Asked, anew: Anew | None = None, recall: Recall | None = None
) -> Watch:
    """Watch one quantity.

    Parameters
    ----------
    axes : normal states, :func:`.learning.learn_axes`. period : the windows. asked : of the quantity.
    anew : from where axes are learnt anew, default nowhere. recall : of thresholds that were simulated before.
    """
    baseline, shift = period.baseline, period.shift
    starts = (anew or Anew()).starts(len(axes))
    limits = _limits(axes, period, asked.rate, recall or Recall())
    if not asked.services:
        limits = replace(limits, fall=np.full(len(axes), np.inf))
    states, beside, evidence, dips = _settled(axes, starts, limits, period, asked)
    shape = (len(shift), len(axes))
    nothing = {"growth": -np.inf, "fall": -np.inf, "step": -np.inf, "mean": np.nan, "std": np.nan, "shifts": 0}
    told = {
        name: _columns({j: getattr(e, name) for j, e in evidence.items()}, shape, value)
        for name, value in nothing.items()
    }
    seen = {
        name: _columns({j: getattr(state, name) for j, state in states.items()}, shape, False)
        for name in ("learning", "unseen")
    }
    return Watch(
        residual=beside.raw - beside.shared.value,
        std=np.sqrt(beside.variance),
        noise=beside.noise,
        mean_std=told.pop("std"),
        alarm=_alarms(told["growth"], told["step"], limits.level, limits.step) & after_baseline(baseline)[:, None],
        threshold=limits.level,
        step_threshold=limits.step,
        shared=beside.shared,
        axes=axes,
        baseline=baseline,
        starts=starts,
        dips=dips,
        **told,
        **seen,
    )


def _settled(
    axes: Sequence[AxisNormal | None], starts: list[list[Start]], limits: _Limits, period: Period, asked: Asked
) -> tuple[dict[int, WatchedAxis], _Beside, dict[int, Evidence], list[list[Dip]]]:
    """Return the axes that are judged, what they tell of each other, their evidence and the falls that have gone again,
    once no more falls propose a service; those that are found are added to `starts`, and what has grown goes on over
    those that are kept, or is told with them.

    Parameters
    ----------
    limits : of the evidence, that of falls infinite where none proposes a service. period, asked : as of :func:`watch`.
    """
    baseline, shift = period.baseline, period.shift
    dips: list[list[Dip]] = [[] for _ in axes]

    def held(axis: int, own: Sequence[Start], shared: Common | None = None) -> WatchedAxis:
        return WatchedAxis(axes[axis], baseline, shift, own, asked.least, asked.coarsest, shared, asked.common)

    states: dict[int, WatchedAxis] = {}
    after = after_baseline(baseline)
    again = [j for j, axis in enumerate(axes) if axis is not None]
    # Services change what comes after them: found one after the other, until none is left. Each begins with a shift of
    # its own, and goes again in one; the last turn looks for none, so that what is returned holds with all starts.
    for left in reversed(range(1 + 2 * len(np.unique(shift)))):
        states |= {j: held(j, starts[j]) for j in again}
        beside = _beside(states, len(axes), period, asked)
        anew = [j for j in states if starts[j]]
        if asked.common and anew:
            # Of what all axes had in common while one was learnt anew the others tell, and it changes little of that.
            states |= {j: held(j, starts[j], beside.common(j)) for j in anew}
            beside = _beside(states, len(axes), period, asked)
        evidence = {j: state.judge(*beside.of(j)) for j, state in states.items()}
        again = []
        for j in states:
            # Growth after a fall that may be wander counts as far as it would without the fall.
            doubt = doubted(starts[j], len(shift))
            certain = [s for s in starts[j] if not s.doubtful]
            without = held(j, certain, beside.common(j) if asked.common and certain else None) if doubt.any() else None
            if left:
                service = proposed(evidence[j], limits.fall[j], limits.clear[j], shift, baseline, dips[j])
                if service is not None and (later := with_service(starts[j], *service)) is not None:
                    starts[j] = later
                    again.append(j)
                    continue
                if without is not None:
                    stay, gone = gone_again(starts[j], without.judged_residual(beside.of(j)[0]), shift)
                    if gone:
                        starts[j], dips[j] = stay, sorted([*dips[j], *gone], key=lambda dip: dip.window)
                        again.append(j)
                        continue
            if without is not None:
                evidence[j] = evidence[j].at_most(without.judge(*beside.of(j)), doubt)
            if dips[j]:
                evidence[j] = evidence[j].without_steps(after_dips(dips[j], shift))
            alarm = _alarms(evidence[j].growth, evidence[j].step, limits.level[j], limits.step[j]) & after
            if left and (grown := _with_growth(starts[j], states[j], alarm, *beside.of(j)[:2])) is not None:
                starts[j] = grown
                again.append(j)
        if not again:
            break
    for j, state in states.items():
        starts[j] = _with_left(starts[j], state, *beside.of(j)[:2])
    return states, beside, evidence, dips


def _columns(of_axes: dict[int, np.ndarray], shape: tuple[int, int], nothing: float) -> np.ndarray:
    """Return series (w,) of axes as columns of one array of `shape`; `nothing` where an axis has none."""
    result = np.full(shape, nothing)
    for axis, series in of_axes.items():
        result[:, axis] = series
    return result


@dataclass(frozen=True)
class _Limits:
    """Thresholds (n,) of the evidence of each axis; infinite where it is not judged. `clear`: of a fall that is rather
    a service than wander."""

    level: np.ndarray
    step: np.ndarray
    fall: np.ndarray
    clear: np.ndarray


def _limits(axes: Sequence[AxisNormal | None], period: Period, rate: float, recall: Recall) -> _Limits:
    """Return the thresholds for a rate of false alarms, a window and all axes together, and for falls."""
    limits = _Limits(*(np.full(len(axes), np.inf) for _ in range(4)))
    fall_rate, clear_rate = (per_1000_h / 1000 * period.conditions.hours for per_1000_h in (FALL_RATE, CLEAR_RATE))
    judged = {j: axis for j, axis in enumerate(axes) if axis is not None}
    for j, axis in judged.items():
        null = _null_of(axis, period.shift, period.baseline)
        limits.level[j], limits.step[j] = _thresholds(null, rate / len(judged), recall)
        limits.fall[j] = _thresholds(null, fall_rate / len(judged), recall)[0]
        limits.clear[j] = _thresholds(null, clear_rate / len(judged), recall)[0]
    return limits


@dataclass(frozen=True)
class _Beside:
    """What the axes tell of each other, (w, n) unless told.

    `raw`: residual before the shared error is taken out; `noise`: variance that windows do not share; `variance` of the
    residual without the shared error; `extra`: variance that all windows of a shift share; `loud`: factor of the
    variance of a shift but for the noise of its windows; `own` (n,): what that is at least for growth; `calm` (w,):
    bool, whether the axes do not move together.
    """

    shared: SharedError
    raw: np.ndarray
    noise: np.ndarray
    variance: np.ndarray
    extra: np.ndarray
    loud: np.ndarray
    own: np.ndarray
    calm: np.ndarray

    def of(self, axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, np.ndarray]:
        """Return what :meth:`.WatchedAxis.judge` asks of one axis."""
        return self.shared.value[:, axis], self.extra[:, axis], self.loud[:, axis], float(self.own[axis]), self.calm

    def common(self, axis: int) -> Common:
        """Return what one axis has in common with the others, by these alone, (w,) each."""
        return self.shared.value[:, axis], self.shared.variance[:, axis], self.shared.known[:, axis]


def _beside(states: dict[int, WatchedAxis], n: int, period: Period, asked: Asked) -> _Beside:
    """Return what the axes tell of each other; `period` and `asked` are those of :func:`watch`."""
    baseline, shift = period.baseline, period.shift
    shape = (len(shift), n)
    raw = _columns({j: state.residual for j, state in states.items()}, shape, np.nan)
    spread = _columns({j: state.total_variance for j, state in states.items()}, shape, np.nan)
    noise = _columns({j: state.normal.noise for j, state in states.items()}, shape, np.nan)
    beyond = _columns({j: state.normal.design.beyond for j, state in states.items()}, shape, 0.0)
    besides = _columns({j: state.normal.design.besides for j, state in states.items()}, shape, 0.0)
    alike = _columns({j: state.common for j, state in states.items()}, shape, 0.0)
    memory = np.zeros(n)
    for j, state in states.items():
        memory[j] = state.normal.dispersion.memory
    if asked.common:
        besides = (1.0 - COMMON_OF_TEMPERATURE) * besides
        shared = shared_error(raw, spread, baseline, shift, alike, asked.unit)
    else:
        nothing = np.zeros(shape)
        shared = SharedError(nothing, nothing, np.zeros(len(shift)), np.zeros(shape, dtype=bool))
    variance = spread - alike + shared.variance
    outside = outside_baseline(beyond, shared.common, shift)
    apart = raw - shared.value
    judged_with = np.where(before_baseline(baseline)[:, None], np.nan, apart)
    loud = shift_scale(judged_with, variance, noise, memory, shift, outside)
    own = own_scale(apart, variance, noise, memory, shift, baseline)
    extra = shared.variance + besides
    return _Beside(shared, raw, noise, variance, extra, loud, own, _calm(shared.common, shift))


def _alarms(growth: np.ndarray, step: np.ndarray, level: np.ndarray | float, least: np.ndarray | float) -> np.ndarray:
    """Return where the evidence of growth or of a step exceeds its threshold, `level` or `least`."""
    return (growth > level) | (step > least)


def _with_growth(
    starts: Sequence[Start], state: WatchedAxis, alarm: np.ndarray, shared: np.ndarray, extra: np.ndarray
) -> list[Start] | None:
    """Return the starts of an axis, the first kept one that follows on an alarm with the growth until then; None if
    all such have it.

    Without an alarm an axis may have grown by nothing: what it is off by then would become wear of the new program.

    Parameters
    ----------
    alarm : (w,) bool. shared, extra : of :meth:`.WatchedAxis.judge`.
    """
    since = 0
    for k, start in enumerate(starts):
        if start.grown is not None:
            continue
        if start.kept and alarm[since : start.window].any():
            grown = state.grown_between(since, start.window, shared, extra)
            if grown is not None:
                return [*starts[:k], replace(start, grown=grown), *starts[k + 1 :]]
        since = start.window
    return None


def _with_left(starts: Sequence[Start], state: WatchedAxis, shared: np.ndarray, extra: np.ndarray) -> list[Start]:
    """Return the starts of an axis, the kept ones with what it had grown by and is judged without, where that is
    likelier than none.

    Parameters are those of :func:`_with_growth`.
    """
    result, since = [], 0
    for start in starts:
        if start.grown is None:
            grown = state.grown_between(since, start.window, shared, extra) if start.kept else None
            left = shrunk(*grown)[0] if grown is not None and stands_out(*grown) else None
            result.append(replace(start, left=left))
            since = start.window
        else:
            result.append(start)
    return result


def outside_baseline(beyond: np.ndarray, common: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return the windows (w, n) that lie beyond what the baseline saw.

    Those beyond its range, and those of shifts in which, so far, all axes together have risen by more than is a
    finding: oil that is colder than the thermometers of motors tell.

    Parameters
    ----------
    beyond : (w, n) variance of leaving the baseline's range. common : (w,) what the axes have in common, log levels.
    shift : (w,) labels.
    """
    return (beyond > 0) | ~_calm(np.maximum(common, 0.0), shift)[:, None]


def _calm(common: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return the windows (w,) of shifts in which, so far, all axes together stay below what is a finding.

    Parameters
    ----------
    common : (w,) what the axes have in common, log levels. shift : (w,) labels.
    """
    starts = shift_starts(shift)
    return np.abs(running_sums(common, starts)) <= FINDING * running_sums(np.ones(len(common)), starts)


def before_events(baseline: np.ndarray, events: Sequence[Sequence[int]], n: int) -> np.ndarray:
    """Return the windows (w, n) of the baseline before the first event of each axis."""
    place = np.arange(len(baseline))
    return np.stack([baseline & (place < min(events[j], default=len(baseline))) for j in range(n)], axis=1)


def _null_of(axis: AxisNormal, shift: np.ndarray, baseline: np.ndarray) -> Axis:
    """Return what the null runs of one axis depend on."""
    rows = np.isfinite(axis.series_value) & baseline
    usual = float(np.median(np.bincount(shift[rows])[np.unique(shift[rows])])) if rows.any() else _USUAL_WINDOWS
    noise = float(np.nanmedian(axis.noise))
    within = np.sqrt(noise * float(inflated(usual, axis.dispersion.memory)) / usual)
    left = axis.fit.left_out_variance
    normal = float(np.sqrt(np.nanmedian(left))) if np.isfinite(left).any() else _USUAL_NORMAL
    return Axis(axis.dispersion.between, axis.dispersion.spread, normal, float(within), usual).rounded()


def _thresholds(null: Axis, rate: float, recall: Recall) -> list[float]:
    """Return the thresholds of one axis, of level and steps, for a rate of false alarms a window."""
    return recall(key_of("thresholds", null, rate), lambda: [list(null_thresholds(null, rate))])[0]
