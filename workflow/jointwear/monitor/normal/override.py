"""Speeds that the baseline did not have: an operator turns the override of a program down, or up.

A torque that the model lacks (a part that is carried on some moves) follows the path, so that what of it looks like
viscous friction changes with the speed. At a speed that the normal state was not learnt at, the level is off by as much
as that torque is large, on each axis by its own share, from the first window to the last of that speed.

The speed is the mean along the path, the sum of v^2 over that of |v|, in which a slow sample hardly counts: which
samples near stops are left out, beside the switch of a load that is found in one window and not in the next one, moved
the mean over time by 10 %.

An override takes all axes along alike. A log that is short beside the cycle shows another part of it each time, in
which some axes are faster and others slower than on the whole: such a window is not told as one at another speed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jointwear.files.wording import significant
from jointwear.monitor.normal.programs import among_programs
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.regimes import beyond_usual, programs_or_one
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Log of the speed by which a window leaves the range of the baseline before it counts: windows that hold parts of a
#: cycle scatter by less.
BEYOND = 0.05
#: Share of the axes that usually move in a program which has to move in a window that tells the speed of all.
MOST = 0.5
#: Times the standard deviation of its axes by which a window has to be faster or slower for all to be so together.
TOGETHER = 2.0
#: Kind of the finding, and windows from which on it is told: fewer are an arm that waited for something.
OVERRIDE, FEWEST_TOLD = "override", 3


def path_speed(features: np.ndarray) -> np.ndarray:
    """Return the log (w, n) of the mean speed of every axis along its path [rad/s], NaN at rest.

    Parameters
    ----------
    features : (w, n, f), the first two the log of the mean speed over time and that of the root mean square over it.
    """
    return features[..., 0] + 2 * features[..., 1]


def unseen_speed(speed: np.ndarray, regime: np.ndarray | None, baseline: np.ndarray) -> np.ndarray:
    """Return by how much (w,) the log of the speed of all axes together leaves the range that the baseline has in the
    same program; 0 within it, and where the baseline has no such program.

    Parameters
    ----------
    speed : (w, n) of :func:`path_speed`. regime : (w,) program, -1 unknown, or None for one.
    baseline : (w,) bool.
    """
    return _speeds(speed, regime, baseline)[1]


def _speeds(
    speed: np.ndarray, regime: np.ndarray | None, baseline: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the log (w,) of the speed of all axes over the usual one of the same program, NaN unknown, by how much
    (w,) it leaves the range of the baseline, and in which windows (w,) all axes are faster or slower together."""
    program = programs_or_one(regime, len(baseline))
    # Axes that rest have no say; nor have windows in which most of those that usually move do.
    own = beyond_usual(speed, program, baseline)
    moving = np.isfinite(own)
    change, unseen = known_median(own, axis=1), np.zeros(len(baseline))
    for name in np.unique(program[baseline]):
        inside = program == name
        usual = (known_median(moving[inside & baseline], axis=0) > 0).sum()
        change[inside & (moving.sum(axis=1) < MOST * usual)] = np.nan
        known = change[inside & baseline]
        known = known[np.isfinite(known)]
        if len(known):
            below, above = change[inside] - known.min() + BEYOND, change[inside] - known.max() - BEYOND
            unseen[inside] = np.nan_to_num(np.minimum(below, 0.0) + np.maximum(above, 0.0))
    count = np.maximum(moving.sum(axis=1), 1)
    mean = np.where(moving, own, 0.0).sum(axis=1) / count
    spread = np.sqrt((np.where(moving, own - mean[:, None], 0.0) ** 2).sum(axis=1) / count)
    return change, unseen, np.abs(change) >= TOGETHER * spread


def override_findings(
    statistics: WindowStatistics,
    speed: np.ndarray,
    regime: np.ndarray | None,
    baseline: np.ndarray,
    judged: np.ndarray,
) -> list[dict[str, Any]]:
    """Return the finding on speeds that the baseline lacks, as of :func:`unseen_speed`; none where there is none, or
    where the axes do not change together.

    Parameters
    ----------
    judged : (w,) bool, whether most axes are.
    """
    change, unseen, together = _speeds(speed, regime, baseline)
    rows = np.flatnonzero((unseen != 0) & together & after_baseline(baseline))
    if len(rows) < FEWEST_TOLD:
        return []
    hours = statistics.length / 3600
    sides = [own for own in (rows[unseen[rows] < 0], rows[unseen[rows] > 0]) if len(own)]
    # Slower and faster hours are two things: a span from one to the other would hold the usual speed.
    times = " and ".join(
        f"{len(own) * hours:.3g} h at {_span(np.exp(change[own]))} times its usual speed" for own in sides
    )
    known = f"{judged[rows].sum() * hours:.3g} h of them judged" if judged[rows].any() else "none of them judged yet"
    where = among_programs(statistics.labels, regime, rows)
    begin = f"{where[:1].upper()}{where[1:]} the robot" if where else "The robot"
    words = (
        f"{begin} ran {times}, which the normal period did not have, {known}: what another speed changes has to be "
        "learnt first. If it often runs so, name the override under 'program', or let the normal period hold it."
    )
    return [{"time": float(statistics.start[rows[0]]), "axes": [], "kind": OVERRIDE, "words": words}]


def _span(factors: np.ndarray) -> str:
    """Return the span of factors (k,) in words, one number where its ends round to the same."""
    low, high = (significant(float(x), 2) for x in (factors.min(), factors.max()))
    return low if low == high else f"{low} to {high}"
