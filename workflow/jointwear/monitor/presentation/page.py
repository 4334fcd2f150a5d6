"""The page of a monitored robot, for who keeps the robot running; what to check first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import UTC, tzinfo
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.shown_numbers import span as span_of
from jointwear.files.text_files import replace_text
from jointwear.files.wording import count, name_axes
from jointwear.measurement.flags import FLAG_WORDS, HARMLESS, Flag
from jointwear.monitor.findings.told_together import before_words, told_together
from jointwear.monitor.judging.early_events import EARLY_EVENT
from jointwear.monitor.judging.state import RobotState
from jointwear.monitor.local_time import with_local_times, zone_of
from jointwear.monitor.presentation.advice import advice
from jointwear.monitor.presentation.condition import (
    SHOWN_BY,
    UNRESOLVED,
    AxisCondition,
    axis_conditions,
    robot_episodes,
)
from jointwear.monitor.presentation.drawing import draw_temperature, draw_timeline
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.presentation.standing import last_judged, rows_left_out, standing
from jointwear.monitor.presentation.summaries import (
    PULSES,
    axis_summary,
    headline,
    shown_estimates,
    told_flags,
    when,
    why_unjudged,
)
from jointwear.monitor.presentation.temperature import temperature_share
from jointwear.monitor.presentation.to_answer import asks_for_answer, lasts, to_do
from jointwear.monitor.presentation.words import row_words, sure_percent, sure_words, todo
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.monitor.watching.present import NOW, now_windows
from jointwear.publishing.report.inline import inline_svg
from jointwear.publishing.report.rendering import render_page

#: Findings that are not folded away, beside those that ask for an answer.
SHOWN = 5
#: Estimates that are drawn over time.
TIMELINES = {
    "coulomb": "Change of the Coulomb friction since the normal period",
    "viscous": "Change of the viscous friction since the normal period",
    "backlash": "Change of the pulses at reversals since the normal period",
    "friction": "Friction at the usual speed",
}
#: Alarms of an episode that the page lists; alarms.csv has all.
LISTED = 30


def alarm_rows(state: RobotState, episode: Episode, zone: tzinfo) -> list[dict[str, Any]]:
    """Return the alarms of an episode, the newest first, with their times in words and how sure the axis is."""
    return [
        {
            "limited_by": alarm["limited_by"],
            **row_words(alarm),
            "sure": sure_percent(alarm["probability_axis"]),
            "when": when(state, alarm["time"], zone),
        }
        for alarm in reversed(episode.alarms[-LISTED:])
    ]


def story(state: RobotState, episode: Episode, zone: tzinfo, check: str = "") -> dict[str, Any]:
    """Return what the page says of an episode; `check`: of its axis, where that is back to normal."""
    event = episode.resolved
    resolved = "" if event is None else f"{event.kind} {when(state, event.time, zone)}"
    if event is not None and event.note:
        resolved += f": {event.note}"
    return {
        "axis": episode.axis,
        "quantity": episode.quantity,
        "first": when(state, episode.first, zone),
        "last": when(state, episode.last, zone),
        "count": len(episode.alarms),
        "resolved": resolved,
        "advice": with_local_times(check, zone) or advice(episode.quantity, episode.newest["change"]),
        "sure": sure_words(episode.newest["probability_axis"]),
        "alarms": alarm_rows(state, episode, zone),
        "sized": any(a["change"] is not None for a in episode.alarms),
    }


def finding_rows(row: dict[str, Any], state: RobotState, zone: tzinfo) -> list[dict[str, Any]]:
    """Return what else was found, the newest first; of what is over and came again in the same words the newest alone,
    with how often it was so before. `asks`: somebody has to answer it; `urgent`: it makes the robot one to look at in a
    fleet, and what mends more comes first by `place`."""
    alike: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for found in sorted(told_together(row["findings"]), key=lambda f: -(f.get("time") or 0.0)):
        key = (found["kind"], found["words"]) if found.get("end") is not None else (id(found),)
        alike.setdefault(key, []).append(found)
    return [
        {
            "when": " to ".join(when(state, f[key], zone) for key in ("time", "end") if f.get(key) is not None),
            "axes": name_axes(f.get("axes") or ()),
            "words": f"{with_local_times(f['words'], zone)}{before_words(len(before))}",
            "asks": asks_for_answer(f) or (f["kind"] == EARLY_EVENT and not f.get("answered")),
            "urgent": not f.get("answered") and (asks_for_answer(f) or lasts(f, row)),
            "place": to_do(f),
        }
        for f, *before in alike.values()
    ]


def temperature_rows(state: RobotState) -> list[dict[str, Any]]:
    """Return for every axis how much of the change of its friction goes with temperature, where that is known."""
    values, std, _ = state.estimates["friction"]
    middle = 0.5 * (state.start + state.end)
    shares = [temperature_share(values[:, j], std[:, j], state.temperature[:, j], middle) for j in range(state.axes)]
    return [{"axis": j + 1, "share": share} for j, share in enumerate(shares) if share is not None]


def log_rows(state: RobotState, zone: tzinfo) -> list[dict[str, Any]]:
    """Return every log with its first and last sample in words, why it was refused, or rows of it alone, and whose copy
    it is."""
    return [
        {
            "name": log,
            "first": when(state, a, zone) if np.isfinite(a) else None,
            "last": when(state, b, zone) if np.isfinite(a) else None,
            "refused": told.replace(f"{log}: ", ""),
            "rows_alone": rows,
            "copy_of": other,
        }
        for log, a, b, told, rows, other in zip(
            state.logs, state.first, state.last, state.refused, rows_left_out(state), state.copy_of, strict=True
        )
    ]


def _check_of(episode: Episode, conditions: list[AxisCondition]) -> str:
    """Return what is to check of the axis of an episode, where no part of it is or the episode is the one to act on, so
    that a page gives one advice; empty elsewhere."""
    if episode.axis is None:
        return ""
    condition = conditions[episode.axis - 1]
    return condition.check if condition.level == UNRESOLVED or episode is condition.main else ""


def _newest(episodes: list[Episode]) -> list[Episode]:
    return sorted(episodes, key=lambda e: -e.last)


def compared_rows(state: RobotState, zone: tzinfo) -> list[dict[str, Any]]:
    """Return the alarms of the paper's detector in words, the newest first."""
    newest = sorted(state.compared, key=lambda a: -a["time"])
    return [{"axis": alarm["axis"], "when": when(state, alarm["time"], zone)} for alarm in newest]


def _timelines(state: RobotState) -> dict[str, str]:
    """Return the words of what is drawn over time, by name: what is known, and of some only what an alarm is of."""
    alarmed = {SHOWN_BY.get(alarm["quantity"]) for alarm in state.counted}
    return {
        name: words
        for name, words in TIMELINES.items()
        if (name not in SHOWN_BY.values() or name in alarmed) and np.isfinite(state.estimates[name][0]).any()
    }


def now_words(state: RobotState, zone: tzinfo) -> str:
    """Return in words over which windows what is told as of now is the mean."""
    rows = now_windows(state.end)
    last = "last day" if state.end[rows[0]] > state.end[-1] - NOW else f"last {count(len(rows), 'window')}"
    return f"the mean of the {last} ({when(state, state.start[rows[0]], zone)} to {when(state, state.end[-1], zone)})"


def _draw(
    state: RobotState, timelines: Iterable[str], warm: Sequence[int], folder: Path, zone: tzinfo
) -> dict[str, Path]:
    """Draw the figures of a page and return the file of each; `warm`: 0-based axes with a temperature."""
    # The workflow waits for it, though nothing may be drawn of a robot of which nothing can be judged.
    folder.mkdir(parents=True, exist_ok=True)
    files = {f"timeline_{name}": folder / f"timeline_{name}.svg" for name in timelines}
    for name in timelines:
        draw_timeline(state, name, files[f"timeline_{name}"], zone)
    if warm:
        files["temperature"] = folder / "temperature.svg"
        draw_temperature(state, "friction", warm, files["temperature"])
    return files


def _flag_rows(state: RobotState) -> list[dict[str, Any]]:
    """Return the flags that some window carries: words, and in how many windows of each axis."""
    found = told_flags(state)
    windows = {f: (found & int(f) != 0).sum(axis=0).tolist() for f in Flag}
    judged = {f: " (keeps no window from being judged)" if f in HARMLESS else "" for f in Flag}
    return [{"words": f"{FLAG_WORDS[f]}{judged[f]}", "windows": windows[f]} for f in Flag if any(windows[f])]


def write_page(
    state: RobotState,
    output: str | Path,
    figures: str | Path,
    time_zone: str | None = None,
    example: bool = False,
) -> None:
    """Write the page of a monitored robot.

    Parameters
    ----------
    state : what is kept of the robot, with its alarms. output : the HTML file.
    figures : folder for the SVG files. time_zone : IANA name of the zone that times are shown in; None is UTC.
    example : whether the robot is a shipped example that the configuration does not name.

    Raises
    ------
    InputError : if there is no such zone.
    """
    zone = zone_of(time_zone)
    shown, warm = _timelines(state), temperature_rows(state)
    files = _draw(state, shown, [row["axis"] - 1 for row in warm], Path(figures), zone)
    conditions, row = axis_conditions(state), standing(state)
    summaries = [axis_summary(state, c.axis - 1, zone, c) for c in conditions]
    whole = robot_episodes(state)
    since = "" if row["last_judged"] is None else when(state, row["last_judged"], zone)
    newest, open_ones = last_judged(state), any(e.resolved is None for e in whole)
    learnt = newest is not None and not state.after[newest]
    turned = any(np.isfinite(c.turned) for c in conditions)
    told = finding_rows(row, state, zone)
    urgent = sorted((f for f in told if f["urgent"]), key=lambda f: f["place"])
    told = [f for f in told if not f["urgent"]]
    heading, sentences = headline(
        summaries, open_ones, row["refused_newest"], since, learnt, turned, asked=bool(urgent)
    )
    unresolved = [e for c in conditions for e in c.episodes] + [e for e in whole if e.resolved is None]
    past = [e for c in conditions for e in c.past] + [e for e in whole if e.resolved is not None]
    context = {
        "state": state,
        "example": example,
        "heading": heading,
        "lead": sentences,
        "todo": [todo(row, axis, zone) for axis in row["axes"] if axis["check"]],
        "whole": [story(state, e, zone) for e in whole if e.resolved is None],
        "urgent": urgent,
        "over": [{"axis": axis["axis"], "words": axis["over"]} for axis in row["axes"] if axis["over"]],
        "findings": [f for k, f in enumerate(told) if k < SHOWN or f["asks"]],
        "older": [f for k, f in enumerate(told) if k >= SHOWN and not f["asks"]],
        "summaries": summaries,
        "unresolved": [story(state, e, zone, _check_of(e, conditions)) for e in _newest(unresolved)],
        "compared": compared_rows(state, zone),
        "past": [story(state, e, zone) for e in _newest(past)],
        "warm": warm,
        "timelines": shown,
        "span_of": span_of,
        "reasons": [why_unjudged(state, j) for j in range(state.axes)],
        "now": now_words(state, zone),
        "pulses": PULSES if BACKLASH in shown_estimates(state) else "",
        "span": (when(state, state.start[0], zone), when(state, state.end[-1], zone)),
        "baseline_end": when(state, state.end[state.baseline][-1], zone) if state.baseline.any() else "",
        # Where people read times in a zone of theirs, logs are likely to be written in it.
        "as_utc": row["dated"] and zone != UTC and state.entry.get("time_zone") is None,
        "flags": _flag_rows(state),
        "logs": log_rows(state, zone),
        "counts": row,
        "figures": {name: inline_svg(path, name.replace("_", "-")) for name, path in files.items()},
        "files": {name: path.relative_to(Path(output).parent).as_posix() for name, path in files.items()},
    }
    replace_text(output, render_page("monitor.html.j2", context))
