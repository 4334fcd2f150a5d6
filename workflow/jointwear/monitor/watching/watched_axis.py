"""One axis that is watched: the normal state of each of its segments, and what its windows are against it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.conditions import COMMON_OF_TEMPERATURE, Design
from jointwear.monitor.normal.dispersion import inflated, updated_between
from jointwear.monitor.normal.learning import AxisNormal, relearnt, widened
from jointwear.monitor.normal.normal_state import Posterior, introduced, taught
from jointwear.monitor.normal.recent_shifts import AxisWindows
from jointwear.monitor.reading.after_baseline import after_baseline, before_baseline
from jointwear.monitor.watching.decision import Evidence, shift_evidence
from jointwear.monitor.watching.growth_so_far import SHIFTS, growth_so_far, measured_growth

#: What all axes have in common, (w,) log level, its variance (w,), and whether it is known (w,).
Common = tuple[np.ndarray, np.ndarray, np.ndarray]

#: Shifts that are learnt from after a service, and fewest windows of them.
RELEARNT_SHIFTS, RELEARNT_WINDOWS = 3, 6
#: Standard deviation of leaving the baseline's range beyond which a window teaches no level, for so many shifts.
FAR, LATEST_SHIFTS = 0.01, 8
#: Windows of a program that the baseline lacks before its level is learnt: the first ones follow on another program,
#: whose heat is still in the joint.
FEWEST_NEW = 3
#: Standard deviation of a prediction of friction beyond which the conditions count as unseen.
UNSEEN = 0.06


@dataclass(frozen=True)
class Start:
    """Window from which an axis is learnt anew; `proposed` by a fall, not told by the config; `kept`: the axis is as
    worn as before, so that its alarms stay open; `grown`: growth (log level) and its variance that go on over it, None
    where no alarm tells of any; `left`: growth (log level) that stood before it without an alarm and that the axis is
    judged without from there on, None where there was rather none; `doubtful`: proposed by a fall that the wander of
    friction may be too, :mod:`.falls`."""

    window: int
    proposed: bool
    kept: bool = False
    grown: tuple[float, float] | None = None
    left: float | None = None
    doubtful: bool = False

    @property
    def closes(self) -> bool:
        """Whether it closes the alarms before it: what somebody did to the axis or has looked at."""
        return not self.proposed and not self.kept


class WatchedAxis:
    """One axis with its segments: the residual of every window against the normal state that holds for it.

    What all axes have in `common` while it is learnt anew is no part of its level: it is taken out of what is judged.
    `alike`: the other axes tell what all have in common beyond the temperatures of the baseline, so that it is no doubt
    of this one alone.
    """

    def __init__(
        self,
        normal: AxisNormal,
        baseline: np.ndarray,
        shift: np.ndarray,
        starts: Sequence[Start],
        least: float,
        coarsest: float,
        common: Common | None = None,
        alike: bool = True,
    ) -> None:
        self.normal, self.shift, self.least, self.coarsest = normal, shift, least, coarsest
        w = len(shift)
        matrix = normal.design.matrix
        self.residual, self.predicted = np.full(w, np.nan), np.full(w, np.nan)
        self.common = np.zeros(w)
        self.learning, self.unseen = np.zeros(w, dtype=bool), np.zeros(w, dtype=bool)
        self.segments: list[slice] = []
        self.states: list[Posterior] = []
        self.which = np.zeros(w, dtype=int)
        edges = [0, *[s.window for s in starts], w]
        self._judgeable, self._history = after_baseline(baseline), before_baseline(baseline)
        memory = normal.dispersion.memory
        variance = normal.noise * (1 + memory) / (1 - memory)
        posterior = normal.fit.posterior
        bad = ~np.isfinite(matrix).all(axis=1)
        clean = np.nan_to_num(matrix)
        told = np.zeros(w, dtype=bool)
        for k, (a, b) in enumerate(itertools.pairwise(edges)):
            part = slice(a, b)
            # What came before the baseline is not known to be normal, and teaches no more.
            learnt = ~self._judgeable
            if k > 0:
                learnt = self._after(a, b, starts[k - 1].proposed)
                besides = _besides(starts[k - 1], learnt & np.isfinite(normal.series_value), common)
                posterior = relearnt(normal, learnt, shift, widened(normal, posterior), besides)
                last = int(np.flatnonzero(learnt)[-1]) + 1 if learnt.any() else b
                self.learning[a:last] = True
            # Shifts are runs of windows.
            cuts = a + np.flatnonzero(np.diff(shift[part])) + 1
            for rows in np.split(np.arange(a, b), cuts - a):
                expected, spread = posterior.predict(clean[rows])
                self.residual[rows] = np.where(bad[rows], np.nan, normal.series_value[rows] - expected)
                self.predicted[rows] = spread + normal.design.besides[rows]
                apart = posterior.given(normal.design.alike if alike else ())
                if alike:
                    self.common[rows] = COMMON_OF_TEMPERATURE * normal.design.besides[rows]
                if apart is not posterior:
                    self.common[rows] += spread - apart.predict(clean[rows])[1]
                self.which[rows] = len(self.states)
                self.states.append(apart)
                fresh = rows[~learnt[rows]]
                waiting, new = _new_programs(
                    normal.design, posterior, a + np.flatnonzero(~learnt[a : rows[-1] + 1]), coarsest
                )
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
            beyond = (self.predicted > coarsest**2) | bad
            self.unseen = beyond & np.isfinite(normal.series_value) & ~own
        hidden = self.unseen | self.learning
        self.residual[hidden] = np.nan
        self.judged = np.isfinite(self.residual) & self._judgeable

    def _known(self, a: int, b: int, strange: np.ndarray) -> np.ndarray:
        """Return the windows from `a` to before `b` that are held against a known normal state; none of `strange` or
        before the baseline."""
        place = np.arange(a, b)
        told = np.isfinite(self.residual[place]) & (self.predicted[place] <= self.coarsest**2)
        told &= ~self._history[place]
        return np.setdiff1d(place[told], strange)

    def grown_between(self, a: int, b: int, shared: np.ndarray, extra: np.ndarray) -> tuple[float, float] | None:
        """Return what the last shifts from window `a` to before `b` show of growth, and its variance; None if nothing.

        `shared`, `extra` : those of :meth:`judge`.
        """
        known = self._known(a, b, np.flatnonzero(self.learning | ~self._judgeable))
        known = known[np.isin(self.shift[known], np.unique(self.shift[known])[-SHIFTS:])]
        measured = measured_growth(self.normal, self.residual - shared, self.predicted, self.shift, known)
        if measured is None:
            return None
        # The normal state is learnt anew from `b`: what is not known of it by then all windows before share.
        return measured[0], measured[1] + float(np.median((self.predicted + extra)[known]))

    @property
    def total_variance(self) -> np.ndarray:
        """Variance (w,) of the residual of a window."""
        return self.normal.noise + self.normal.dispersion.between**2 + self.predicted

    def _after(self, a: int, b: int, proposed: bool) -> np.ndarray:
        """Return the windows (w,) from which the axis is learnt anew: three shifts, and more until there are enough.

        What lies far outside the temperatures of the baseline teaches no level, unless nothing else comes for long.
        After a start that is but `proposed`, as by a fall, nothing outside them does: what fell may be an error of the
        normal state there, and its level would be held against every other day.
        """
        learnt = np.zeros(len(self.shift), dtype=bool)
        place = np.arange(len(self.shift))
        part = (place >= a) & (place < b)
        seen = np.isfinite(self.normal.series_value)
        beyond = self.normal.design.beyond
        usual = seen & (beyond == 0 if proposed else beyond < FAR**2)
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

    def judged_residual(self, shared: np.ndarray) -> np.ndarray:
        """Return the residual (w,) less what all axes share, NaN where a window is not judged."""
        return np.where(self.judged, self.residual - shared, np.nan)

    def judge(self, shared: np.ndarray, extra: np.ndarray, loud: np.ndarray, own: float, calm: np.ndarray) -> Evidence:
        """Return the evidence of all windows; each segment stands for itself.

        Parameters
        ----------
        shared : (w,) error in common with the other axes. extra : (w,) variance of it, and of leaving the range.
        loud : (w,) factor of the variance of a shift but for the noise of its windows, :mod:`.shift_scale`. own : what
        it is at least for growth.
        calm : (w,) bool, where all axes together have moved too little for a finding: one shift may be a large step.
        """
        residual = self.judged_residual(shared)
        windows = AxisWindows(
            value=np.where(self.judged, self.normal.series_value - shared, np.nan),
            variance=self.normal.noise,
            design=self.normal.design.matrix,
            which=self.which,
            shift=self.shift,
            between=self._between(residual),
            extra=extra,
            inside=self.normal.design.beyond == 0,
            scale=loud,
            calm=calm,
        )
        if (loud >= own).all():
            return self._evidence(windows)
        return self._evidence(replace(windows, scale=np.maximum(loud, own))).with_falls(self._evidence(windows))

    def _evidence(self, windows: AxisWindows) -> Evidence:
        memory = self.normal.dispersion.memory
        parts = [shift_evidence(windows.part(rows), self.states, memory, self.least) for rows in self.segments]
        return Evidence(*(np.concatenate(p) for p in zip(*(vars(e).values() for e in parts), strict=True)))


def _besides(start: Start, learnt: np.ndarray, common: Common | None) -> tuple[np.ndarray | float, float]:
    """Return what windows `learnt` (w,) from a start on show besides the new level of an axis, (w,) or one number (log
    level), and the variance of the level from that: growth that goes on, and what all axes have in common.

    Where too few other axes tell what that is, nothing is taken out: axes learnt anew together are told no error by it.
    """
    growth, doubt = start.grown or (0.0, 0.0)
    if common is None or not learnt.any():
        return growth, doubt
    value, variance, known = common
    # Windows err alike, by the slope of the axis over what all have in common, so that more of them tell no better.
    return growth + np.where(known, value, 0.0), doubt + float(np.median(np.where(known, variance, 0.0)[learnt]))


def _new_programs(
    design: Design, posterior: Posterior, rows: np.ndarray, coarsest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return which windows of `rows`, all so far, run a program that is not known yet: of one with hardly any windows,
    and of one with enough to learn its level from.

    Known is what can be predicted at the usual temperature, not the constant of the program alone: where a program
    always runs at one load and speed, no data tell its constant from what load and speed do in it, and its windows
    would teach their level, wear among it, for ever.
    """
    waiting, new = np.zeros(len(rows), dtype=bool), np.zeros(len(rows), dtype=bool)
    for c in design.programs:
        own = design.matrix[rows, c] != 0
        if not own.any():
            continue
        usual = design.matrix[rows[own]].copy()
        usual[:, list(design.thermal)] = 0.0
        unknown = posterior.predict(usual)[1] > coarsest**2
        if unknown.any():
            target = new if own.sum() >= FEWEST_NEW else waiting
            target[np.flatnonzero(own)[unknown]] = True
    return rows[waiting], rows[new]
