"""What is no alarm of wear but must be told: changed scales, a proposed service, programs, what all axes share."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any, Protocol

import numpy as np

from jointwear.files.shown_numbers import fixed
from jointwear.files.wording import listed, name_axes
from jointwear.monitor.events import Event
from jointwear.monitor.findings.loud import loud_findings
from jointwear.monitor.findings.thermometers import broken, other_unit
from jointwear.monitor.local_time import duration
from jointwear.monitor.reading.after_baseline import after_baseline
from jointwear.monitor.reading.logs_of_windows import LogsOfWindows
from jointwear.monitor.reading.regimes import parts_of_known, signatures
from jointwear.monitor.reading.windows import WindowStatistics
from jointwear.monitor.watching.another_robot import FEWEST_RISEN, MOST_AXES, Exchange
from jointwear.monitor.watching.decision import NORMAL
from jointwear.monitor.watching.scale import FEWEST_TOGETHER, ScaleStep
from jointwear.monitor.watching.shared_error import FINDING
from jointwear.monitor.watching.watching import Watch

#: An alarm this many shifts after a scale changed may be of the same cause: it takes two shifts to raise one.
WITH_SCALE = 2
#: Share of what an axis had grown by before it came back, above which it has grown again.
AGAIN = 0.5
#: Days [s] for which friction may go on falling after an axis was serviced, as new grease is worked in: by itself, and
#: with no new question.
WORKED_IN = 14 * 86400.0
#: Kind of a finding on a fall that may be a service, on one that has gone again, on a program that the baseline lacks,
#: and on most axes together.
FELL, DIP, PROGRAM, AT_ONCE = "proposed_service", "dip", "program", "at_once"
#: Kind of a finding on what all axes do together; without an `end` they still do.
SHARED = "shared"


class Dated(Protocol):
    """Windows, or the state of a robot: whether its logs have dates."""

    @property
    def dated(self) -> bool:
        """Whether times are those since 1970."""


def moment_words(statistics: Dated, seconds: float) -> str:
    """Return a time as ISO 8601 UTC, which pages tell in their zone, or in hours of the log's clock."""
    if statistics.dated:
        return datetime.fromtimestamp(seconds, tz=UTC).strftime("%Y-%m-%dT%H:%MZ")
    return f"{seconds / 3600:.4g} h"


def findings_of(
    statistics: WindowStatistics,
    shift: np.ndarray,
    baseline: np.ndarray,
    level: Watch,
    steps: Sequence[ScaleStep],
    exchanges: Sequence[Exchange],
    changed: np.ndarray,
    shown: np.ndarray | None,
    program: np.ndarray | None = None,
    doubtful: np.ndarray | None = None,
    events: Sequence[Event] = (),
    logs: LogsOfWindows | None = None,
) -> list[dict[str, Any]]:
    """Return the findings, each with `time` [s], `axes` (1-based), `kind` and `words` for the page.

    Parameters
    ----------
    steps : changed scales. exchanges : of robots or drives. changed : (w, n) bool, axes with an open alarm of friction.
    shown : (w,) programs that the motion shows, None where the log names them or there is one.
    program : (w,) of either, None for one. doubtful : as of :func:`.loud_findings`.
    events : of the config. logs : that the windows come from, default unknown.
    """
    explained = {(s.axis, s.window) for s in steps} | {(j, one.window) for one in exchanges for j in one.axes}
    found = _scales(statistics, shift, steps, changed) + _services(statistics, level, explained, events)
    found += _dips(statistics, level) + [_exchanged(statistics, level, one) for one in exchanges]
    found += _at_once(statistics, shift, level, explained)
    found += _programs(statistics, shift, shown, baseline, level, logs)
    found += _returned(statistics, shift, level, changed) + _shared(statistics, shift, baseline, level)
    found += other_unit(statistics, baseline) + broken(statistics, baseline)
    told = [[s.window for s in starts if not s.proposed] for starts in level.starts]
    found += loud_findings(statistics, shift, baseline, told, program, doubtful)
    return sorted(found, key=lambda f: f["time"])


def _scales(
    statistics: WindowStatistics, shift: np.ndarray, steps: Sequence[ScaleStep], changed: np.ndarray
) -> list[dict[str, Any]]:
    """One finding for each moment at which scales changed, with the axes that alarmed at that time."""
    onset = [np.flatnonzero(c)[0] if c.any() else None for c in changed.T]
    result = []
    for window in sorted({s.window for s in steps}):
        here = sorted((s for s in steps if s.window == window), key=lambda s: s.axis)
        time = float(statistics.start[window])
        axes, factor = [s.axis + 1 for s in here], float(np.mean([s.factor for s in here]))
        words = (
            f"The scale of the torque of {name_axes(axes)} changed by {factor:.3g}: a gain, a unit or a torque "
            "constant, no wear. It is learnt anew from there; enter the event as 'sensor'."
        )
        others = [j + 1 for j, k in enumerate(onset) if k is not None and j + 1 not in axes]
        others = [a for a in others if 0 <= shift[onset[a - 1]] - shift[window] <= WITH_SCALE]
        if others:
            words += f" The friction of {name_axes(others)} rose with it: look at the gain there before the gear."
        result.append({"time": time, "axes": axes, "kind": "scale", "words": words})
    return result


def _services(
    statistics: WindowStatistics, level: Watch, explained: set[tuple[int, int]], events: Sequence[Event] = ()
) -> list[dict[str, Any]]:
    """One finding for the falls of an axis within :data:`WORKED_IN`; those so soon after a service that was entered
    are answered by it."""
    result = []
    for j, starts in enumerate(level.starts):
        services = [e.time for e in events if e.kind == "service" and e.concerns(j)]
        fallen = [s.window for s in starts if s.proposed and (j, s.window) not in explained]
        doubtful = {s.window for s in starts if s.doubtful}
        for since, windows in _falls(statistics.start, fallen, services):
            # Any later event of the axis closes what was before it.
            told = any(not later.proposed and later.window >= windows[-1] for later in starts)
            last = moment_words(statistics, statistics.start[windows[-1]]) if len(windows) > 1 else ""
            found = {"time": float(statistics.start[windows[0]]), "axes": [j + 1], "kind": FELL}
            if since is not None:
                words, more = worked_in_words(j + 1, moment_words(statistics, since), last), {"answered": True}
            else:
                # Axes that fell once, at one time, are told together.
                doubt = doubtful.issuperset(windows)
                words, more = fell_words([j + 1], last, doubt), {} if last else {"fell": True}
                more |= {"doubtful": True} if doubt else {}
            result.append({**found, "words": words, **more, **({"answered": True} if told else {})})
    return result


def _dips(statistics: WindowStatistics, level: Watch) -> list[dict[str, Any]]:
    """One finding for each fall that has gone again, answered where an event of its axis came later."""
    result = []
    for j, dips in enumerate(level.dips):
        for dip in dips:
            words = (
                f"Friction of axis {j + 1} fell and was back at what was normal before by "
                f"{moment_words(statistics, statistics.end[dip.back])}: friction wanders by as much, or the axis was "
                "serviced and has worn since, which friction alone does not tell apart. No growth is told of it. Only "
                "if it was serviced, enter that under 'events', for what is normal is then learnt anew from there."
            )
            told = any(not later.proposed and later.window >= dip.window for later in level.starts[j])
            known = {"answered": True} if told else {}
            time = float(statistics.start[dip.window])
            result.append({"time": time, "axes": [j + 1], "kind": DIP, "words": words, **known})
    return result


def _falls(
    begin: np.ndarray, windows: Sequence[int], services: Sequence[float]
) -> list[tuple[float | None, list[int]]]:
    """Return the windows of falls that belong together, with the time [s] of the service shortly before, None for none.

    Parameters
    ----------
    begin : (w,) of the windows [s]. windows : from which the axis is learnt anew by falls, in order of time. services :
    times [s] that were entered.
    """
    result: list[tuple[float | None, list[int]]] = []
    for window in windows:
        time = float(begin[window])
        since = max((s for s in services if 0 <= time - s <= WORKED_IN), default=None)
        if result and result[-1][0] == since and time - begin[result[-1][1][0]] <= WORKED_IN:
            result[-1][1].append(window)
        else:
            result.append((since, [window]))
    return result


def _at_once(
    statistics: WindowStatistics, shift: np.ndarray, level: Watch, explained: set[tuple[int, int]]
) -> list[dict[str, Any]]:
    """One finding for the first two shifts in which most axes begin to alarm or fall, each by itself."""
    begins = [
        (int(shift[k]), int(k), j, rose)
        for j, starts in enumerate(level.starts)
        for k, rose in [
            *((k, True) for k in np.flatnonzero(level.alarm[:, j])[:1]),
            *((s.window, False) for s in starts if s.proposed and (j, s.window) not in explained),
            *((dip.window, False) for dip in level.dips[j]),
        ]
    ]
    for name in sorted({b[0] for b in begins}):
        here = [b for b in begins if 0 <= b[0] - name <= 1]
        rose, fell = (sorted({j + 1 for _, _, j, up in here if up == wanted}) for wanted in (True, False))
        axes = sorted({*rose, *fell})
        if len(axes) < max(FEWEST_TOGETHER, MOST_AXES * len(level.starts)) or len(rose) < FEWEST_RISEN:
            continue
        window = min(k for _, k, _, _ in here)
        words = (
            f"Within two shifts friction {_moved(rose, fell)}, which no gear does: new grease in several "
            "axes, logs of another robot under this name, exchanged drives, another controller, a load, or weather "
            "that no thermometer shows. Look for that "
            "before you look at a gear, and enter under 'events' what was changed."
        )
        return [_of_many(statistics, level, window, axes, words)]
    return []


def _exchanged(statistics: WindowStatistics, level: Watch, one: Exchange) -> dict[str, Any]:
    """The finding on logs of another robot."""
    rose, fell = ([j + 1 for j in axes] for axes in (one.rose, one.fell))
    if one.end is None:
        since, then = "", "all axes are learnt anew from there"
    else:
        lasted = duration((statistics.start[one.end] - statistics.start[one.window]) / 3600)
        since, then = f", and for {lasted},", "these windows are not judged"
    words = (
        f"From one shift to the next{since} friction {_moved(rose, fell)}, which no gear does: logs of another robot "
        "under this name, exchanged drives, another controller, or new grease in several axes. No wear is told of it, "
        f"and {then}: put the logs where they belong, or enter under 'events' what was changed."
    )
    return _of_many(statistics, level, one.window, sorted([*rose, *fell]), words)


def _moved(rose: Sequence[int], fell: Sequence[int]) -> str:
    """Return in words which 1-based axes rose and fell."""
    return " and ".join(f"of {name_axes(a)} {word}" for a, word in ((rose, "rose"), (fell, "fell")) if a)


def _of_many(statistics: WindowStatistics, level: Watch, window: int, axes: list[int], words: str) -> dict[str, Any]:
    """Return the finding on 1-based axes that changed together at a window; answered by a later event of each."""
    answered = all(any(not s.proposed and s.window >= window for s in level.starts[a - 1]) for a in axes)
    known = {"answered": True} if answered else {}
    return {"time": float(statistics.start[window]), "axes": axes, "kind": AT_ONCE, "words": words, **known}


def fell_words(axes: Sequence[int], last: str = "", doubtful: bool = False) -> str:
    """Return in words that the friction of 1-based axes fell, `last` when it did so again; `doubtful` where it may have
    wandered."""
    was, it, learnt = ("was", "it", "It is") if len(axes) == 1 else ("were", "they", "They are")
    since, there = (f", and again {last}", "then") if last else ("", "there")
    wander = (
        " Friction of a healthy joint wanders by as much at times: until then growth alarms only beyond what was "
        "normal before the fall."
    )
    words = (
        f"Friction of {name_axes(axes)} fell{since}: {was} {it} serviced or greased? {learnt} learnt anew from "
        f"{there}; enter the service under 'events' to confirm it, or look for another cause."
    )
    return words + wander if doubtful else words


def worked_in_words(axis: int, since: str, last: str = "") -> str:
    """Return in words that friction of a 1-based axis fell after the service of `since`; `last` when it did again."""
    again = f", the last time {last}" if last else ""
    return (
        f"Friction of axis {axis} fell further after the service of {since}{again}, as where new grease is worked in. "
        "It is learnt anew from there; enter under 'events' only what else was done."
    )


#: How a program that the motion shows is learnt.
_LEARNT = (
    "What it changes is learnt from its differences to other programs of the same shift, never from the level of a "
    "shift, so that wear does not become normal;"
)


def _judged_words(ran: float, judged_after: float | None, over: bool) -> str:
    if judged_after is None:
        return f"in its {ran:.3g} h{'' if over else ' so far'} most axes could not be judged"
    return f"most axes could be judged in it after {judged_after:.3g} h of it"


def _over_words(last: str, few: Sequence[str]) -> str:
    """Return in words that a program runs no more since `last`, and in which `few` logs it ran where that is known."""
    if not few:
        return f" It ran until {last}."
    return f" It ran until {last}, in {listed(few)} alone: a trial, or the log of another robot under this name."


def _programs(
    statistics: WindowStatistics,
    shift: np.ndarray,
    shown: np.ndarray | None,
    baseline: np.ndarray,
    level: Watch,
    logs: LogsOfWindows | None = None,
) -> list[dict[str, Any]]:
    """One finding for each program that the motion shows and the baseline did not have, until when it is learnt, and
    when and where it ran if the newest shift has none of it."""
    if shown is None:
        return []
    result = []
    after = after_baseline(baseline)
    known = parts_of_known(signatures(statistics), shown, baseline)
    for regime in np.setdiff1d(np.unique(shown[after]), [*shown[baseline], -1, *known]):
        rows = np.flatnonzero((shown == regime) & after)
        judged = np.isfinite(level.residual[rows]).mean(axis=1) > 0.5
        hours = statistics.length / 3600
        found = {"ran": len(rows) * hours, "judged_after": float(np.argmax(judged)) * hours if judged.any() else None}
        over = bool(shift[rows[-1]] != shift[-1])
        words = f"A program began that the baseline did not have. {_LEARNT} {_judged_words(**found, over=over)}."
        if over:
            last = moment_words(statistics, float(statistics.end[rows[-1]]))
            words += _over_words(last, [] if logs is None else logs.few(rows))
        result.append({"time": float(statistics.start[rows[0]]), "axes": [], "kind": PROGRAM, "words": words, **found})
    return result


def _returned(
    statistics: WindowStatistics, shift: np.ndarray, level: Watch, changed: np.ndarray
) -> list[dict[str, Any]]:
    """Axes with an open alarm of which two shifts in a row were as in the normal period again; not once a fall since
    the alarm has made them learnt anew, which is told as that and makes what comes after it normal."""
    result = []
    for j in range(changed.shape[1]):
        rows = np.flatnonzero(changed[:, j] & np.isfinite(level.residual[:, j]))
        since = rows[0] if len(rows) else 0
        fell = min((s.window for s in level.starts[j] if s.proposed and s.window > since), default=changed.shape[0])
        rows = rows[rows < fell]
        names = np.unique(shift[rows])
        means = [float(np.mean(level.residual[rows[shift[rows] == s], j])) for s in names]
        for k in range(1, len(names)):
            if max(means[k - 1 : k + 1]) < NORMAL and max(means[: k - 1], default=0.0) > NORMAL:
                time = float(statistics.start[rows[shift[rows] == names[k - 1]][0]])
                # Beside what it has grown by since, that it is back would be taken for how it is now.
                again = min(means[k + 1 :][-2:], default=0.0) > AGAIN * max(means[: k - 1])
                since, then = (", and has grown again since", " then") if again else ("", "")
                words = (
                    f"Friction of axis {j + 1} came back to its normal state{since}: was it serviced{then}? Its alarm "
                    "stays open until an event closes it."
                )
                result.append({"time": time, "axes": [j + 1], "kind": FELL, "words": words})
                break
    return result


def _shared(
    statistics: WindowStatistics, shift: np.ndarray, baseline: np.ndarray, level: Watch
) -> list[dict[str, Any]]:
    """One finding for each run of shifts in which the friction of all axes changed together, with its end, if any."""
    names = np.unique(shift[after_baseline(baseline)])
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
            f"The friction of all axes changed together by up to {fixed(100 * size, 0, True)} %, {lasts}, which is not "
            "wear of a single axis: look at the load that the robot carries, the temperature, the oil, the model and "
            "the unit of the torque."
        )
        until = {"end": end} if b < len(names) else {}
        result.append({"time": time, **until, "axes": [], "kind": SHARED, "words": words})
    return result
