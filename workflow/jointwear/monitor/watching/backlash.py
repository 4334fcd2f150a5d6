"""Backlash: growth of the torque pulses at reversals of the load, beside the torque of the rest of the motion.

The pulses (:mod:`.reversals`) are judged as friction is: the log of their ratio, window by window, is
held against its normal state under the conditions of the window, and growth over the last shifts is decided on. It
alarms where that growth also exceeds :data:`LEAST`: a pulse follows the cube root of the gap, so that what is worth a
look at the gear shows at least so much; and where it outlasts a batch (:func:`lasting`). The change that is told is
that of the pulses [%]; how large the gap is would take a second encoder.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.monitor.normal.dispersion import Q80
from jointwear.monitor.normal.series import Series
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.lasting_alarms import is_open, told_windows
from jointwear.monitor.watching.records import DETECTORS, UNJUDGED, Grown, record
from jointwear.monitor.watching.watching import Watch

BACKLASH = "backlash"
#: Growth of the log of the pulses that is worth an alarm: by a quarter.
LEAST = float(np.log(1.25))
#: Standard deviation of what a window's conditions let expect beyond which it is not judged: growth that is worth an
#: alarm is two of them. By that of friction, a quarter of it, an axis whose pulses grew to three times their size was
#: judged in 15 % of its windows.
COARSEST = LEAST / 2
#: Fewest windows of a batch, and shifts after which one stands for itself.
FEWEST_OF_BATCH, LONG = 3, 6
#: Hours after which an alarm that lasts is told again.
REPEAT_HOURS = 168.0
#: Samples near and far of a window that suffice; samples that count as one, because the quick part is smooth.
FEWEST_SAMPLES, COUNT_AS_ONE = 30, 4.0
#: Reversals in motion of a window that suffice, and share of the baseline's windows that must show them.
FEWEST_TURNS, MOST_WINDOWS = 3, 0.5
#: Body torque over friction (root mean square) below which the load of the gear reverses with the motion: half of the
#: friction acts behind the gap at most, and the load has to be well above that.
LIGHT = 0.75
#: Share of the noise of the regression that the quick part of the residual must stand out of: below, quantised or
#: filtered torque hides it, or so does what the model misses.
QUICKEST = 0.02
#: Noise of the regression (standard deviation) over Coulomb friction from which on it is what the model misses:
#: on axes that carry a load which the robot file lacks it is 0.13 to 0.7, and its quick part 0.05 or less.
MISSED = 0.2


def backlash_series(statistics: WindowStatistics, usable: np.ndarray) -> Series:
    """Return the log of the pulses near reversals of the load over those far from them.

    Parameters
    ----------
    usable : (n,) bool, :func:`hidden_because` gives no reason.
    """
    near, far = statistics.near_count.astype(float), statistics.far_count.astype(float)
    known = (near >= FEWEST_SAMPLES) & (far >= FEWEST_SAMPLES) & (statistics.turns >= FEWEST_TURNS)
    known &= statistics.judgeable & usable
    known &= (statistics.pulse_near > 0) & (statistics.pulse_far > 0)
    with np.errstate(all="ignore"):
        ratio = (statistics.pulse_near / near) / (statistics.pulse_far / far)
        value = np.where(known, 0.5 * np.log(ratio), np.nan)
        variance = np.where(known, 0.5 * COUNT_AS_ONE * (1 / near + 1 / far), np.nan)
    n = statistics.axes
    return Series(value, variance, np.ones(n), np.ones(n))


@dataclass(frozen=True)
class LeftOfTorque:
    """Mean squares (n,) [(N m)^2] of what the regression leaves of the torque of each axis in some windows: the `noise`
    of all of it, and its `quick` part, of pulses of a tenth of a second."""

    noise: np.ndarray
    quick: np.ndarray

    @property
    def slow(self) -> np.ndarray:
        """Whether next to nothing of it is quick, (n,) bool."""
        return self.quick < QUICKEST * self.noise

    def missed_by_model(self, level: np.ndarray) -> np.ndarray:
        """Return where it is torque that the model misses, (n,) bool; `level` (n,) of Coulomb friction [N m]."""
        return self.slow & (level > 0) & (np.sqrt(self.noise) > MISSED * level)


def left_of_torque(statistics: WindowStatistics, baseline: np.ndarray) -> LeftOfTorque:
    """Return what the regression leaves of each axis in those windows of the baseline (w,) bool in which it moves."""
    rows = baseline[:, None] & (statistics.count > 0)

    def mean(square: np.ndarray, number: np.ndarray) -> np.ndarray:
        return np.where(rows, square, 0.0).sum(axis=0) / np.maximum(np.where(rows, number, 0).sum(axis=0), 1)

    return LeftOfTorque(
        noise=mean(statistics.residual_square, statistics.freedom),
        quick=mean(statistics.pulse_far, statistics.far_count),
    )


def hidden_because(statistics: WindowStatistics, coulomb: np.ndarray, baseline: np.ndarray) -> list[str]:
    """Return for each axis why its backlash cannot be judged; empty where it can.

    Parameters
    ----------
    coulomb : (n, 2) levels [N m], nominal or, where the robot file has none, of the baseline. baseline : (w,) bool.
    """
    reasons = []
    moved = baseline[:, None] & (statistics.count > 0)
    left = left_of_torque(statistics, baseline)
    missed = left.missed_by_model(coulomb.mean(axis=1))
    for j in range(statistics.axes):
        rows = moved[:, j]
        count = max(int(statistics.count[rows, j].sum()), 1)
        gathered = statistics.near_count[rows, j].sum() + statistics.far_count[rows, j].sum()
        load = np.sqrt(np.trace(statistics.gram[rows, j, 3:, 3:].sum(axis=0)) / count)
        turns = statistics.turns[rows, j] >= FEWEST_TURNS
        short = (statistics.near_count[rows, j] < FEWEST_SAMPLES) | (statistics.far_count[rows, j] < FEWEST_SAMPLES)
        if not rows.any():
            reasons.append("it rests in the baseline")
        elif not gathered:
            reasons.append("its samples lie too far apart, or its moves are too short, for pulses of 0.1 s")
        elif turns.mean() < MOST_WINDOWS:
            reasons.append("its load keeps one direction, so that the gear stays on one flank")
        elif load < LIGHT * coulomb[j].mean():
            reasons.append("its load is mostly friction, which reverses with the motion")
        elif short.mean() > MOST_WINDOWS:
            reasons.append("too little of its motion is clear of rests and turns")
        elif missed[j]:
            reasons.append("the model misses too much of its torque (a payload?)")
        elif left.slow[j]:
            reasons.append("the torque in the log is filtered too much to show pulses of a tenth of a second")
        else:
            reasons.append("")
    return reasons


def lasting(watched: Watch, program: np.ndarray | None, shift: np.ndarray) -> Watch:
    """Return what was watched, with those alarms alone that outlast a batch: the run of one program.

    Poses that are taught anew for a batch, by a third of a degree, move the pulses by a quarter or more until the next
    one; a gap in the gear stays. An alarm is one of growth beyond :data:`LEAST` that the batch before shows too, or
    that has lasted for :data:`LONG` shifts of this one.

    Parameters
    ----------
    program : (w,) of each window, -1 unknown, or None for one. shift : (w,) labels.
    """
    with np.errstate(invalid="ignore"):
        alarm = watched.alarm & (watched.mean > LEAST)
    if program is not None:
        for j, starts in enumerate(watched.starts):
            for k in np.flatnonzero(alarm[:, j]):
                since = max([s.window for s in starts if s.window <= k], default=0)
                until = slice(0, k + 1)
                alarm[k, j] = _outlasts_a_batch(watched.residual[until, j], program[until], shift[until], since)
    return replace(watched, alarm=alarm)


def _outlasts_a_batch(growth: np.ndarray, program: np.ndarray, shift: np.ndarray, since: int) -> bool:
    """Return whether the growth (w,), NaN unknown, at the last window is more than that of one batch.

    Where there is one program, or programs take turns all the time, nothing tells of batches.

    Parameters
    ----------
    program, shift : (w,) labels. since : window from which on the axis is as it is now.
    """
    batches = _batches(program)
    if len({int(program[run[0]]) for run in batches}) < 2:
        return True
    shown = [run[(run >= since) & np.isfinite(growth[run])] for run in batches]
    shown = [run for run in shown if len(run) >= FEWEST_OF_BATCH]
    if not shown or not np.mean(growth[shown[-1]]) > LEAST:
        return False
    lasted = len(np.unique(shift[shown[-1]])) >= LONG
    return lasted or (len(shown) > 1 and bool(np.mean(growth[shown[-2]]) > LEAST))


def _batches(program: np.ndarray) -> list[np.ndarray]:
    """Return the windows in runs of one program (w,), as if runs of few windows, or of none that is known, were not."""

    def runs(of: np.ndarray) -> list[np.ndarray]:
        cuts = np.flatnonzero(np.diff(program[of])) + 1
        return [run for run in np.split(of, cuts) if len(run) >= FEWEST_OF_BATCH]

    long = runs(np.flatnonzero(program >= 0))
    return runs(np.concatenate(long)) if long else []


def backlash_alarms(watched: Watch) -> np.ndarray:
    """Return where (w, n) backlash is alarming."""
    with np.errstate(invalid="ignore"):
        return watched.alarm & (watched.mean > LEAST)


def backlash_records(statistics: WindowStatistics, watched: Watch) -> list[dict[str, Any]]:
    """Return the rows of alarms.csv; an alarm that lasts is told again after :data:`REPEAT_HOURS`, and one that comes
    after a repair is a new one."""
    result = []
    alarm = backlash_alarms(watched)

    def is_news(last: int, now: int, again: bool) -> bool:
        return float(statistics.end[now] - statistics.end[last]) >= 3600 * REPEAT_HOURS

    for j in range(statistics.axes):
        for k in np.flatnonzero(told_windows(alarm[:, j], watched.starts[j], is_news)):
            mean, error = watched.mean[k, j], watched.mean_std[k, j]
            change = [100 * float(np.expm1(v)) for v in (mean, mean - Q80 * error, mean + Q80 * error)]
            grown = Grown(change, "%", change)
            result.append(record(statistics.end[k], j + 1, BACKLASH, grown, np.nan, None, DETECTORS[0]))
    return result


def raised_status(status: np.ndarray, watched: Watch, changed: str) -> np.ndarray:
    """Return the status (w, n) with `changed` from the first alarm of backlash until an event of the config."""
    result, alarm = status.copy(), backlash_alarms(watched)
    for j in range(status.shape[1]):
        open_ = is_open(alarm[:, j], watched.starts[j])
        result[open_, j] = np.where(status[open_, j] == UNJUDGED, UNJUDGED, changed)
    return result


def backlash_findings(reasons: list[str], time: float) -> list[dict[str, Any]]:
    """Return one finding on all axes whose backlash cannot be judged, with each reason, or none.

    Parameters
    ----------
    reasons : of :func:`hidden_because`, (n,). time : of the finding [s].
    """
    told, all_axes = [], []
    for reason in dict.fromkeys(r for r in reasons if r):
        axes = [j + 1 for j, r in enumerate(reasons) if r == reason]
        all_axes += axes
        told.append(f"of {name_axes(axes)}: {_plural(reason, len(axes) > 1)}")
    if not told:
        return []
    words = f"Backlash cannot be judged {'; '.join(told)}."
    return [{"time": time, "axes": sorted(all_axes), "kind": BACKLASH, "words": words}]


def _plural(reason: str, many: bool) -> str:
    if not many:
        return reason
    words = {"it rests": "they rest", "its load keeps": "their loads keep", "its load is": "their load is"}
    for one, more in {
        **words,
        "its samples": "their samples",
        "its moves": "their moves",
        "its motion": "their motion",
        "its torque": "their torque",
    }.items():
        reason = reason.replace(one, more)
    return reason
