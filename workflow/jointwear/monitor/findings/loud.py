"""Torques that grow uneven: of one axis while the others keep still, a fault of that axis; of most, one of the logs.
Torques of most axes that grow smooth: these are computed or filtered, no longer measured as they were.

Windows several times as loud as those of the baseline are not judged, whatever the cause. Where it is one axis,
shift after shift, no load and no unit does that: play, a damaged bearing, a loose sensor. Where it is most of them, the
samples do not belong together as they did. What is only left out would be called healthy. A noise that some windows of
the baseline show as well, such as that of a part that the robot carries now and then, is none of these; nor is one that
a program which the baseline lacks has from its first windows on while the other programs are as before.

Logs of which samples were refused tell nothing of an axis, and an axis that is as before again for several shifts is no
damaged one. It is so only in the programs in which it was loud: play that one program shows is hidden in another.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.spells import spell_finding, spells
from jointwear.monitor.normal.series import LOUDEST, loud_windows
from jointwear.monitor.reading.after_baseline import after_baseline, before_baseline
from jointwear.monitor.reading.rounded import loud_by_rounding
from jointwear.monitor.reading.scattered_stamps import scattered_since
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Kinds of the findings, of one axis, of one in a program, and of most.
LOUD, LOUD_PROGRAM, UNEVEN, SMOOTH = "loud", "loud_program", "uneven", "smooth"
#: Share of the windows of a shift in which an axis moves that are loud, fewest of them, and shifts in a row. On an
#: outside fleet a gear with play had all of them; of 31 other robots one had 11 of 16, 9 of 15 and 9 of 14 on an axis
#: beside a worn one, never two shifts in a row, the others 2 of 8 at most.
LOUD_SHARE, FEWEST_WINDOWS, SHIFTS = 0.75, 3, 2
#: Shifts in a row, in which an axis moves and hardly a window is loud, after which it is as before again; and the share
#: that is hardly any. What is loose or broken does not keep still for so long.
BACK, HARDLY = 3, 0.25
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
    statistics: WindowStatistics,
    shift: np.ndarray,
    baseline: np.ndarray,
    events: Sequence[Sequence[int]],
    program: np.ndarray | None = None,
    doubtful: np.ndarray | None = None,
) -> list[dict[str, Any]]:
    """Return one finding for each axis and spell of shifts in which it was loud after the baseline, one for each spell
    of shifts in which most were, and one for each program that makes an axis loud.

    Parameters
    ----------
    shift : (w,) of each window. baseline : (w,) bool. events : for each axis the windows of the events that a user
        entered; one after the finding answers it.
    program : (w,) label, -1 unknown, default one program. doubtful : (w,) bool, windows of logs of which samples were
        refused, default none.
    """
    moved = (statistics.count > 0) & statistics.judgeable & ~before_baseline(baseline)[:, None]
    noise = np.sqrt(statistics.noise_variance)
    loud = loud_windows(statistics, baseline) & _news(noise, baseline[:, None] & moved)
    # Stamps that scatter make any axis loud, and so do coarser numbers; both are told as such.
    loud &= ~scattered_since(statistics, baseline) & ~loud_by_rounding(statistics, baseline)
    after = after_baseline(baseline)
    names = np.unique(shift[after])
    rows = [np.flatnonzero((shift == name) & after) for name in names]
    if doubtful is not None:
        moved &= ~doubtful[:, None]
    usual = known_median(np.where(baseline[:, None], noise, np.nan), axis=0)
    result = []
    if program is not None:
        of_program = _of_programs(loud & moved, moved, program, baseline)
        result += _program_findings(statistics, program, of_program, noise / usual)
        loud &= ~of_program
    label = np.zeros(len(shift), dtype=int) if program is None else program
    result += _axis_findings(statistics, loud & moved, moved, label, rows, noise / usual, events)
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


def _axis_findings(
    statistics: WindowStatistics,
    loud: np.ndarray,
    moved: np.ndarray,
    program: np.ndarray,
    rows: list[np.ndarray],
    times: np.ndarray,
    events: Sequence[Sequence[int]],
) -> list[dict[str, Any]]:
    """Return the findings on single axes; `times` (w, n) the usual noise of each axis, `program` (w,), the others
    as of :func:`_of_shifts` and :func:`loud_findings`."""
    share, many = _of_shifts(loud, moved, rows)
    alone = (share >= LOUD_SHARE).mean(axis=1) < MOST_AXES
    result = []
    for j in range(statistics.axes):
        seen = [k for k in range(len(rows)) if moved[rows[k], j].any()]
        odd = [bool(share[k, j] >= LOUD_SHARE and many[k, j] and alone[k]) for k in seen]
        own = [rows[k][moved[rows[k], j]] for k in seen]
        for first, last, unseen in _bouts(odd, [loud[r, j] for r in own], [program[r] for r in own]):
            begin = int(rows[seen[first]][0])
            stop = statistics.windows if last is None else int(rows[seen[last]][-1]) + 1
            # It may have turned out to come and go.
            size = float(np.median(times[begin:stop, j][loud[begin:stop, j]]))
            words = (_LOUD if last is None else _WAS_LOUD).format(axis=name_axes([j + 1]), times=f"{size:.2g}")
            words += _NOT_SINCE if unseen else ""
            over = {} if last is None else {"end": float(statistics.end[stop - 1])}
            found = {"time": float(statistics.start[begin]), **over, "axes": [j + 1], "kind": LOUD, "words": words}
            answered = bool(over) or any(window >= begin for window in events[j])
            result.append({**found, **({"answered": True} if answered else {})})
    return result


def _bouts(
    odd: Sequence[bool], loud: Sequence[np.ndarray], program: Sequence[np.ndarray]
) -> list[tuple[int, int | None, bool]]:
    """Return the first and the last of the shifts (s,) of each time in which an axis was loud; the last is None where
    it is not as before again. With each goes whether no program in which it was loud ran in the newest shift.

    Parameters
    ----------
    odd : (s,) bool, shifts that are loud. loud, program : (s,) of arrays (k,), whether each window of a shift in which
        the axis moves is loud, and its label.
    """
    result: list[tuple[int, int | None, bool]] = []
    first = last = None
    run = still = 0
    where: set[int] = set()
    ran = True
    for k in range(len(odd)):
        run = run + 1 if odd[k] else 0
        if first is None and run < SHIFTS:
            continue
        if first is None:
            first, last, still = k - SHIFTS + 1, k, 0
            where = {int(p) for s in range(first, k + 1) for p in program[s][loud[s]]}
        elif odd[k]:
            where |= {int(p) for p in program[k][loud[k]]}
        # What a program of another motion does not show may be there all the same.
        own = np.isin(program[k], list(where))
        ran = bool(own.any())
        calm = ran and not odd[k] and loud[k][own].mean() <= HARDLY
        still = still + 1 if calm else still if not ran else 0
        last = last if calm or not ran else k
        if still >= BACK:
            result.append((first, last, False))
            first = None
    return result if first is None else [*result, (first, None, not ran)]


def _of_programs(loud: np.ndarray, moved: np.ndarray, program: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """Return the loud windows (w, n) whose program makes them so: one that the baseline lacks, that is loud from its
    first windows on, while those of the programs that the baseline has, once it ran, are as before.

    Parameters
    ----------
    loud, moved : (w, n) bool; only axes that moved are loud. program : (w,) label, -1 unknown. baseline : (w,) bool.
    """
    result = np.zeros(loud.shape, dtype=bool)
    known = np.isin(program, np.setdiff1d(program[baseline], [-1]))
    for name in np.setdiff1d(program[after_baseline(baseline)], [*program[baseline], -1]):
        for j in range(loud.shape[1]):
            own = np.flatnonzero((program == name) & moved[:, j])
            beside = np.flatnonzero(known & moved[:, j])
            beside = beside[beside > own[0]] if len(own) else beside
            if min(len(own), len(beside)) < FEWEST_WINDOWS:
                continue
            at_first = loud[own[:FEWEST_WINDOWS], j].mean() >= LOUD_SHARE
            if at_first and loud[beside, j].mean() <= HARDLY:
                # What came after the last window of these may be of the axis again; in the program it is as it was.
                result[own, j] = loud[own, j]
    return result


def _program_findings(
    statistics: WindowStatistics, program: np.ndarray, loud: np.ndarray, times: np.ndarray
) -> list[dict[str, Any]]:
    """Return one finding for each program with windows that it makes `loud` (w, n), `times` (w, n) the usual noise."""
    result = []
    for name in np.unique(program[loud.any(axis=1)]):
        own = loud & (program == name)[:, None]
        axes = np.flatnonzero(own.any(axis=0))
        size = max(float(np.median(times[own[:, j], j])) for j in axes)
        words = _OF_PROGRAM.format(axes=name_axes((axes + 1).tolist()), times=f"{size:.2g}")
        begin = float(statistics.start[np.flatnonzero(own.any(axis=1))[0]])
        result.append({"time": begin, "axes": (axes + 1).tolist(), "kind": LOUD_PROGRAM, "words": words})
    return result


_LOUD = (
    "What the model leaves of the torque of {axis} is {times} times as large as in the normal period, shift after "
    "shift, and that of the other axes is not: play in the gear, a damaged bearing, a loose fastening or a fault of "
    "its sensor. Such hours are not judged for growth of friction; look at this axis, and enter what was done under "
    "'events'."
)
_NOT_SINCE = " The programs in which it was so have not run since; in others it need not show."
_WAS_LOUD = (
    "What the model left of the torque of {axis} was {times} times as large as in the normal period, and that of the "
    f"other axes was not; for {BACK} shifts or more it has been as before again: columns or rows of these logs that do "
    "not belong together, a plug or a fastening that was put right, or something that comes and goes. Such hours are "
    "not judged; look at how these logs are written first."
)
_OF_PROGRAM = (
    "In a program that the baseline did not have the model leaves up to {times} times as much of the torque of {axes} "
    "as in the normal period, from its first hours on, and in the programs that the baseline has as much as before: "
    "its motion, or a part that it carries, and no damage. Such hours are not judged for growth of friction of "
    "{axes}; state the part as 'payload' of the robot file where it is carried all the time."
)
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
