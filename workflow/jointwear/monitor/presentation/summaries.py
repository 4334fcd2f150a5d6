"""What the page of a robot says of every axis, and above all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import UTC, tzinfo
from typing import Any

import numpy as np

from jointwear.files.json_values import finite
from jointwear.files.wording import listed, name_axes
from jointwear.measurement.flags import FLAG_WORDS, HARMLESS, Flag
from jointwear.monitor.findings.seen_growth import COARSE, coarse_words
from jointwear.monitor.judging.state import RobotState
from jointwear.monitor.local_time import log_time
from jointwear.monitor.presentation.condition import (
    CHANGED,
    FEWEST_NOW,
    HEALTHY,
    REACHED,
    UNJUDGED,
    UNRESOLVED,
    AxisCondition,
    axis_conditions,
    latest,
)
from jointwear.monitor.presentation.standing import axis_row
from jointwear.monitor.presentation.words import (
    BADGES,
    HIGHER,
    OVER,
    change_words,
    over_words,
    rising_words,
    until_words,
)
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.monitor.watching.present import now_windows
from jointwear.monitor.watching.records import Reason

#: Columns of the table of axes: estimate -> its words, and the estimate that stands below it in another unit.
COLUMNS = {
    "coulomb_percent": ("change of Coulomb friction", "coulomb"),
    "viscous_percent": ("change of viscous friction", "viscous"),
    "backlash": ("change of pulses at reversals", ""),
    "friction": ("friction at usual speed", ""),
}
#: What the table says of its column of pulses, which is none of play itself.
PULSES = (
    "Pulses at reversals are those of play together with what else the torque does there, above all noise: play whose "
    "pulses are small beside that hardly changes them, and cannot be judged."
)
#: Why an estimate of an axis that is judged is not known, in words.
UNKNOWN = {
    "coulomb_percent": "viscous friction grew, and what it adds to this value is not known",
    "viscous_percent": "the motion of the last day does not tell it from Coulomb friction",
    "friction": "the windows of the last day are too few, or too loud against it",
}

#: Why an axis is not judged, in words, where what was found in reading does not say it.
REASONS = {
    Reason.NONE: "its friction is too small against the noise, or the motion too one-sided, to be seen",
    Reason.BASELINE: "it moves in too few windows or shifts of the normal period to know what is normal",
    Reason.LEARNING: "its normal friction is being learnt again after an event or a step in the torque",
    Reason.CONDITIONS: "a program, speed, load or temperature that the normal period did not have",
    Reason.DRIVES: "its friction came out at zero or below: a turned sign, or a torque without friction",
    Reason.LOUD: "the model leaves several times as much of its torque as in the normal period (a unit, a load?)",
    Reason.UNSURE: "its estimate is far less sure than is usual (a part that was not found in these windows?)",
}


def axis_summary(
    state: RobotState, j: int, zone: tzinfo = UTC, condition: AxisCondition | None = None
) -> dict[str, Any]:
    """Return what the page says at a glance about a 0-based axis."""
    condition = condition or axis_conditions(state)[j]
    judged = np.flatnonzero(state.status[:, j] != UNJUDGED)
    after = judged[state.after[judged]]
    remark = ""
    # Of an axis that was never judged the reason stands in the table of what cannot be judged.
    late = len(after) > 0 and bool(after[-1] < len(state.start) - FEWEST_NOW)
    # What is carried over from an earlier window is told as of then.
    held = len(after) > 0 and bool(after[-1] < len(state.start) - 1) and condition.level == HEALTHY
    before = grown_before(state, condition, zone)
    if before:
        unknown = "; no shift since tells what is normal now" if condition.level == UNJUDGED else ""
        remark = f"{before}{unknown}"
    elif late or held:
        last = int(after[-1])
        remark = f"last judged {when(state, state.end[last], zone)}; since then: {why_unjudged(state, j, last + 1)}"
    elif condition.loud:
        remark = "its torque has grown uneven; what is judged of it says nothing of these hours"
    elif condition.level == UNJUDGED and len(after):
        remark = "an event closed its alarm, and no shift since tells what is normal now"
    coarse = next((f["least"] for f in state.findings if f["kind"] == COARSE and j + 1 in f["axes"]), None)
    if len(after) and coarse is not None:
        remark = "; ".join(filter(None, (coarse_words(coarse), remark)))
    # The heading refers to it, whatever else is to be said of the axis.
    remark = "; ".join(filter(None, (remark, over_words(condition) or rising_words(condition))))
    above = OVER if condition.over else HIGHER if condition.rising else ""
    return {
        "axis": j + 1,
        "joint": state.joints[j],
        "status": condition.level,
        "quantity": _quantity(condition),
        "label": above or (REACHED if condition.reached else condition.level),
        "held": f"when last judged, {when(state, state.end[int(after[-1])], zone)}" if held else "",
        "badge": "close" if above else BADGES[UNJUDGED if held and late else condition.level],
        "remark": remark,
        "estimates": [_latest(state, name, j, bool(before)) for name in shown_estimates(state)],
        "unknown": [] if before else _unknown(state, j),
        "windows": len(judged),
        "coarse": coarse is not None,
        "late": late,
        "loud": condition.loud,
    }


def _quantity(condition: AxisCondition) -> str:
    """Return what an axis alarmed for: of the episode to act on, else of the newest that an event explains."""
    past = max(condition.past, key=lambda e: e.last, default=None)
    return condition.quantity or (past.quantity if past else "")


def shown_estimates(state: RobotState) -> list[str]:
    """Return the estimates that the table of axes has a column for: those that are known of any axis."""
    return [name for name in COLUMNS if name in state.estimates and np.isfinite(state.estimates[name][0]).any()]


def grown_before(state: RobotState, condition: AxisCondition, zone: tzinfo) -> str:
    """Return what an axis had grown by before its newest event, where nothing has been judged since; else empty."""
    if condition.event is None:
        return ""
    row, axis = {"dated": state.dated}, axis_row(condition, float(state.end[-1]))
    return change_words(axis, until_words(row, axis, zone)) or f"being learnt anew since {condition.event.kind}"


def _latest(state: RobotState, name: str, j: int, before: bool) -> dict[str, Any]:
    """Return an estimate of a 0-based axis for the table; a change `before` its newest event is none of now."""
    words, other = COLUMNS[name]
    hidden = name == BACKLASH and any(f["kind"] == BACKLASH and j + 1 in f["axes"] for f in state.findings)
    value, std = (math.nan, math.nan) if before and name != "friction" else latest(state, name, j)
    found = {
        "name": words,
        "unit": state.estimates[name][2],
        "change": name != "friction",
        "value": finite(value),
        # Beside "healthy" a dash would be taken for no play; why stands among what else was found.
        "hidden": "cannot be judged" if hidden else "",
        "std": finite(std),
        "below": None,
    }
    if other in state.estimates and found["value"] is not None:
        value, std = latest(state, other, j)
        found["below"] = {"value": finite(value), "std": finite(std), "unit": state.estimates[other][2]}
    return found


def _unknown(state: RobotState, j: int) -> list[str]:
    """Return why estimates of a 0-based axis that have a column are not known now, in words; those of play stand among
    what else was found."""
    lacking = [
        name for name in shown_estimates(state) if name != BACKLASH and not np.isfinite(latest(state, name, j)[0])
    ]
    now = now_windows(state.end)
    if lacking and (state.status[now, j] == UNJUDGED).all():
        names = listed(COLUMNS[name][0].removeprefix("change of ") for name in lacking)
        return [f"{names}: not judged in the last day: {why_unjudged(state, j, int(now[0]))}"]
    return [f"{COLUMNS[name][0].removeprefix('change of ')}: {UNKNOWN[name]}" for name in lacking]


def why_unjudged(state: RobotState, j: int, start: int = 0) -> str:
    """Return in words why an axis could not be judged from window `start` on."""
    here = state.status[start:, j] == UNJUDGED
    if not here.any():
        return ""
    flags = told_flags(state)[start:, j][here]
    found = [(int(np.sum(flags & int(f) != 0)), FLAG_WORDS[f]) for f in Flag if f not in HARMLESS]
    count, words = max(found, key=lambda pair: pair[0])
    if count == len(flags):
        return words
    reasons, counts = np.unique(state.reason[start:, j][here], return_counts=True)
    main = int(reasons[np.argmax(counts)])
    if main not in REASONS or (main == Reason.NONE and count >= 0.5 * len(flags)):
        # A state of another version may hold a reason that this one does not know.
        return words if count else REASONS[Reason.NONE]
    return REASONS[Reason(main)]


def told_flags(state: RobotState) -> np.ndarray:
    """Return the flags (w, n) without what follows from others: samples that were refused do not rest."""
    refused = state.flags & int(Flag.REFUSED) != 0
    return np.where(refused, state.flags & ~int(Flag.AT_REST), state.flags)


def when(state: RobotState, seconds: float, zone: tzinfo = UTC) -> str:
    """Return a time of the logs as people read it."""
    return log_time(float(seconds), zone, state.dated, state.short)


def headline(
    summaries: Sequence[dict[str, Any]],
    whole_robot: bool = False,
    refused: int = 0,
    since: str = "",
    learnt: bool = False,
    turned: bool = False,
    asked: bool = False,
) -> tuple[str, list[str]]:
    """Return the heading of the page and the sentences below it.

    Parameters
    ----------
    whole_robot : an alarm concerns all axes. refused : logs that are refused since any axis was judged last, `since`.
        learnt : no axis was judged but in the normal period. turned : a joint counts from another zero, which nobody
        has answered. asked : a finding has to be explained or mended, and makes the robot urgent in a fleet.
    """

    def named(status: str) -> str:
        return name_axes([s["axis"] for s in summaries if s["status"] == status])

    changed, unresolved, unjudged = map(named, (CHANGED, UNRESOLVED, UNJUDGED))
    over, higher = (name_axes([s["axis"] for s in summaries if s["label"] == label]) for label in (OVER, HIGHER))
    sound = [s for s in summaries if s["status"] == HEALTHY and s["label"] not in (OVER, HIGHER)]
    healthy = name_axes([s["axis"] for s in sound])
    judged, late = (name_axes([s["axis"] for s in sound if s["late"] == wanted]) for wanted in (False, True))
    coarse = name_axes([s["axis"] for s in summaries if s["status"] == HEALTHY and s["coarse"]])
    uneven = name_axes([s["axis"] for s in summaries if s["status"] == UNJUDGED and s["loud"]])
    if changed:
        play = [s["axis"] for s in summaries if s["status"] == CHANGED and s["quantity"] == BACKLASH]
        full = [s["axis"] for s in summaries if s["label"] == REACHED]
        rubs = [s["axis"] for s in summaries if s["status"] == CHANGED and s["axis"] not in [*play, *full]]
        parts = ((REACHED, full), ("friction has changed", rubs), ("backlash has grown", play))
        heading = "; ".join(f"{words}: {name_axes(axes)}" for words, axes in parts if axes)
        heading = heading[0].upper() + heading[1:]
    elif unresolved:
        heading = f"Alarms that nobody has explained: {unresolved}"
    elif whole_robot:
        heading = "The whole robot has changed"
    elif refused:
        heading = "The newest logs are refused"
    elif over:
        heading = f"Over the limit without an alarm: {over}"
    elif uneven:
        heading = f"Torque has grown uneven: {uneven}"
    elif healthy and turned:
        heading = "Friction is not known before the zero of a joint is settled"
    elif asked:
        heading = "The logs show something that has to be explained"
    elif higher:
        heading = f"Friction is higher, without an alarm: {higher}"
    elif healthy:
        heading = "No change of friction found" + (" where it can be judged" if unjudged or coarse else "")
    else:
        heading = "No axis can be judged"
    sentences = []
    if refused:
        last = "the normal period, after which no axis was judged" if learnt else "any axis was judged last"
        sentences.append(
            f"{refused} {'log is' if refused == 1 else 'logs are'} refused since {last}"
            f"{f', {since}' if since else ''}; what is below is as of then. The reasons are under Logs."
        )
    if unresolved:
        sentences.append(
            f"Alarms without an explanation: {unresolved}. An axis is called healthy again when an event of the "
            "config says what was done."
        )
    if over:
        sentences.append(f"Over the limit without an alarm: {over}; what to check stands above.")
    if higher:
        sentences.append(f"Higher without an alarm: {higher}; by how much stands below the table.")
    if judged:
        beside = ", unless the zero of a joint hides it" if turned else ""
        sentences.append(f"No change{' until then' if refused else ''}{beside}: {judged}.")
    if late:
        sentences.append(f"No change when last judged, but not judged of late: {late}; the reasons are in the table.")
    if coarse:
        sentences.append(f"Only changes beyond the limit can be seen: {coarse}.")
    if unjudged:
        sentences.append(f"Cannot be judged: {unjudged}. That is no sign of health; the reasons are below.")
    return heading, sentences
