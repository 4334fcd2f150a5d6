"""Motion that no known program has: a clock at another speed, a position that stops, two joints exchanged.

A program run at another speed takes other speeds at the same time between samples, a log at another rate another time
at the same speeds. Where both change by the same factor, one up and one down, the rows hold the motion that they always
held, and the clock is what changed: friction and inertia are then seen at speeds that never were.

A joint that keeps its place while the others move as in a program in which it moves has a position that stopped. So
have all joints where none of them moves while their torques change as they do in motion.

Two joints that move as the other one did, while all others move as before, are two columns exchanged, or two labels:
light joints of a wrist resemble each other too much for the model to tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.measurement.checks.time_scale import stretch_in_words
from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.spells import spell_finding, spells
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.regimes import (
    SAME_PROGRAM,
    UNSEEN,
    USUAL,
    beyond_usual,
    differences,
    programs_or_one,
    signatures,
)
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Kinds of the findings.
CLOCK_SPEED, STOPPED, EXCHANGED = "clock_speed", "stopped", "exchanged_joints"
#: Smallest change (log) of a clock that is told, a fifth less what a shift may be off by, and the part that speeds
#: may be off by: a program that windows hold parts of differs by a tenth from shift to shift, both ways (one of 100
#: simulated months).
SMALLEST, AGREES = 0.17, 1 / 3
#: Part of the spread of a torque in motion from which on no arm stands still, on most axes.
SPREAD, MOST = 0.5, 0.5
#: Shifts in a row that show it, and windows of each.
SHIFTS, WINDOWS = 2, 3


def odd_motion_findings(
    statistics: WindowStatistics,
    regime: np.ndarray | None,
    shift: np.ndarray,
    baseline: np.ndarray,
    events: Sequence[Sequence[int]],
) -> list[dict[str, Any]]:
    """Return one finding for each spell of shifts after the baseline in which a clock ran at another speed, a joint
    kept its place, or two moved as the other one did.

    Parameters
    ----------
    regime : (w,) program of each window, -1 unknown, or None for one. shift : (w,) labels. baseline : (w,) bool.
    events : for each axis the windows of the events that a user entered; one of all axes after the begin answers it.
    """
    program = programs_or_one(regime, statistics.windows)
    step, speed = _changes(statistics, program, baseline)
    signature = signatures(statistics)
    centres = _centres(signature, program, baseline)
    still = _stopped(statistics, signature, centres, baseline)
    after = after_baseline(baseline)
    rows = [np.flatnonzero((shift == s) & after) for s in np.unique(shift[after])]
    found = []

    def tell(odd: list[bool], kind: str, words: Any) -> None:
        for part in spells(odd, SHIFTS):
            own = np.concatenate(rows[part])
            axes, text = words(own)
            asked = [events[a - 1] for a in axes] or events
            found.append(spell_finding(statistics, own, axes, kind, text, asked))

    tell([_of_clock(step[r], speed[r]) for r in rows], CLOCK_SPEED, lambda own: ([], _clock_words(step[own])))

    def stops(windows: np.ndarray, fewest: int) -> list[bool]:
        return [windows[r].sum() >= fewest and windows[r].mean() > 0.5 for r in rows]

    for j in range(statistics.axes):
        tell(stops(still[:, j], WINDOWS), STOPPED, lambda own, j=j: ([j + 1], _STOPPED.format(axes=name_axes([j + 1]))))
    for pair, mixed in _exchanged(signature, centres, baseline).items():
        axes = [j + 1 for j in pair]
        tell(stops(mixed, WINDOWS), EXCHANGED, lambda own, a=axes: (a, _EXCHANGED.format(one=a[0], other=a[1])))
    every = list(range(1, statistics.axes + 1))
    tell(stops(_frozen(statistics, baseline), 1), STOPPED, lambda own: (every, _FROZEN))
    return found


_STOPPED = (
    "The position of {axes} stays where it is while all other axes move as in a program in which it moves: its sensor, "
    "or its column in the log. What the other axes need is worked out with a wrong posture: growth from there on is "
    "not to be trusted. If the program was changed, enter it under 'events'."
)
_EXCHANGED = (
    "Joint {one} moves as joint {other} did in the normal period, joint {other} as joint {one} did, and all others as "
    "before: their columns, or their labels, look exchanged in these logs. What is told of either from there on may be "
    "of the other; put the columns right, or enter the new program under 'events' if the motion was changed so."
)
_FROZEN = (
    "The positions of all axes stay where they are while their torques change as in motion: the sensors, or the "
    "columns of the log. Nothing can be judged until they tell where the robot is."
)


def _clock_words(step: np.ndarray) -> str:
    """Return what a changed time between samples (w,), logs over that of the normal period, comes to."""
    looks, mend = stretch_in_words(float(np.exp(known_median(step, axis=0))), 2)
    return (
        f"Against the normal period the time of these logs looks {looks}: rows hold the same path, and lie another "
        "time apart. Speeds and accelerations are wrong by it, and so is all friction from there on; "
        f"{mend}, or leave these logs out."
    )


def _of_clock(step: np.ndarray, speed: np.ndarray) -> bool:
    """Return whether times between samples and speeds (logs, of the windows of a shift) changed as with a clock."""
    known = np.isfinite(step) & np.isfinite(speed)
    if known.sum() < WINDOWS:
        return False
    size = float(np.median(step[known]))
    return abs(size) > SMALLEST and abs(size + float(np.median(speed[known]))) < AGREES * abs(size)


def _changes(statistics: WindowStatistics, program: np.ndarray, baseline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the changes (w,) of the time between samples and of the speed, logs over the baseline in the program."""
    gram = statistics.gram
    with np.errstate(invalid="ignore", divide="ignore"):
        moved = np.where(statistics.count > 0, statistics.count, np.nan)
        values = [
            np.log(statistics.travel / (gram[..., 0, 2] + gram[..., 1, 2])),
            0.5 * np.log(gram[..., 2, 2] / moved),
        ]
    step, speed = (known_median(beyond_usual(value, program, baseline), axis=1) for value in values)
    return step, speed


def _centres(signature: np.ndarray, program: np.ndarray, baseline: np.ndarray) -> list[np.ndarray]:
    """Return the middle signature (2 n,) of every program of the baseline of which enough windows tell it; none of an
    arm of fewer than three joints, whose others tell nothing of one."""
    if signature.shape[1] < 2 * 3:
        return []
    normal = [baseline & (program == p) for p in np.unique(program[baseline & (program >= 0)])]
    return [known_median(signature[own], axis=0) for own in normal if own.sum() >= USUAL]


def _exchanged(
    signature: np.ndarray, centres: list[np.ndarray], baseline: np.ndarray
) -> dict[tuple[int, int], np.ndarray]:
    """Return the windows (w,) in which two 0-based joints, the keys, move as the other one does in a known program."""
    n = signature.shape[1] // 2
    result: dict[tuple[int, int], np.ndarray] = {}
    if not centres:
        return result
    for k in np.flatnonzero(after_baseline(baseline) & np.isfinite(signature).any(axis=1)):
        if differences(signature[k], centres).min() <= UNSEEN:
            continue
        for pair in combinations(range(n), 2):
            order = np.arange(n)
            order[list(pair)] = pair[::-1]
            if differences(signature[k][np.concatenate([order, n + order])], centres).min() <= SAME_PROGRAM:
                result.setdefault(pair, np.zeros(len(signature), dtype=bool))[k] = True
    return result


def _stopped(
    statistics: WindowStatistics, signature: np.ndarray, centres: list[np.ndarray], baseline: np.ndarray
) -> np.ndarray:
    """Return the windows (w, n) in which one joint alone keeps its place, in a program that moves it."""
    n = statistics.axes
    result = np.zeros((len(signature), n), dtype=bool)
    if not centres:
        return result
    strange = (statistics.flags & int(Flag.NOT_FINITE | Flag.OUTSIDE_LIMITS | Flag.REFUSED) != 0).any(axis=1)
    moves = np.isfinite(np.array(centres)[:, :n])
    for k in np.flatnonzero(after_baseline(baseline) & ~strange):
        still = ~np.isfinite(signature[k, :n])
        for centre in np.flatnonzero((moves & still).sum(axis=1) == 1):
            hidden = moves[centre] & still
            if differences(signature[k], [centres[centre]], hidden)[0] <= UNSEEN:
                result[k] |= hidden
    return result


def _frozen(statistics: WindowStatistics, baseline: np.ndarray) -> np.ndarray:
    """Return the windows (w,) in which no joint moves, and the torques of most are spread as in motion.

    Not those with samples that were refused: these are left out of the motion, and it is their torque that was read.
    """
    counts, place = statistics.torque_histogram, np.arange(statistics.torque_histogram.shape[-1], dtype=float)
    with np.errstate(invalid="ignore", divide="ignore"):
        total = counts.sum(axis=-1)
        spread = np.sqrt(counts @ place**2 / total - (counts @ place / total) ** 2)
    rest = statistics.flags & int(Flag.AT_REST) != 0
    refused = (statistics.flags & int(Flag.REFUSED) != 0).any(axis=1)
    usual = known_median(np.where(rest | ~baseline[:, None], np.nan, spread), axis=0)
    with np.errstate(invalid="ignore"):
        wide = spread > SPREAD * np.maximum(usual, 1.0)
    return rest.all(axis=1) & ~refused & (wide.sum(axis=1) > MOST * np.maximum(np.isfinite(usual).sum(), 1))
