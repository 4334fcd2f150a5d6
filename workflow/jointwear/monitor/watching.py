"""Watch one quantity of all axes: normal state, shared error, evidence, alarms, services that a fall proposes."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointwear.monitor.conditions import Conditions, Design
from jointwear.monitor.decision import Evidence, shift_evidence
from jointwear.monitor.dispersion import inflated, updated_between
from jointwear.monitor.growth_so_far import growth_so_far
from jointwear.monitor.learning import AxisNormal, enough, relearnt, widened
from jointwear.monitor.normal_state import Posterior, introduced, taught
from jointwear.monitor.null_runs import Axis, null_thresholds
from jointwear.monitor.recall import Recall, key_of
from jointwear.monitor.shared_error import ALIKE, FINDING, SharedError, shared_error
from jointwear.monitor.shift_scale import shift_scale
from jointwear.monitor.shifts import running_sums

#: Shifts that are learnt from after a service, and fewest windows of them.
RELEARNT_SHIFTS, RELEARNT_WINDOWS = 3, 6
#: Standard deviation of leaving the baseline's range beyond which a window teaches no level, for so many shifts.
FAR, LATEST_SHIFTS = 0.01, 8
#: Windows of a program that the baseline lacks before its level is learnt: the first ones follow on another program,
#: whose heat is still in the joint.
FEWEST_NEW = 3
#: Standard deviation of a prediction beyond which the conditions count as unseen.
UNSEEN = 0.06
#: False falls per 1,000 h, whatever rate is stated: a fall proposes a service, and no rate may decide what is learnt.
FALL_RATE = 0.5
#: Most rounds in which services are looked for.
_MOST_TURNS = 8


@dataclass(frozen=True)
class Start:
    """Window from which an axis is learnt anew; `proposed` by a fall, not told by the config."""

    window: int
    proposed: bool


@dataclass(frozen=True)
class Watch:
    """What became of one quantity, arrays (w, n).

    `residual`: log level less normal state and shared error, NaN where not judged; `std` of a window; `noise`: the
    part of its variance that windows do not share; `growth`, `fall`, `mean`, `mean_std`, `shifts` of
    :class:`~jointwear.monitor.decision.Evidence`; `alarm`: bool; `learning`, `unseen`: why a window is not judged.
    `threshold`, `step_threshold` (n,), of `growth` and of `step`, the last shifts less those before;
    `starts`: per axis; `axes`: normal states, None where the `baseline` (w,) shows too little.
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


def watch(
    axes: list[AxisNormal | None],
    conditions: Conditions,
    baseline: np.ndarray,
    shift: np.ndarray,
    rate: float,
    events: Sequence[Sequence[int]] = (),
    proposed: Sequence[Sequence[int]] = (),
    services: bool = True,
    common: bool = True,
    unit: np.ndarray | float = 1.0,
    recall: Recall | None = None,
) -> Watch:
    """Watch one quantity.

    Parameters
    ----------
    axes : normal states, :func:`jointwear.monitor.learning.learn_axes`. baseline : (w,) bool. shift : (w,) labels.
    rate : false alarms a window that all axes together may have.
    events : per axis, windows at which the config says that something was done to it.
    proposed : the same, found in the logs themselves.
    services : whether falls propose services. common : whether what all axes have in common is taken out.
    unit : (n,) what the axes have in common comes to each in these units, such as its share of viscous friction.
    recall : of thresholds that were simulated before.
    """
    w, n = len(shift), len(axes)
    events, proposed = events or [[]] * n, proposed or [[]] * n
    judged = [j for j in range(n) if axes[j] is not None]
    fields = {name: np.full((w, n), np.nan) for name in ("residual", "std", "noise", "mean", "mean_std")}
    growth, fall, step = (np.full((w, n), -np.inf) for _ in range(3))
    shifts = np.zeros((w, n), dtype=int)
    alarm, learning, unseen = (np.zeros((w, n), dtype=bool) for _ in range(3))
    threshold, steps, falls = (np.full(n, np.inf) for _ in range(3))
    starts: list[list[Start]] = [
        sorted([Start(k, False) for k in e] + [Start(k, True) for k in set(p) - set(e)], key=lambda s: s.window)
        for e, p in zip(events, proposed, strict=True)
    ]
    fall_rate = FALL_RATE / 1000 * conditions.hours
    recall = recall or Recall()
    for j in judged:
        null = _null_of(axes[j], shift, baseline)
        threshold[j], steps[j] = _thresholds(null, rate / len(judged), recall)
        falls[j] = _thresholds(null, fall_rate / len(judged), recall)[0]
    # Services change what comes after them: found one after the other, until none is left.
    shared = SharedError(np.zeros((w, n)), np.zeros((w, n)), np.zeros(w))
    states: dict[int, _Axis] = {}
    beyond, noise, memory = np.zeros((w, n)), np.full((w, n), np.nan), np.zeros(n)
    for j in judged:
        beyond[:, j], noise[:, j], memory[j] = axes[j].design.beyond, axes[j].noise, axes[j].dispersion.memory
    again = judged
    for _ in range(_MOST_TURNS):
        for j in again:
            states[j] = _Axis(axes[j], baseline, shift, starts[j])
        raw, spread = np.full((w, n), np.nan), np.full((w, n), np.nan)
        for j, state in states.items():
            raw[:, j], spread[:, j] = state.residual, state.total_variance
        alike = ALIKE if common else 0.0
        if common:
            shared = shared_error(raw, spread, baseline, shift, beyond, unit)
        variance = spread - alike * beyond + shared.variance
        outside = outside_baseline(beyond, shared.common, shift)
        loud = shift_scale(raw - shared.value, variance, noise, memory, shift, outside)
        calm = _calm(shared.common, shift)
        again = []
        for j, state in states.items():
            extra = shared.variance[:, j] + (1.0 - alike) * beyond[:, j]
            evidence = state.judge(shared.value[:, j], extra, loud[:, j], calm)
            proposed_at = _service(evidence, falls[j], shift, baseline) if services else None
            if proposed_at is not None:
                hit, begin = proposed_at
                kept = [s for s in starts[j] if s.window <= hit]
                if not kept or kept[-1].window < begin:
                    starts[j] = [*kept, Start(begin, True), *(s for s in starts[j] if s.window > hit)]
                    again.append(j)
            state.evidence = evidence
        if not again:
            break
    for j, state in states.items():
        evidence = state.evidence
        fields["residual"][:, j] = state.residual - shared.value[:, j]
        fields["std"][:, j] = np.sqrt(state.total_variance - alike * beyond[:, j] + shared.variance[:, j])
        fields["noise"][:, j] = axes[j].noise
        fields["mean"][:, j], fields["mean_std"][:, j] = evidence.mean, evidence.std
        growth[:, j], fall[:, j], shifts[:, j] = evidence.growth, evidence.fall, evidence.shifts
        step[:, j] = evidence.step
        learning[:, j], unseen[:, j] = state.learning, state.unseen
        alarm[:, j] = ((evidence.growth > threshold[j]) | (evidence.step > steps[j])) & ~baseline
    return Watch(
        **fields, growth=growth, fall=fall, shifts=shifts, alarm=alarm, learning=learning, unseen=unseen,
        threshold=threshold, step=step, step_threshold=steps, shared=shared, axes=axes, baseline=baseline,
        starts=starts,
    )  # fmt: skip


def _service(evidence: Evidence, least: float, shift: np.ndarray, baseline: np.ndarray) -> tuple[int, int] | None:
    """Return the first window after the baseline whose fall exceeds `least`, and the one at which it begins."""
    hits = np.flatnonzero((evidence.fall > least) & ~baseline)
    if not len(hits):
        return None
    first_judged = int(np.flatnonzero(baseline)[-1]) + 1 if baseline.any() else 0
    return int(hits[0]), max(_begin_of_change(hits[0], int(evidence.shifts[hits[0]]), shift), first_judged)


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
    starts = np.concatenate([[True], np.diff(shift) != 0]) if len(shift) else np.zeros(0, dtype=bool)
    return np.abs(running_sums(common, starts)) <= FINDING * running_sums(np.ones(len(common)), starts)


class _Axis:
    """One axis with its segments: the residual of every window against the normal state that holds for it."""

    evidence: Evidence

    def __init__(
        self,
        normal: AxisNormal,
        baseline: np.ndarray,
        shift: np.ndarray,
        starts: Sequence[Start],
    ) -> None:
        self.normal, self.shift = normal, shift
        w = len(shift)
        matrix = normal.design.matrix
        self.residual, self.predicted = np.full(w, np.nan), np.full(w, np.nan)
        self.learning, self.unseen = np.zeros(w, dtype=bool), np.zeros(w, dtype=bool)
        self.segments: list[slice] = []
        self.states: list[Posterior] = []
        self.which = np.zeros(w, dtype=int)
        edges = [0, *[s.window for s in starts], w]
        memory = normal.dispersion.memory
        variance = normal.noise * (1 + memory) / (1 - memory)
        posterior = normal.fit.posterior
        bad = ~np.isfinite(matrix).all(axis=1)
        clean = np.nan_to_num(matrix)
        told = np.zeros(w, dtype=bool)
        for k, (a, b) in enumerate(itertools.pairwise(edges)):
            part = slice(a, b)
            learnt = baseline
            if k > 0:
                learnt = self._after(a, b)
                posterior = relearnt(normal, learnt, shift, widened(normal, posterior)).posterior
                last = int(np.flatnonzero(learnt)[-1]) + 1 if learnt.any() else b
                self.learning[a:last] = True
            # Shifts are runs of windows.
            cuts = a + np.flatnonzero(np.diff(shift[part])) + 1
            for rows in np.split(np.arange(a, b), cuts - a):
                expected, spread = posterior.predict(clean[rows])
                self.residual[rows] = np.where(bad[rows], np.nan, normal.series_value[rows] - expected)
                self.predicted[rows] = spread + normal.design.beyond[rows]
                self.which[rows] = len(self.states)
                self.states.append(posterior)
                fresh = rows[~learnt[rows]]
                waiting, new = _new_programs(normal.design, posterior, a + np.flatnonzero(~learnt[a : rows[-1] + 1]))
                fresh = np.setdiff1d(fresh, waiting)
                # A window tells of a level once, also where the level stays unsure.
                new = new[~told[new]]
                told[new] = True
                if len(new):
                    # What the axis has grown by runs in the new program too: its level is learnt without it.
                    known = self._known(a, rows[-1] + 1, np.union1d(new, waiting))
                    grown, doubt = growth_so_far(normal, self.residual, self.predicted, shift, known)
                    value, between = normal.series_value[new] - grown, normal.dispersion.between**2 + doubt
                    posterior = introduced(posterior, matrix[new], value, variance[new], between)
                posterior = taught(posterior, matrix[fresh], normal.series_value[fresh], variance[fresh])
            self.segments.append(part)
        # In the baseline a window is held against what the other shifts predict for it.
        own = np.isfinite(normal.fit.left_out) & (np.arange(w) < edges[1])
        self.residual[own] = normal.fit.left_out[own]
        self.predicted[own] = normal.fit.left_out_variance[own]
        with np.errstate(invalid="ignore"):
            beyond = (self.predicted > UNSEEN**2) | bad
            self.unseen = beyond & np.isfinite(normal.series_value) & ~own
        hidden = self.unseen | self.learning
        self.residual[hidden] = np.nan
        self.judged = np.isfinite(self.residual) & ~baseline

    def _known(self, a: int, b: int, strange: np.ndarray) -> np.ndarray:
        """Return the windows from `a` to before `b` that are held against a known normal state; none of `strange`."""
        place = np.arange(a, b)
        told = np.isfinite(self.residual[place]) & (self.predicted[place] <= UNSEEN**2)
        return np.setdiff1d(place[told], strange)

    @property
    def total_variance(self) -> np.ndarray:
        """Variance (w,) of the residual of a window."""
        return self.normal.noise + self.normal.dispersion.between**2 + self.predicted

    def _after(self, a: int, b: int) -> np.ndarray:
        """Return the windows (w,) from which the axis is learnt anew: three shifts, and more until there are enough.

        What lies outside the temperatures of the baseline teaches no level, unless nothing else comes for long.
        """
        learnt = np.zeros(len(self.shift), dtype=bool)
        place = np.arange(len(self.shift))
        part = (place >= a) & (place < b)
        seen = np.isfinite(self.normal.series_value)
        usual = seen & (self.normal.design.beyond < FAR**2)
        for count, s in enumerate(np.unique(self.shift[a:b]), start=1):
            learnt |= part & (self.shift == s)
            known = learnt & (usual if count < LATEST_SHIFTS else seen)
            if len(np.unique(self.shift[known])) >= RELEARNT_SHIFTS and known.sum() >= RELEARNT_WINDOWS:
                break
        return learnt & usual if (learnt & usual).sum() >= RELEARNT_WINDOWS else learnt

    def _between(self, residual: np.ndarray) -> np.ndarray:
        """Return the standard deviation between shifts (w,) as known at each window; `residual` (w,) where judged."""
        dispersion = self.normal.dispersion
        names, place = np.unique(self.shift, return_inverse=True)
        rows = np.isfinite(residual)
        weight = np.where(rows, 1.0 / np.where(rows, self.normal.noise, 1.0), 0.0)
        total, count = np.bincount(place, weight, len(names)), np.bincount(place, rows, len(names))
        some = np.where(count > 1, total, np.nan)
        mean = np.bincount(place, weight * np.nan_to_num(residual), len(names)) / some
        own = inflated(count, dispersion.memory) / some
        segment = np.zeros(len(residual), dtype=int)
        for part in self.segments[1:]:
            segment[part.start :] += 1
        last = np.zeros(len(names), dtype=int)
        last[place] = segment
        return updated_between(dispersion, mean, own, last)[place]

    def judge(self, shared: np.ndarray, extra: np.ndarray, loud: np.ndarray, calm: np.ndarray) -> Evidence:
        """Return the evidence of all windows; each segment stands for itself.

        Parameters
        ----------
        shared : (w,) error in common with the other axes. extra : (w,) variance of it, and of leaving the range.
        loud : (w,) factor of all variance of a shift, :mod:`.shift_scale`. calm : (w,) bool, see :func:`_calm`.
        """
        parts = []
        residual = np.where(self.judged, self.residual - shared, np.nan)
        between = self._between(residual)
        value = np.where(self.judged, self.normal.series_value - shared, np.nan)
        for part in self.segments:
            parts.append(
                shift_evidence(
                    value[part],
                    self.normal.noise[part],
                    self.normal.design.matrix[part],
                    self.states,
                    self.which[part],
                    self.shift[part],
                    self.normal.dispersion.memory,
                    between[part],
                    extra[part],
                    (self.normal.design.beyond == 0)[part],
                    loud[part],
                    calm[part],
                )
            )
        names = Evidence.__dataclass_fields__
        return Evidence(**{name: np.concatenate([getattr(p, name) for p in parts]) for name in names})


def _new_programs(design: Design, posterior: Posterior, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which windows of `rows`, all so far, run a program that is not known yet: of one with hardly any windows,
    and of one with enough to learn its level from.

    Known is what can be predicted at the usual temperature, not the constant of the program alone: where a program
    always runs at one load and speed, no data tell its constant from what load and speed do in it, and its windows
    would teach their level, wear among it, for ever.
    """
    waiting, new = np.zeros(len(rows), dtype=bool), np.zeros(len(rows), dtype=bool)
    for c in design.programs:
        own = design.matrix[rows, c] > 0
        if not own.any():
            continue
        usual = design.matrix[rows[own]].copy()
        usual[:, list(design.thermal)] = 0.0
        unknown = posterior.predict(usual)[1] > UNSEEN**2
        if unknown.any():
            target = new if own.sum() >= FEWEST_NEW else waiting
            target[np.flatnonzero(own)[unknown]] = True
    return rows[waiting], rows[new]


def before_events(baseline: np.ndarray, events: Sequence[Sequence[int]], n: int) -> np.ndarray:
    """Return the windows (w, n) of the baseline before the first event of each axis."""
    place = np.arange(len(baseline))
    return np.stack([baseline & (place < min(events[j], default=len(baseline))) for j in range(n)], axis=1)


def _null_of(axis: AxisNormal, shift: np.ndarray, baseline: np.ndarray) -> Axis:
    """Return what the null runs of one axis depend on."""
    rows = np.isfinite(axis.series_value) & baseline
    usual = float(np.median(np.bincount(shift[rows])[np.unique(shift[rows])])) if rows.any() else 8.0
    noise = float(np.nanmedian(axis.noise))
    within = np.sqrt(noise * float(inflated(usual, axis.dispersion.memory)) / usual)
    left = axis.fit.left_out_variance
    normal = float(np.sqrt(np.nanmedian(left))) if np.isfinite(left).any() else 0.01
    return Axis(axis.dispersion.between, axis.dispersion.spread, normal, float(within), int(usual)).rounded()


def _thresholds(null: Axis, rate: float, recall: Recall) -> list[float]:
    """Return the thresholds of one axis, of level and steps, for a rate of false alarms a window."""
    return recall(key_of("thresholds", null, rate), lambda: [list(null_thresholds(null, rate))])[0]


def _begin_of_change(window: int, shifts: int, shift: np.ndarray) -> int:
    """Return the first window of the shifts that the evidence at `window` rests on."""
    names = np.unique(shift)
    place = int(np.searchsorted(names, shift[window]))
    return int(np.argmax(shift == names[max(place - max(shifts, 1) + 1, 0)]))


__all__ = ["Start", "Watch", "before_events", "enough", "watch"]
