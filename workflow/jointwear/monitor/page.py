"""The page of a monitored robot, for who keeps the robot running; plain words first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jointwear.files.text_files import replace_text
from jointwear.measurement.flags import FLAG_WORDS, Flag
from jointwear.monitor.charts import FEWEST
from jointwear.monitor.drawing import draw_temperature, draw_timeline
from jointwear.monitor.judge import CHANGED, DETECTORS, HEALTHY, UNJUDGED
from jointwear.monitor.state import State, read_state, stamp
from jointwear.monitor.temperature import temperature_share
from jointwear.publishing.report.inline import inline_svg
from jointwear.publishing.report.numbers import number
from jointwear.publishing.report.numbers import span as span_of
from jointwear.publishing.report.rendering import render_page

BADGES = {HEALTHY: "agrees", CHANGED: "differs", UNJUDGED: "other"}
#: Share of the windows at the end that count as now.
NOW = 0.1
#: Estimates in words, and those that are drawn over time.
NAMES = {
    "coulomb": "change of Coulomb friction",
    "coulomb_percent": "the same",
    "viscous": "change of viscous friction",
    "friction": "friction at usual speed",
}
TIMELINES = {
    "coulomb": "Change of the Coulomb friction since the normal period, on which the alarms rest",
    "friction": "Friction at the usual speed",
}


def axis_summary(state: State, j: int) -> dict[str, Any]:
    """Return what the page says at a glance about a 0-based axis."""
    judged = np.flatnonzero(state.status[:, j] != UNJUDGED)
    after = judged[judged >= state.baseline]
    recent = max(1, round(NOW * len(state.start)))
    status, remark = UNJUDGED, why_unjudged(state, j)
    if len(after):
        last = int(after[-1])
        status, remark = str(state.status[last, j]), ""
        if last < len(state.start) - recent:
            remark = f"last judged {when(state, state.end[last])}; since then: {why_unjudged(state, j, last + 1)}"
    alarms = [a["time"] for a in state.alarms if a["axis"] == j + 1 and a["detector"] == DETECTORS[0]]
    return {
        "axis": j + 1,
        "joint": state.joints[j],
        "status": status,
        "badge": BADGES[status],
        "remark": remark,
        "estimates": [_latest(state, name, j) for name in state.estimates],
        "windows": len(judged),
        "first_alarm": when(state, min(alarms)) if alarms else "",
    }


def _latest(state: State, name: str, j: int) -> dict[str, Any]:
    """The mean of an estimate over the windows of now, weighted, with its standard deviation."""
    values, std, unit = state.estimates[name]
    recent = max(1, round(NOW * len(values)))
    value, error = values[-recent:, j], std[-recent:, j]
    good = np.isfinite(value) & (error > 0)
    if not good.any():
        return {"name": _named(name), "unit": unit, "change": True, "value": None, "std": None}
    weight = 1 / error[good] ** 2
    return {
        "name": _named(name),
        "unit": unit,
        "change": name != "friction",
        "value": float(np.average(value[good], weights=weight)),
        "std": float(1 / np.sqrt(weight.sum())),
    }


def _named(name: str) -> str:
    return NAMES.get(name, name.replace("_", " "))


def why_unjudged(state: State, j: int, start: int = 0) -> str:
    """Return in words why an axis could not be judged from window `start` on."""
    here = state.status[start:, j] == UNJUDGED
    if not here.any():
        return ""
    flags = state.flags[start:, j][here]
    found = [(int(np.sum(flags & int(f) != 0)), FLAG_WORDS[f]) for f in Flag if f not in (Flag.GAP, Flag.UNEXPLAINED)]
    count, words = max(found, key=lambda pair: pair[0])
    if count == len(flags):
        return words
    normal = int(np.sum(state.count[: state.baseline, j] > 0))
    if normal < FEWEST:
        return f"it moves in {normal} windows of the normal period; {FEWEST} are needed to know what is normal"
    if count >= 0.5 * len(flags):
        return words
    return "its friction is too small against the noise, or the motion too one-sided, to be seen"


def when(state: State, seconds: float) -> str:
    """Return a time as people read it."""
    if not state.dated:
        return f"{seconds:.4g} s" if state.short else f"{seconds / 3600:.4g} h"
    return stamp(float(seconds), True).replace("T", " ").replace("Z", " UTC")


def advice(quantity: str, change: float | None) -> str:
    """Return what to check when a quantity of an axis changed."""
    if "histogram" in quantity:
        return "the distribution of the torque changed; compare with what the model-based detector says of this axis"
    grew = change is None or change > 0
    if "viscous" in quantity:
        return (
            "check the lubricant: level, age and kind; a cold drive shows the same, so compare at equal temperature"
            if grew
            else "the drive runs warmer or was greased anew; if neither, check the lubricant for the right kind"
        )
    if "offset" in quantity or "asymmetr" in quantity:
        return "check the load at the flange, the balance of the axis and the zero of the torque or current sensor"
    return (
        "check the gear and bearings for wear and play, lubrication, belt tension, and a brake that drags; "
        "listen for noise and compare the motor current by hand at slow constant speed both ways"
        if grew
        else "friction fell: running-in, new grease or a warmer drive; if none of these, check preload and belt tension"
    )


def alarm_rows(state: State) -> list[dict[str, Any]]:
    """Return the alarms with their times in words and what to check."""
    rows = []
    for alarm in sorted(state.alarms, key=lambda a: (a["time"], a["axis"] or 0)):
        sure = alarm["probability_axis"]
        words = "" if sure is None else "> 99 %" if sure > 0.99 else f"{100 * sure:.0f} %"
        told = advice(alarm["quantity"], alarm["change"])
        rows.append(alarm | {"sure": words, "when": when(state, alarm["time"]), "advice": told})
    return rows


def changed_sentence(summary: dict[str, Any]) -> str:
    """Return what is known of a changed axis in one sentence."""
    latest = {e["name"]: e for e in summary["estimates"]}
    size, share = latest[NAMES["coulomb"]], latest[NAMES["coulomb_percent"]]
    text = f"Axis {summary['axis']} ({summary['joint']})"
    if size["value"] is not None:
        text += f": friction {'up' if size['value'] > 0 else 'down'} by {number(abs(size['value']))} {size['unit']}"
        if share["value"] is not None:
            text += f" ({number(abs(share['value']), 2)} %)"
    if summary["first_alarm"]:
        text += f", first alarm {summary['first_alarm']}"
    return f"{text}."


def headline(summaries: list[dict[str, Any]]) -> tuple[str, list[str]]:
    """Return the heading of the page and the sentences below it."""

    def named(status: str) -> str:
        axes = [str(s["axis"]) for s in summaries if s["status"] == status]
        word = "axis" if len(axes) == 1 else "axes"
        return f"{word} {', '.join(axes[:-1])}{' and ' if len(axes) > 1 else ''}{axes[-1]}" if axes else ""

    changed, healthy, unjudged = named(CHANGED), named(HEALTHY), named(UNJUDGED)
    if changed:
        heading = f"Friction has changed: {changed}"
    elif healthy:
        heading = "No change of friction found" + (" where it can be judged" if unjudged else "")
    else:
        heading = "No axis can be judged"
    sentences = [changed_sentence(s) for s in summaries if s["status"] == CHANGED]
    if healthy:
        sentences.append(f"No change: {healthy}.")
    if unjudged:
        sentences.append(f"Cannot be judged: {unjudged}. That is no sign of health; the reasons are below.")
    return heading, sentences


def temperature_rows(state: State) -> list[dict[str, Any]]:
    """Return for every axis how much of the change of its friction goes with temperature, where that is known."""
    values, std, _ = state.estimates["friction"]
    shares = [temperature_share(values[:, j], std[:, j], state.temperature[:, j]) for j in range(state.axes)]
    return [{"axis": j + 1, "share": share} for j, share in enumerate(shares) if share is not None]


def write_page(state_file: str | Path, output: str | Path, figures: str | Path) -> None:
    """Write the page of a monitored robot; `figures` is the folder for its SVG files."""
    state, folder = read_state(state_file), Path(figures)
    shown = {name: words for name, words in TIMELINES.items() if np.isfinite(state.estimates[name][0]).any()}
    files = {f"timeline_{name}": folder / f"timeline_{name}.svg" for name in shown}
    for name in shown:
        draw_timeline(state, name, files[f"timeline_{name}"])
    warm = temperature_rows(state)
    if warm:
        files["temperature"] = folder / "temperature.svg"
        draw_temperature(state, "friction", [row["axis"] - 1 for row in warm], files["temperature"])
    summaries = [axis_summary(state, j) for j in range(state.axes)]
    heading, sentences = headline(summaries)
    span = when(state, state.start[0]), when(state, state.end[-1])
    flags = [
        {"words": FLAG_WORDS[f], "windows": [int(np.sum(state.flags[:, j] & int(f) != 0)) for j in range(state.axes)]}
        for f in Flag
    ]
    context = {
        "state": state,
        "heading": heading,
        "lead": sentences,
        "summaries": summaries,
        "alarms": alarm_rows(state),
        "warm": warm,
        "timelines": shown,
        "span_of": span_of,
        "reasons": [why_unjudged(state, j) for j in range(state.axes)],
        "span": span,
        "baseline_end": when(state, state.end[state.baseline - 1]),
        "flags": [f for f in flags if any(f["windows"])],
        "logs": [
            {"name": log, "first": when(state, a), "last": when(state, b), "refused": told}
            if np.isfinite(a)
            else {"name": log, "first": None, "last": None, "refused": told}
            for log, a, b, told in zip(state.logs, state.first, state.last, state.refused, strict=True)
        ],
        "figures": {name: inline_svg(path, name.replace("_", "-")) for name, path in files.items()},
        "files": {name: path.relative_to(Path(output).parent).as_posix() for name, path in files.items()},
    }
    replace_text(output, render_page("monitor.html.j2", context))
