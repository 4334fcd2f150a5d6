"""Torques that grow uneven: of one axis while the others keep still, a fault of that axis; of most, one of the logs.
Torques of most axes that grow smooth: these are computed or filtered, no longer measured as they were.

Windows several times as loud as those of the baseline are not judged, whatever the cause. Where it is one axis,
shift after shift, no load and no unit does that: play, a damaged bearing, a loose sensor. Where it is most of them, the
samples do not belong together as they did. What is only left out would be called healthy. A noise that some windows of
the baseline show as well, such as that of a part that the robot carries now and then, is none of these.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.spells import spell_finding, spells
from jointwear.monitor.normal.series import LOUDEST, loud_windows
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Kinds of the findings, of one axis and of most.
LOUD, UNEVEN, SMOOTH = "loud", "uneven", "smooth"
#: Share of the windows of a shift in which an axis moves that are loud, fewest of them, and shifts in a row. On an
#: outside fleet a gear with play had all of them; of 31 other robots one had 11 of 16, 9 of 15 and 9 of 14 on an axis
#: beside a worn one, never two shifts in a row, the others 2 of 8 at most.
LOUD_SHARE, FEWEST_WINDOWS, SHIFTS = 0.75, 3, 2
#: Quick noise (standard deviation, from sample to sample) of the baseline over that of a smooth window. In shifts of 50
#: healthy and worn robots of three outside fleets it is at most 1.35 on the axis in the middle, in logs that hold the
#: torque of a model 2.2 and more.
SMOOTHER = 2.0
#: Share of the windows of the baseline that tell nothing of how loud they are, and how many times as loud as the others
#: a window has to be to be news: the noise of one part differs by less.
TAIL, NEWS = 0.05, 1.25
#: Share of the axes from which on the cause is not one of them.
MOST_AXES = 0.5


def loud_findings(
    statistics: WindowStatistics, shift: np.ndarray, baseline: np.ndarray, events: Sequence[Sequence[int]]
) -> list[dict[str, Any]]:
    """Return one finding for each axis that became loud after the baseline, from its first loud shift on, and one for
    each spell of shifts in which most did.

    Parameters
    ----------
    shift : (w,) of each window. baseline : (w,) bool. events : for each axis the windows of the events that a user
        entered; one after the finding answers it.
    """
    moved = (statistics.count > 0) & statistics.judgeable
    noise = np.sqrt(statistics.noise_variance)
    loud = loud_windows(statistics, baseline) & _news(noise, baseline[:, None] & moved)
    names = np.unique(shift[~baseline])
    rows = [np.flatnonzero((shift == name) & ~baseline) for name in names]
    share, many = _of_shifts(loud & moved, moved, rows)
    usual = known_median(np.where(baseline[:, None], noise, np.nan), axis=0)
    result = []
    for j in range(statistics.axes):
        run = 0
        for k in range(len(names)):
            alone = np.mean(share[k] >= LOUD_SHARE) < MOST_AXES
            if not moved[rows[k], j].any():
                continue
            run = run + 1 if share[k, j] >= LOUD_SHARE and many[k, j] and alone else 0
            if run < SHIFTS:
                continue
            begin = int(rows[k - SHIFTS + 1][0])
            # It may have been mended, or have turned out to come and go.
            odd = (loud & moved)[begin:, j]
            times = float(np.median(noise[begin:, j][odd]) / usual[j])
            answered = {"answered": True} if any(window >= begin for window in events[j]) else {}
            words = (
                f"What the model leaves of the torque of axis {j + 1} is {times:.2g} times as large as in the normal "
                "period, shift after shift, and that of the other axes is not: play in the gear, a damaged bearing, a "
                "loose fastening or a fault of its sensor. Such hours are not judged for growth of friction; look at "
                "this axis, and enter what was done under 'events'."
            )
            found = {"time": float(statistics.start[begin]), "axes": [j + 1], "kind": LOUD, "words": words}
            result.append({**found, **answered})
            break
    quick = np.sqrt(statistics.noise_variance * (1 - statistics.autocorrelation))
    with np.errstate(invalid="ignore"):
        smooth = quick * SMOOTHER < known_median(np.where(baseline[:, None], quick, np.nan), axis=0)
    # Another filter that turns later is told as such, and taken out.
    smooth &= statistics.flags & int(Flag.LATER) == 0
    for kind, times, odd, words in ((UNEVEN, LOUDEST, loud, _UNEVEN), (SMOOTH, SMOOTHER, smooth, _SMOOTH)):
        for own, axes in _spells(odd & moved, moved, rows):
            told = words.format(axes=name_axes(axes), times=f"{times:.0f}")
            result.append(spell_finding(statistics, own, axes, kind, told, events))
    return result


_UNEVEN = (
    "What the model leaves of the torques of {axes} is more than {times} times as large as in the normal period, shift "
    "after shift: positions that are coarser or held, rows that do not belong together, another robot, or another "
    "load. Such hours are not judged; look at how these logs are written."
)
_SMOOTH = (
    "The torques of {axes} are more than {times} times as smooth from sample to sample as in the normal period, shift "
    "after shift: they look computed by a model, or filtered, and not measured as before. Growth of friction from "
    "there on is not to be trusted; look at how these logs are written."
)


def _news(noise: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return the windows (w, n) that are louder than those of the baseline, but for a few of these.

    Parameters
    ----------
    noise : (w, n) standard deviation of the noise [N m]. known : (w, n) bool, windows of the baseline that tell of it.
    """
    result = np.zeros(noise.shape, dtype=bool)
    for j, own in enumerate(known.T):
        seen = noise[own & np.isfinite(noise[:, j]), j]
        if len(seen):
            result[:, j] = noise[:, j] > NEWS * np.quantile(seen, 1 - TAIL)
    return result


def _spells(odd: np.ndarray, moved: np.ndarray, rows: list[np.ndarray]) -> list[tuple[np.ndarray, list[int]]]:
    """Return the windows of each spell of shifts in which most axes are odd, and which axes (1-based) these are.

    Parameters
    ----------
    odd, moved : (w, n) bool; only axes that moved are odd. rows : windows of each shift after the baseline.
    """
    rows = [r for r in rows if moved[r].any()]
    share, many = _of_shifts(odd, moved, rows)
    most = ((share >= LOUD_SHARE) & many).mean(axis=1) >= MOST_AXES
    result = []
    for part in spells(most, SHIFTS):
        axes = (np.flatnonzero((share[part] >= LOUD_SHARE).mean(axis=0) >= MOST_AXES) + 1).tolist()
        result.append((np.concatenate(rows[part]), axes))
    return result


def _of_shifts(odd: np.ndarray, moved: np.ndarray, rows: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the share (s, n) of the windows of each shift in which an axis moved that are odd, and if enough are."""
    count = np.array([odd[r].sum(axis=0) for r in rows]).reshape(len(rows), odd.shape[1])
    of = np.array([moved[r].sum(axis=0) for r in rows]).reshape(len(rows), odd.shape[1])
    return count / np.maximum(of, 1), count >= FEWEST_WINDOWS
