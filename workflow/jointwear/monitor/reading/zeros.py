"""From which zero each joint counts: what a replaced encoder or another calibration changes, window by window.

A joint that counts from another zero by some degrees has its gravity torque out of step with its position. Friction,
loads and wrong masses hide that in part, so that friction seems to have grown or fallen. To first order

    residual_i(t) = nuisances_i(t) + angle_j db_i/dq_j(t) + noise_i(t),

b the torque of the bodies, with the nuisances of :mod:`.torque_lag` free in every axis. What a robot file has wrong
looks like an angle too, differently in each program and the same whenever it runs: so a window is held against those of
the baseline in its program, and one joint has to show the same change shift after shift. A part that some windows of
the baseline lift as well makes whole shifts look changed later: a change lies beyond what they show. A part comes and
goes, a zero stays until somebody mends it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from jointwear.files.shown_numbers import number
from jointwear.measurement.derived.even_steps import steps_in
from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.carried import UnitTorques
from jointwear.monitor.reading.model import ModelTorque
from jointwear.monitor.reading.regimes import USUAL, beyond_usual, programs_or_one
from jointwear.monitor.reading.torque_lag import normalised, nuisances
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.robots.dynamics import Dynamics
from jointwear.statistics.known import known_median, known_rms

#: Kind of the finding.
ZERO = "zero"
#: Time [s] between samples that suffices, and fewest and most samples of a piece.
STEP, FEWEST_OF_PIECE, MOST = 0.2, 50, 400
#: Smallest change [rad] that is told, as it takes a twentieth off the steepest gravity torque; in standard deviations
#: of the shifts of the baseline; and shifts in a row, windows of each, that have to show it.
SMALLEST, BEYOND_SCATTER, SHIFTS, WINDOWS = np.radians(3.0), 5.0, 2, 3
#: Standard error [rad] of the angle of a window from which on it tells nothing: what hardly shows in the torques, as
#: the zero of a wrist, does no harm to friction either; and largest angle that is found to first order.
KNOWN, LARGEST = 0.7 * SMALLEST, np.radians(45.0)
#: Standard error of the median of a shift, in those of a mean of its windows (normal law), and how many of them each of
#: the shifts must be off.
OF_MEDIAN, BEYOND = 1.25, 3.0
#: Share of a change that every program has to show.
SHOWS = 0.5
#: Share of the windows of the baseline, on either side, that tell nothing of the range of its angles in a program, and
#: share of a change that has to lie beyond this range.
TAIL, PAST = 0.05, 0.1
#: Share of the evidence of the likeliest joint from which another is named beside it.
AS_LIKELY = 0.8


def angles_of(
    torque: np.ndarray,
    model: ModelTorque,
    motion: tuple[np.ndarray, np.ndarray, np.ndarray],
    used: np.ndarray,
    pieces: Sequence[slice],
    step: float,
    dynamics: Dynamics,
    loads: UnitTorques,
) -> tuple[np.ndarray, np.ndarray]:
    """Return of each joint what each piece of a window tells of its angle: sums (p, n), which add up over pieces.

    The angle is the first [1/rad] over the second [1/rad2].

    Parameters
    ----------
    torque : (m, n) [N m]. model : along the motion, with the loads. motion : position, velocity, acceleration (m, n).
    used : (m, n) samples that count. pieces : samples of each. step : [s] between samples.
    loads : torques of loads at the flange, by samples.
    """
    n = torque.shape[1]
    crossed, shown = np.zeros((2, len(pieces), n))
    thinned = [np.arange(s.start, s.stop, max(steps_in(STEP, step), (s.stop - s.start) // MOST, 1)) for s in pieces]
    enough = [p for p, rows in enumerate(thinned) if len(rows) >= FEWEST_OF_PIECE]
    if not enough:
        return crossed, shown
    # Bodies and loads of all pieces at once: short pieces would cost more in calls than in sums.
    rows = np.concatenate([thinned[p] for p in enough])
    ends = np.cumsum([len(thinned[p]) for p in enough])
    q, v, a = (x[rows] for x in motion)
    (slopes, _), unit = dynamics.torque_slopes(q, v, a), loads.unit(rows)
    gravity, inertial, residual = model.gravity[rows], model.inertial[rows], torque[rows] - model.total[rows]
    counts = used[rows] & np.isfinite(residual)
    for i in range(n):
        bodies = gravity[:, i] + inertial[:, i]
        free = nuisances(v[:, i], a[:, i], gravity[:, i], inertial[:, i], bodies, unit[:, :, i])
        sought = np.column_stack([residual[:, i], slopes[:, i]])
        for p, (begin, end) in zip(enough, pairwise([0, *ends]), strict=True):
            u = begin + np.flatnonzero(counts[begin:end, i])
            if len(u) < FEWEST_OF_PIECE:
                continue
            columns, both = normalised(free[u]), sought[u]
            rest = both - columns @ np.linalg.lstsq(columns, both, rcond=1e-7)[0]
            weight = len(u) / max(float(rest[:, 0] @ rest[:, 0]), 1e-12)
            crossed[p] += weight * (rest[:, 1:].T @ rest[:, 0])
            shown[p] += weight * np.sum(rest[:, 1:] ** 2, axis=0)
    return crossed, shown


@dataclass(frozen=True)
class ChangedZero:
    """A joint (`axes`, 0-based, the likeliest first) that counts from another zero by `angle` [rad] from window `begin`
    on, known from window `known` on, until window `end`, where an event of the config answers it. From window `gone` on
    a program that showed it did no more, None where all do."""

    axes: tuple[int, ...]
    angle: float
    begin: int
    known: int
    end: int
    gone: int | None = None


def changed_zero(
    statistics: WindowStatistics,
    regime: np.ndarray | None,
    shift: np.ndarray,
    baseline: np.ndarray,
    events: Sequence[Sequence[int]],
    doubtful: np.ndarray | None = None,
) -> ChangedZero | None:
    """Return the first change of a zero after the baseline, None where there is none.

    Parameters
    ----------
    regime : (w,) program of each window, -1 unknown, or None for one. shift : (w,) labels. baseline : (w,) bool.
    events : for each axis the windows of the events that a user entered: what follows one is not held against before.
    doubtful : (w,) bool, windows of logs of which samples were refused, default none: they tell nothing.
    """
    w, n = statistics.count.shape
    program = programs_or_one(regime, w)
    shown = statistics.turned_shown
    # Where a torque is cut off at a limit, what is left of it leans to one side.
    cut = (statistics.flags & int(Flag.SATURATED) != 0).any(axis=1)
    left_out = cut if doubtful is None else cut | doubtful
    known = (shown > KNOWN**-2) & ~left_out[:, None]
    angle = np.divide(statistics.turned, shown, out=np.full((w, n), np.nan), where=known)
    angle[np.abs(np.nan_to_num(angle)) > LARGEST] = np.nan
    change = beyond_usual(angle, program, baseline & known.any(axis=1))
    past = _past_range(change, program, baseline)
    shifts = [(s, np.flatnonzero((shift == s) & np.isfinite(change).any(axis=1))) for s in np.unique(shift)]
    shifts = [(s, rows) for s, rows in shifts if len(rows) >= WINDOWS]
    if not shifts:
        return None
    mean = np.array([known_median(change[rows], axis=0) for _, rows in shifts])
    early = np.array([baseline[rows].all() for _, rows in shifts])
    after = after_baseline(baseline)
    late = np.array([after[rows].any() for _, rows in shifts])
    if early.sum() < USUAL:
        return None
    spread = known_rms(mean[early], USUAL)
    # A part that is carried in some windows and found in some of these turns their angles to either side: the median
    # of a few windows of a shift then jumps, that of many in the baseline does not.
    off = [change[rows] - middle for (_, rows), middle in zip(shifts, mean, strict=True)]
    scatter = known_rms(np.concatenate([off[k] for k in np.flatnonzero(early)]))
    counted = np.array([np.isfinite(own).sum(axis=0) for own in off])
    error = OF_MEDIAN * scatter / np.sqrt(np.maximum(counted, 1))
    first = [min((k for k in own if k >= np.flatnonzero(baseline)[-1]), default=w) for own in events]
    with np.errstate(invalid="ignore"):
        least = np.maximum(np.maximum(SMALLEST, BEYOND_SCATTER * spread), BEYOND * error)
        clear = (np.abs(mean) > least) & late[:, None]
        clear &= np.array([known_median(past[rows], axis=0) for _, rows in shifts]) > PAST * np.abs(mean)
    clear &= np.array([[rows[-1] < k for k in first] for _, rows in shifts])
    for k in range(SHIFTS - 1, len(shifts)):
        recent = slice(k - SHIFTS + 1, k + 1)
        same = clear[recent].all(axis=0) & (np.abs(np.sign(mean[recent]).sum(axis=0)) == SHIFTS)
        if not same.any():
            continue
        rows = np.concatenate([r for _, r in shifts[recent]])
        typical = np.median(shown[rows], axis=0)
        evidence = np.where(same, typical * np.median(mean[recent], axis=0) ** 2, 0.0)
        order = [int(j) for j in np.argsort(-evidence) if evidence[j] >= AS_LIKELY * evidence.max() > 0]
        if not order:
            continue
        size = float(np.median(mean[recent], axis=0)[order[0]])
        begin, last = int(rows[0]), int(rows[-1])
        share, answer = change[:, order[0]] / size, first[order[0]]
        if _of_some_programs(share, program, shift, begin, last):
            continue
        # A part that was carried and put away on earlier days may be carried again.
        least = max(SHOWS, SMALLEST / abs(size))
        if _gone_again(share[:begin], program, shift, least) is not None:
            continue
        gone = _gone_again(share[:answer], program, shift, SHOWS, begin)
        return ChangedZero(tuple(order), size, begin, last + 1, answer, gone)
    return None


def _past_range(change: np.ndarray, program: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """Return how far (w, n) [rad] changes lie beyond the range of the baseline's windows of their program, but for a
    few of these; negative within it, NaN unknown.

    Parameters
    ----------
    change : (w, n) [rad], NaN unknown. program : (w,), -1 unknown. baseline : (w,) bool.
    """
    result = np.full(change.shape, np.nan)
    for name in np.unique(program[baseline & (program >= 0)]):
        there = program == name
        for j in range(change.shape[1]):
            seen = change[there & baseline, j]
            seen = seen[np.isfinite(seen)]
            if len(seen):
                low, high = np.quantile(seen, [TAIL, 1 - TAIL])
                result[there, j] = np.maximum(change[there, j] - high, low - change[there, j])
    return result


def _of_some_programs(share: np.ndarray, program: np.ndarray, shift: np.ndarray, begin: int, last: int) -> bool:
    """Return whether some program shows no change of a zero while others do: a part that they lacked before looks like
    one, and a joint that counts from another zero does so in every program.

    Parameters
    ----------
    share : (w,) change of the joint over the one that is looked at, NaN unknown. program : (w,), -1 unknown.
    shift : (w,) labels. begin, last : windows of the shifts that show it.
    """
    place, known = np.arange(len(share)), np.isfinite(share) & (program >= 0)
    since = begin
    for p in np.unique(program[known & (place >= begin) & (place <= last)]):
        # From when on the programs that ran show it, shift by shift back.
        own = known & (program == p) & (place < begin)
        for name in np.unique(shift[own])[::-1]:
            rows = np.flatnonzero(own & (shift == name))
            if np.median(share[rows]) < SHOWS:
                break
            since = min(since, int(rows[0]))
    after = known & (place >= since) & (place <= last)
    seen = [share[after & (program == p)] for p in np.unique(program[after])]
    return any(len(own) >= WINDOWS and np.median(own) < SHOWS for own in seen)


def _gone_again(share: np.ndarray, program: np.ndarray, shift: np.ndarray, least: float, begin: int = 0) -> int | None:
    """Return the window from which on some program that showed a change did not for :data:`SHIFTS` of its shifts; None
    where none did so.

    Parameters
    ----------
    share : (k,) of the first windows, as of :func:`_of_some_programs`. program, shift : (w,) labels.
    least : share from which on a shift shows it. begin : window from which on shifts are looked at.
    """
    place = np.arange(len(share))
    program, shift = program[: len(share)], shift[: len(share)]
    known = np.isfinite(share) & (program >= 0) & (place >= begin)
    found = []
    for p in np.unique(program[known]):
        shown, gone = False, []
        for name in np.unique(shift[known & (program == p)]):
            rows = np.flatnonzero(known & (program == p) & (shift == name))
            if len(rows) < WINDOWS:
                continue
            middle = float(np.median(share[rows]))
            if shown and middle < SHOWS:
                gone.append(int(rows[0]))
            shown |= middle >= least
        if len(gone) >= SHIFTS:
            found.append(gone[0])
    return min(found, default=None)


def zero_finding(statistics: WindowStatistics, found: ChangedZero | None) -> list[dict[str, Any]]:
    """Return a finding on a changed zero, none where there is none."""
    if found is None:
        return []
    joints = " or ".join(str(j + 1) for j in found.axes)
    degrees = number(float(np.degrees(found.angle)), 2)
    words = (
        f"Joint {joints} counts from another zero than in the normal period, by about {degrees} deg: a replaced "
        "encoder, or another calibration. What that does to the torques of all axes looks like friction: growth from "
        f"there on is not to be trusted. Add {degrees} deg to its position in these logs, calibrate it, or "
        "enter the event as 'sensor' for all axes, so that they are learnt anew."
    )
    result = {"time": float(statistics.start[found.begin]), "axes": sorted(j + 1 for j in found.axes), "kind": ZERO}
    if found.gone is not None:
        words = (
            f"The torques were as if joint {joints} counted from another zero than in the normal period, by about "
            f"{degrees} deg, and are as before again: another calibration that was put right, or a part that the robot "
            "carried and no load of the robot file stands for. Growth in these hours is not to be trusted."
        )
        return [{**result, "end": float(statistics.start[found.gone]), "words": words, "answered": True}]
    if found.end < statistics.windows:
        return [{**result, "end": float(statistics.start[found.end]), "words": words, "answered": True}]
    return [{**result, "words": words}]
