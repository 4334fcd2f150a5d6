"""What is no alarm of wear but must be told: a proposed service, axes that moved together, a missing temperature."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from jointwear.effects import get_effect
from jointwear.files.wording import count, listed, name_axes
from jointwear.measurement.even_steps import runs
from jointwear.measurement.flags import Flag
from jointwear.monitor.conditions import Conditions
from jointwear.monitor.decision import NORMAL
from jointwear.monitor.local_time import duration
from jointwear.monitor.loud import loud_findings
from jointwear.monitor.scale import ScaleStep
from jointwear.monitor.shared_error import FINDING
from jointwear.monitor.thermometers import other_unit
from jointwear.monitor.watching import Watch
from jointwear.monitor.windows import WindowStatistics
from jointwear.publishing.report.numbers import fixed
from jointwear.robots.robot import Robot

#: An alarm this many shifts after a scale changed may be of the same cause: it takes two shifts to raise one.
WITH_SCALE = 2
#: Kind of a finding on an axis whose limit cannot be seen, of one on axes whose windows scatter, of a fall that may be
#: a service, and of a program that the baseline lacks.
COARSE, LOOSE, FELL, PROGRAM = "coarse", "loose", "proposed_service", "program"
#: Scatter of the windows of a shift, standard deviation of the log level beside their own noise, that is told. A shift
#: of eight such windows is known to 1.4 %, three times worse than shifts of a steady robot differ (0.2 to 0.5 %). Of
#: 24 simulated robots that carried parts which their file lacked ten exceed it; of 15 of them whose file was given the
#: mean load, three.
LOOSEST = 0.04


def moment_words(statistics: WindowStatistics, seconds: float) -> str:
    """Return a time as ISO 8601 UTC, or in hours of the log's clock."""
    if statistics.dated:
        return datetime.fromtimestamp(seconds, tz=UTC).strftime("%Y-%m-%dT%H:%MZ")
    return f"{seconds / 3600:.4g} h"


def findings_of(
    statistics: WindowStatistics,
    shift: np.ndarray,
    baseline: np.ndarray,
    level: Watch,
    steps: Sequence[ScaleStep],
    changed: np.ndarray,
    conditions: Conditions,
) -> list[dict[str, Any]]:
    """Return the findings, each with `time` [s], `axes` (1-based), `kind` and `words` for the page.

    Parameters
    ----------
    steps : changed scales. changed : (w, n) bool, axes with an open alarm of friction. conditions : of all windows.
    """
    found = _scales(statistics, shift, steps, changed) + _services(statistics, level, steps)
    found += _programs(statistics, conditions, baseline, level)
    found += _returned(statistics, shift, level, changed) + _shared(statistics, shift, baseline, level)
    found += other_unit(statistics, baseline)
    events = [[s.window for s in starts if not s.proposed] for starts in level.starts]
    found += loud_findings(statistics, shift, baseline, events)
    return sorted(found, key=lambda f: f["time"])


def _scales(
    statistics: WindowStatistics, shift: np.ndarray, steps: Sequence[ScaleStep], changed: np.ndarray
) -> list[dict[str, Any]]:
    """One finding for each moment at which scales changed, with the axes that alarmed at that time."""
    onset = [np.flatnonzero(c)[0] if c.any() else None for c in changed.T]
    result = []
    for window in sorted({s.window for s in steps}):
        here = [s for s in steps if s.window == window]
        time = float(statistics.start[window])
        axes, factor = [s.axis + 1 for s in here], float(np.mean([s.factor for s in here]))
        words = (
            f"The scale of the torque of {_axes_words(axes)} changed by {factor:.3g}: a gain, a unit or a torque "
            "constant, no wear. It is learnt anew from there; enter the event as 'sensor'."
        )
        others = [j + 1 for j, k in enumerate(onset) if k is not None and j + 1 not in axes]
        others = [a for a in others if 0 <= shift[onset[a - 1]] - shift[window] <= WITH_SCALE]
        if others:
            words += f" The friction of {_axes_words(others)} rose with it: look at the gain there before the gear."
        result.append({"time": time, "axes": axes, "kind": "scale", "words": words})
    return result


def _axes_words(axes: Sequence[int]) -> str:
    return f"axis {axes[0]}" if len(axes) == 1 else "axes " + ", ".join(str(a) for a in axes)


def _services(statistics: WindowStatistics, level: Watch, steps: Sequence[ScaleStep]) -> list[dict[str, Any]]:
    explained = {(s.axis, s.window) for s in steps}
    result = []
    for j, starts in enumerate(level.starts):
        for start in starts:
            if start.proposed and (j, start.window) not in explained:
                time = float(statistics.start[start.window])
                words = fell_words([j + 1])
                # Any later event of the axis closes what was before it.
                told = any(not later.proposed and later.window >= start.window for later in starts)
                answered = {"answered": True} if told else {}
                result.append({"time": time, "axes": [j + 1], "kind": FELL, "words": words, "fell": True, **answered})
    return result


def fell_words(axes: Sequence[int]) -> str:
    """Return in words that the friction of 1-based axes fell."""
    was, it, learnt = ("was", "it", "It is") if len(axes) == 1 else ("were", "they", "They are")
    return (
        f"Friction of {name_axes(axes)} fell: {was} {it} serviced or greased? {learnt} learnt anew from there; enter "
        "the service under 'events' to confirm it, or look for another cause."
    )


#: How a program that the motion shows is learnt.
_LEARNT = (
    "What it changes is learnt from its differences to other programs of the same shift, never from the level of a "
    "shift, so that wear does not become normal;"
)


def _judged_words(ran: float, judged_after: float | None) -> str:
    if judged_after is None:
        return f"in its {ran:.3g} h so far most axes could not be judged"
    return f"most axes could be judged in it after {judged_after:.3g} h of it"


def _programs(
    statistics: WindowStatistics, conditions: Conditions, baseline: np.ndarray, level: Watch
) -> list[dict[str, Any]]:
    """One finding for each program that the motion shows and the baseline did not have, and until when it is learnt."""
    if conditions.regime is None or conditions.named:
        return []
    result = []
    for regime in np.setdiff1d(np.unique(conditions.regime[~baseline]), [*conditions.regime[baseline], -1]):
        rows = np.flatnonzero(conditions.regime == regime)
        judged = np.isfinite(level.residual[rows]).mean(axis=1) > 0.5
        hours = statistics.length / 3600
        found = {"ran": len(rows) * hours, "judged_after": float(np.argmax(judged)) * hours if judged.any() else None}
        words = f"A program began that the baseline did not have. {_LEARNT} {_judged_words(**found)}."
        result.append({"time": float(statistics.start[rows[0]]), "axes": [], "kind": PROGRAM, "words": words, **found})
    return result


def _returned(
    statistics: WindowStatistics, shift: np.ndarray, level: Watch, changed: np.ndarray
) -> list[dict[str, Any]]:
    """Axes with an open alarm whose last two shifts are as in the normal period again."""
    result = []
    for j in range(changed.shape[1]):
        rows = np.flatnonzero(changed[:, j] & np.isfinite(level.residual[:, j]))
        names = np.unique(shift[rows])
        means = [float(np.mean(level.residual[rows[shift[rows] == s], j])) for s in names]
        for k in range(1, len(names)):
            if max(means[k - 1 : k + 1]) < NORMAL and max(means[: k - 1], default=0.0) > NORMAL:
                time = float(statistics.start[rows[shift[rows] == names[k - 1]][0]])
                words = (
                    f"Friction of axis {j + 1} came back to its normal state: was it serviced? Its alarm stays open "
                    "until an event closes it."
                )
                result.append({"time": time, "axes": [j + 1], "kind": FELL, "words": words})
                break
    return result


def _shared(
    statistics: WindowStatistics, shift: np.ndarray, baseline: np.ndarray, level: Watch
) -> list[dict[str, Any]]:
    """One finding for each run of shifts in which all axes moved together, with its end where it has one."""
    names = np.unique(shift[~baseline])
    means = np.array([np.mean(level.shared.common[shift == s]) for s in names])
    edges = [0, *(np.flatnonzero(np.diff(np.abs(means) > FINDING)) + 1), len(names)]
    result: list[dict[str, Any]] = []
    for a, b in itertools.pairwise(edges):
        if a == b or abs(means[a]) <= FINDING:
            continue
        rows = np.flatnonzero(np.isin(shift, names[a:b]))
        time, end = float(statistics.start[rows[0]]), float(statistics.end[rows[-1]])
        size = float(means[a:b][np.argmax(np.abs(means[a:b]))])
        lasts = f"for {duration((end - time) / 3600)}, and no more since" if b < len(names) else "to this day"
        words = (
            f"All axes moved together by up to {fixed(100 * size, 0, True)} %, {lasts}, which is no wear of one axis: "
            "look at the load that the robot carries, the temperature, the oil, the model and the unit of the torque."
        )
        until = {"end": end} if b < len(names) else {}
        result.append({"time": time, **until, "axes": [], "kind": "shared", "words": words})
    return result


#: What was found in reading that keeps axes from being judged, or samples from counting: kind -> flag and words.
_READ = {
    "set_back": (
        Flag.CLOCK_RESET,
        "The clock of the logs was set back: windows hold two times, as where summer time ends; log in UTC.",
    ),
    "refused": (
        Flag.REFUSED,
        "Samples of {axes} contradict the model and are not judged; the reasons, and what mends them, are under Logs.",
    ),
    "contradicted": (
        Flag.CONTRADICTED,
        (
            "The torque of {axes} fits neither the model nor the first log: its unit or column may have changed, its "
            "sign may be missing, its measurement may be faulty, or the flange may carry a load that the robot file "
            "lacks. These windows are not judged; mend these logs or leave them out, or state the load."
        ),
    ),
    "saturated": (
        Flag.SATURATED,
        (
            "The torque of {axes} stays at a limit of its drive or its sensor in a part of the samples. These are left "
            "out: what the axis needs there is not known."
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
}


def reading_findings(statistics: WindowStatistics) -> list[dict[str, Any]]:
    """Return one finding for each run of windows in which the clock went back, samples were refused, torques are none
    that the model knows, or torques stay at a limit."""
    result: list[dict[str, Any]] = []
    for kind, (flag, words) in _READ.items():
        marked = statistics.flags & int(flag) != 0
        if flag == Flag.CLOCK_RESET and not statistics.dated:
            continue
        seen = marked.any(axis=1)
        for part in (p for p in runs(seen) if seen[p.start]):
            axes = (np.flatnonzero(marked[part].any(axis=0)) + 1).tolist()
            told = "all axes" if len(axes) == statistics.axes else _axes_words(axes)
            result.append(
                {
                    "time": float(statistics.start[part.start]),
                    "end": float(statistics.end[part.stop - 1]),
                    "axes": [] if len(axes) == statistics.axes else axes,
                    "kind": kind,
                    "words": words.format(axes=told),
                }
            )
    return result


def driving_findings(statistics: WindowStatistics, driving: np.ndarray | None) -> list[dict[str, Any]]:
    """Return one finding for each run of windows, nights between them passed over, in which the friction of an axis
    came out below zero; a single window tells nothing.

    Parameters
    ----------
    driving : (w, n) bool, of :class:`~jointwear.monitor.series.Series`, or None.
    """
    if driving is None:
        return []
    result = []
    for j in range(statistics.axes):
        moved = np.flatnonzero(np.asarray(statistics.count)[:, j] > 0)
        for part in (p for p in runs(driving[moved, j]) if driving[moved[p.start], j] and p.stop - p.start > 1):
            words = (
                f"Friction of axis {j + 1} came out below zero, as if it drove the motion: the sign of its torque or "
                "of its position looks turned. The axis is not judged in these logs; mend them, or leave them out."
            )
            found = {"time": float(statistics.start[moved[part.start]])}
            if part.stop < len(moved):
                found["end"] = float(statistics.end[moved[part.stop - 1]])
            result.append({**found, "axes": [j + 1], "kind": "drives", "words": words})
    return result


def coarse_findings(
    statistics: WindowStatistics, baseline: np.ndarray, least: np.ndarray, limit: float
) -> list[dict[str, Any]]:
    """Return one finding for each axis whose growth up to the limit would not be seen, with the `least` that would be.

    Parameters
    ----------
    baseline : (w,) bool. least : (n,) smallest growth of Coulomb friction that two shifts show, NaN unknown. limit : of
        that growth.
    """
    return [
        {
            "time": float(statistics.end[np.flatnonzero(baseline)[-1]]),
            "axes": [int(j) + 1],
            "kind": COARSE,
            "least": float(least[j]),
            "words": (
                f"Of axis {j + 1} {coarse_words(least[j])}, and its limit is {100 * limit:.0f} %: its friction differs "
                "too much from shift to shift, or is too small against the noise. That there is no alarm says nothing "
                "of smaller changes."
            ),
        }
        for j in np.flatnonzero(least > limit)
    ]


def loose_findings(statistics: WindowStatistics, baseline: np.ndarray, level: Watch) -> list[dict[str, Any]]:
    """Return one finding on all axes whose windows scatter by more than :data:`LOOSEST`, or none.

    Parameters
    ----------
    baseline : (w,) bool. level : what was watched of friction.
    """
    scatter = np.array([0.0 if axis is None else np.sqrt(axis.dispersion.extra) for axis in level.axes])
    loose = np.flatnonzero(scatter > LOOSEST)
    if not len(loose) or not baseline.any():
        return []
    axes, most = [int(j) + 1 for j in loose], 100 * scatter.max()
    words = (
        f"The windows of {name_axes(axes)} scatter by {'up to ' if len(axes) > 1 else ''}{most:.0f} %, so that growth "
        "is seen late: does the robot file lack a load, or does the robot carry parts some of the time? State the "
        "payload in the robot file, name the part under 'program', or run learn_normal."
    )
    time = float(statistics.end[np.flatnonzero(baseline)[-1]])
    return [{"time": time, "axes": axes, "kind": LOOSE, "words": words}]


def coarse_words(least: float) -> str:
    """Return in words the smallest growth of Coulomb friction that can be seen."""
    return f"only changes above {100 * least:.0f} % can be seen"


def dead_band_findings(
    statistics: WindowStatistics, baseline: int, unseen: np.ndarray, noisy: Sequence[bool], dead_band: Sequence[float]
) -> list[dict[str, Any]]:
    """Return one finding for each axis that cannot be judged, or only coarsely, beside a dead band that is all noise.

    Parameters
    ----------
    baseline : windows of it. unseen : (n,) bool, the axis is never judged, or changes up to its limit are not seen.
    noisy, dead_band [rad/s] : of the survey, (n,).
    """
    return [
        {
            "time": float(statistics.end[baseline - 1]),
            "axes": [j + 1],
            "kind": "dead_band",
            "words": (
                f"Axis {j + 1} counts as at rest below {dead_band[j]:.2g} rad/s. That comes from the noise of its "
                "position in the first log, more than its speed asks for, and leaves less of its motion to judge. If "
                "that log is worse than the others, state 'dead_band' in the entry of the robot."
            ),
        }
        for j in range(len(unseen))
        if unseen[j] and j < len(noisy) and noisy[j]
    ]


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
        f"The robot file has {listed(names)}, but the logs hold no temperature of {_axes_words(numbers)}{where}: "
        "the effect counts as zero there, so its torque looks like friction; log the temperature."
    )
    time = float(statistics.start[np.flatnonzero(found)[0]])
    return [{"time": time, "axes": numbers, "kind": "missing_temperature", "words": words}]
