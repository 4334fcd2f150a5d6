"""What was found in the logs themselves: samples that do not count, a turned sign, a temperature that is lacking."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jointwear.effects import get_effect
from jointwear.files.wording import count, listed, name_axes
from jointwear.measurement.flags import Flag
from jointwear.monitor.normal.programs import among_programs
from jointwear.monitor.normal.unsure import not_of_program
from jointwear.monitor.reading.logs_of_windows import LogsOfWindows
from jointwear.monitor.reading.rounded import loud_by_rounding, rounded_since
from jointwear.monitor.reading.scattered_stamps import marked_since, scattered_since
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.robots.robot import Robot
from jointwear.statistics.runs import runs

#: Kinds of logs whose time stamps scatter, and of logs that are written in coarser steps.
SCATTERED, ROUNDED = "scattered_stamps", ("coarse_torque", "coarse_position")
#: Flags of these, which windows of the baseline must not have.
_COARSE = (Flag.COARSE_TORQUE, Flag.COARSE_POSITION)
#: What was found in reading that keeps axes from being judged, or samples from counting: kind -> flag and words.
_READ = {
    "set_back": (
        Flag.CLOCK_RESET,
        (
            "The clock of the logs was set back: windows hold two times, as where summer time ends; log in UTC, or "
            "state their 'time_zone'."
        ),
    ),
    "refused": (
        Flag.REFUSED,
        "Samples of {axes} contradict the model and are not judged; the reasons, and what mends them, are under Logs.",
    ),
    "contradicted": (
        Flag.CONTRADICTED,
        (
            "The torque of {axes} fits neither the model nor the first log: the flange may carry a load that the robot "
            "file lacks, its unit or column may have changed, its sign may be missing, or its measurement may be "
            "faulty. These windows are not judged; state the load, or mend these logs or leave them out."
        ),
    ),
    "outside": (
        Flag.OUTSIDE_LIMITS,
        (
            "Positions of {axes} lie far outside the limits of the robot file: another unit, another zero, whole turns "
            "that the log counts on, or another column. Such samples count for no axis; mend these logs, or the limits."
        ),
    ),
    "frozen": (
        Flag.TORQUE_FROZEN,
        ("The torque of {axes} keeps one value in motion: the sensor, or the log. Nothing is judged from it there."),
    ),
    "saturated": (
        Flag.SATURATED,
        (
            "The torque of {axes} stays at a limit of its drive or its sensor in a part of the samples. These are left "
            "out: what the axis needs there is not known."
        ),
    ),
    "missing": (
        Flag.NOT_FINITE,
        (
            "The logs hold no torque, or no position, of {axes}. Without its torque an axis is not judged, without a "
            "position none is; look at the column, or at the sensor."
        ),
    ),
    "later": (
        Flag.LATER,
        (
            "The torque of {axes} turns at another time against the motion than in the first log: another filter of "
            "the controller or of the log, or another clock. It is read at the time of the first log, so that it does "
            "not look like viscous friction; what the filter takes from quick motion is not known."
        ),
    ),
    "silent": (
        Flag.SILENT,
        (
            "The torque of {axes} keeps one value for a while in motion, as one that was not measured: the sensor, or "
            "the log. These samples are left out."
        ),
    ),
    ROUNDED[0]: (
        Flag.COARSE_TORQUE,
        (
            "The torque of {axes} is written in coarser steps than in the normal period, and the rounding is as large "
            "as what play or a bearing would show: it is the log, and no axis is told to be loud for it. Write it with "
            "as many digits as before."
        ),
    ),
    ROUNDED[1]: (
        Flag.COARSE_POSITION,
        (
            "The position of {axes} is written in coarser steps than in the normal period; accelerations, and with "
            "them the torques that the model expects of all axes, are the noisier for it: it is the log, and no axis "
            "is told to be loud for it. Write it with as many digits as before."
        ),
    ),
    SCATTERED: (
        Flag.SCATTERED,
        (
            "The time stamps of the logs scatter from sample to sample, unlike in the normal period, so that speeds "
            "and accelerations are wrong: what looks like play, a bearing, another speed or another zero may come of "
            "it. Look at the clock of the logger first, and let the controller stamp the samples."
        ),
    ),
}

#: Kind of a torque that the model has never explained in a program, and share of the windows of the baseline in it from
#: which on it is that: two windows of 28 are odd ones.
SINCE, OFTEN = "contradicted_since", 0.1
#: Kind of friction that is none, or drives.
DRIVES = "drives"
#: Kinds of an axis that has no samples that count: an odd hour of it is told in numbers alone, a shift in words. A
#: torque that keeps one value in most of the motion of a window is no chance, and told of an hour too.
NONE, FROZEN = ("outside", "frozen", "missing"), "frozen"


def reading_findings(
    statistics: WindowStatistics,
    baseline: np.ndarray | None = None,
    shift: np.ndarray | None = None,
    program: np.ndarray | None = None,
    logs: LogsOfWindows | None = None,
) -> list[dict[str, Any]]:
    """Return one finding for each run of windows in which the clock went back, samples were refused or are missing, or
    torques stay at a limit or are none that the model knows.

    Parameters
    ----------
    baseline : (w,) bool, default all windows; what an axis never had there is no news.
    shift : (w,) labels, rising, default one for each window; what is missing for less than a shift is not told.
    program : (w,) label, -1 unknown, default one program. A torque that the model did not explain in it in the baseline
        either is told once, as no fault.
    logs : that the windows come from, default unknown. Those of a torque that stands still are named.
    """
    result: list[dict[str, Any]] = []
    moved = np.asarray(statistics.count) > 0
    there = (moved if baseline is None else moved[baseline]).any(axis=0)
    shift = np.arange(statistics.windows) if shift is None else shift
    for kind, (flag, words) in _READ.items():
        marked = statistics.flags & int(flag) != 0
        if flag == Flag.CLOCK_RESET and not statistics.dated:
            continue
        if flag == Flag.NOT_FINITE:
            marked &= ~moved & there
        if flag == Flag.SCATTERED:
            marked = scattered_since(statistics, baseline)
        if flag in _COARSE:
            marked = rounded_since(statistics, baseline, flag)
        if flag in (Flag.SATURATED, Flag.CONTRADICTED):
            # Of a light axis rounding leaves a few values, which look like a limit and fit no model.
            marked &= ~marked_since(statistics, baseline, Flag.COARSE_TORQUE)
        # What is refused, or keeps one value, is told as that.
        if kind in NONE:
            marked &= statistics.flags & int(Flag.REFUSED) == 0
        elif flag == Flag.CONTRADICTED:
            marked &= statistics.flags & int(Flag.TORQUE_FROZEN) == 0
            if baseline is not None:
                marked &= ~loud_by_rounding(statistics, baseline)
                label = np.zeros(statistics.windows, dtype=int) if program is None else program
                news = not_of_program(marked, np.ones_like(marked), label, baseline, OFTEN)
                result += _since_baseline(statistics, marked & ~news, program)
                marked = news
        seen = marked.any(axis=1)
        before = np.zeros(statistics.axes, dtype=bool) if baseline is None else marked[baseline].any(axis=0)
        for part in (p for p in runs(seen) if seen[p.start]):
            own = marked[part].any(axis=0)
            if kind in NONE and not _holds_a_shift(shift, part):
                # Steps as coarse as the torque of an axis keep one value for an hour in the normal period already.
                own &= (kind == FROZEN) & ~before
            if not own.any():
                continue
            axes = (np.flatnonzero(own) + 1).tolist()
            told = "all axes" if len(axes) == statistics.axes else name_axes(axes)
            found = {
                "time": float(statistics.start[part.start]),
                "end": float(statistics.end[part.stop - 1]),
                "axes": [] if len(axes) == statistics.axes else axes,
                "kind": kind,
                "words": words.format(axes=told),
            }
            if kind == FROZEN and logs is not None and (few := logs.few(np.arange(part.start, part.stop))):
                found |= {"logs": few, "words": f"{found['words']} Look at {listed(few)}."}
            result.append(found)
    return result


def _since_baseline(
    statistics: WindowStatistics, marked: np.ndarray, program: np.ndarray | None
) -> list[dict[str, Any]]:
    """Return the finding on windows `marked` (w, n) of programs whose torque the model has never explained, or none;
    `program` as of :func:`reading_findings`."""
    rows, axes = np.flatnonzero(marked.any(axis=1)), (np.flatnonzero(marked.any(axis=0)) + 1).tolist()
    if not len(rows):
        return []
    where = among_programs(statistics.labels, program, rows)
    mends = "state the load as 'payload' of the robot file."
    if where:
        # One payload would be as wrong for the other programs, and mending the one would spoil them.
        mends = (
            "the robot file has one 'payload', which holds in all programs: state the load there if the others carry "
            "it, too. Where they do not, it cannot be stated, and this axis is judged in the others alone."
        )
    which = f" ({where.removeprefix('in ')})" if where else ""
    words = (
        f"In {count(len(rows), 'window')} of programs that were so in the normal period already"
        f"{which}, the torque of {name_axes(axes)} fits neither the model nor the first "
        "log: a load at the flange that the robot file lacks, or a motion in which this torque is small, and no fault "
        f"that came since. These windows are not judged; {mends}"
    )
    return [{"time": float(statistics.start[rows[0]]), "axes": axes, "kind": SINCE, "words": words}]


def _holds_a_shift(shift: np.ndarray, part: slice) -> bool:
    """Return whether windows hold all of any shift."""
    names, count = np.unique(shift[part], return_counts=True)
    return any(np.sum(shift == name) == n for name, n in zip(names, count, strict=True))


def driving_findings(
    statistics: WindowStatistics, driving: np.ndarray | None, shift: np.ndarray
) -> list[dict[str, Any]]:
    """Return one finding for each run of windows, nights between them passed over, in which the friction of an axis
    came out at zero or below for all of a shift; a single window tells nothing.

    Parameters
    ----------
    driving : (w, n) bool, of :class:`~jointwear.monitor.normal.series.Series`, or None. shift : (w,) labels, rising.
    """
    if driving is None:
        return []
    result = []
    for j in range(statistics.axes):
        moved = np.flatnonzero(np.asarray(statistics.count)[:, j] > 0)
        for part in (p for p in runs(driving[moved, j]) if driving[moved[p.start], j] and p.stop - p.start > 1):
            if not _holds_a_shift(shift[moved], part):
                continue
            found = {"time": float(statistics.start[moved[part.start]])}
            if part.stop < len(moved):
                found["end"] = float(statistics.end[moved[part.stop - 1]])
            result.append({**found, "axes": [j + 1], "kind": DRIVES, "words": drives_words([j + 1])})
    return result


def drives_words(axes: Sequence[int]) -> str:
    """Return in words that the friction of 1-based axes came out at zero or below."""
    return (
        f"Friction of {name_axes(axes)} came out at zero or below, as if nothing rubbed or it drove the motion: the "
        "sign of a torque or of a position looks turned, or the torque is a command or that of a model. It is not "
        "judged in these logs; mend them, or leave them out."
    )


def missing_temperature(statistics: WindowStatistics, robot: Robot) -> list[dict[str, Any]]:
    """Return one finding on effects of the robot file that count as zero because a temperature was not logged, or none.

    Windows in which an axis shows no friction need no temperature.
    """
    lacking = ~np.isfinite(statistics.temperature) & (np.asarray(statistics.count) > 0)
    names, axes = {}, set()
    for entry in robot.effects:
        effect = get_effect(entry.effect)
        if "temperature" not in effect.needs:
            continue
        own = range(robot.joints) if entry.axis is None else [entry.axis - 1]
        without = {j for j in own if lacking[:, j].any()}
        if without:
            names[effect.phrase] = None
            axes |= without
    if not axes:
        return []
    found = lacking[:, sorted(axes)].any(axis=1)
    where = "" if found.all() else f" in {int(found.sum())} of {count(statistics.windows, 'window')}"
    numbers = [j + 1 for j in sorted(axes)]
    words = (
        f"The robot file has {listed(names)}, but the logs hold no temperature of {name_axes(numbers)}{where}: "
        "the effect counts as zero there, so its torque looks like friction; log the temperature."
    )
    time = float(statistics.start[np.flatnonzero(found)[0]])
    return [{"time": time, "axes": numbers, "kind": "missing_temperature", "words": words}]
