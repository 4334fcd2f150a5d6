"""The page of the fleet: robots by urgency, what to check first, and what could not be judged."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import tzinfo
from pathlib import Path
from typing import Any

from jointwear.files.text_files import replace_text
from jointwear.files.wording import count, listed, name_axes
from jointwear.monitor.findings.misfits import MISFIT
from jointwear.monitor.findings.missed_torque import BASE
from jointwear.monitor.findings.seen_growth import COARSE, LOOSE, MISSED
from jointwear.monitor.findings.told_together import before_words, told_together
from jointwear.monitor.fleet.metrics import COUNTS
from jointwear.monitor.fleet.ranking import ASKS, ORDER, REFUSED, STALE
from jointwear.monitor.judging.baseline import ELSEWHERE
from jointwear.monitor.judging.early_events import EARLY_EVENT, PLANNED_EVENT
from jointwear.monitor.local_time import duration, local_day, local_time, log_time
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, REACHED, UNJUDGED, UNRESOLVED
from jointwear.monitor.presentation.to_answer import is_note, lasts, to_do
from jointwear.monitor.presentation.words import todo
from jointwear.monitor.reading.inspection import ALL_LOGS
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.publishing.report.rendering import render_page

BADGES = {
    REACHED: "differs", CHANGED: "differs", REFUSED: "other", UNRESOLVED: "close", ASKS: "close", STALE: "other",
    UNJUDGED: "other", HEALTHY: "agrees",
}  # fmt: skip
#: What to check on a robot that no axis of which calls for anything.
CHECKS = {
    REFUSED: "Mend what refuses its logs",
    STALE: "Look why no new log arrives",
    UNJUDGED: "Let it move, or log more of it",
    ASKS: "Enter what was done to it, or look for the cause",
}
#: Kinds of findings that hold for all logs, and have no day.
LASTING = (
    COARSE, LOOSE, MISSED, BASE, EARLY_EVENT, PLANNED_EVENT, ELSEWHERE, "baseline", "robot", "dead_band",
    "missing_temperature", MISFIT,
)  # fmt: skip
#: Numbers of joints, and of what is refused, by which reasons of one kind differ.
_NUMBERS = re.compile(r"(?:, )?[-+]?\d[\d.e+-]*(?: (?:for|on) joint \d+)?")
#: How what mends a log begins, among the clauses that say why it is refused.
MENDS = (
    "delete", "give", "join", "label", "leave", "log", "map", "mend", "multiply", "name", "put", "record", "rename",
    "repair", "save", "state", "turn", "write",
)  # fmt: skip
#: Findings and axes of a robot that the list shows; the page of the robot has all.
SHOWN = 3


def robot_item(row: Mapping[str, Any], zone: tzinfo, link: str) -> dict[str, Any]:
    """Return what the page says of one robot; `link` leads to the folder of its files."""
    axes = [todo(row, axis, zone) for axis in row["axes"] if axis["check"]]
    advice, check = _advice(row), CHECKS.get(row["urgency"], "")
    if advice and row["urgency"] == UNJUDGED:
        # It says what ends that; to let the robot move would not.
        advice, check = "", advice
    if check and row["urgency"] in (REFUSED, UNJUDGED):
        known = None if row["last_judged"] is None else log_time(row["last_judged"], zone, row["dated"])
        check += ": nothing is known of this robot" + (f" since {known}" if known else "")
    check = "; ".join(filter(None, (check, advice[:1].lower() + advice[1:] if check else advice)))
    if axes and row["urgency"] != REFUSED:
        check = ""
    coarse = {axis for f in row["findings"] if f["kind"] == COARSE for axis in f["axes"]}
    whole = [e["quantity"] for e in row["episodes"] if e["axis"] is None]
    shown = [*((words, False) for words in _over(row)), *_to_check(row, zone)][:SHOWN]
    return {
        "name": row["robot"],
        "urgency": row["urgency"],
        "badge": BADGES[row["urgency"]],
        "page": f"{link}/{row['folder']}/{row['page']}" if row["page"] else None,
        "axes": axes[:SHOWN],
        "more": len(axes) - SHOWN,
        "whole": whole,
        "check": check,
        "reason": row["reason"],
        "mends": _mends(row),
        "refusals": _refusals(row),
        "more_refused": row["refused_logs"] - len(row["refusals"]) if row["refusals"] else 0,
        "open": [words for words, note in shown if not note],
        "notes": [words for words, note in shown if note],
        "last": "" if row["last_sample"] is None else log_time(_minute(row), zone, row["dated"]),
        "silent": duration(row["silence_hours"]) if row["stale"] else "",
        "came": row["refused_newest"] if row["stale"] else 0,
        "unjudged": name_axes(sorted(a["axis"] for a in row["axes"] if a["level"] == UNJUDGED)),
        "higher": [f"Axis {axis['axis']}: {axis['rising']}" for axis in row["axes"] if axis.get("rising")],
        "coarse": name_axes(sorted(a["axis"] for a in row["axes"] if a["level"] == HEALTHY and a["axis"] in coarse)),
        "counts": row,
    }


def what_to_do(row: Mapping[str, Any], zone: tzinfo) -> str:
    """Return in one line what to do on a robot that is refused, asks for an entry under events or waits for a baseline:
    what mends its logs, the finding that asks, and the key to set; else empty."""
    parts = []
    if row["urgency"] == REFUSED:
        parts = _mends(row) or [f"{CHECKS[REFUSED]}: see 'reason'"]
    elif row["urgency"] == ASKS:
        parts = [CHECKS[ASKS], *[*_over(row), *(words for words, _ in _to_check(row, zone))][:1]]
    return "; ".join(filter(None, (*parts, _advice(row))))


def _advice(row: Mapping[str, Any]) -> str:
    """Return what ends that a robot cannot be judged, where a finding says it; else empty. It holds whatever else is
    wrong: a robot that waits for its baseline may be silent, too."""
    return next((f["advice"] for f in row["findings"] if f.get("advice")), "")


def _mends(row: Mapping[str, Any]) -> list[str]:
    """Return what mends the logs that are refused, as far as the reasons say it, each once; logs that no key may mend,
    as it would be wrong for the others, come after the rest."""
    clauses: list[str] = []
    whose: dict[str, list[str]] = {}
    alone: dict[str, list[str]] = {}
    for told in (row["reason"], *row["refusals"]):
        if told != row["reason"] and told.endswith(ALL_LOGS):
            log, _, what = told.partition(": ")
            alone.setdefault(_looks(what), []).append(log)
        else:
            what, *mends = (c.strip() for c in told.split("; "))
            clauses += mends
            log, named, _ = what.partition(": ")
            for clause in mends:
                whose.setdefault(clause, []).append(log if named else "this log")
    more = " and others" if row["refused_logs"] > len(row["refusals"]) else ""
    found = [
        # Away from its reason it has to say which log is meant.
        c.rstrip(".").replace("this log", f"{listed(list(dict.fromkeys(whose[c])))}{more}")
        for c in clauses
        if c.partition(" ")[0] in MENDS
    ]
    of = f"{more} alone, of {count(row['logs'], 'log')}"
    told = "Write it as in the others; a key of the robot would hold for these too"
    return [f"{c[:1].upper()}{c[1:]}" for c in dict.fromkeys(found)] + [
        f"Mend {listed(logs)}{of}: {looks}. {told}" for looks, logs in alone.items()
    ]


def _looks(what: str) -> str:
    """Return in words what a log looks like, from the reason `what` it is refused for; without numbers of its own."""
    looks = next((c for c in what.split("; ") if "look" in c), what.partition("; ")[0])
    whose = next((w for w in ("positions", "the temperature", "the torque") if what.startswith(w)), "its values")
    return re.sub("^(they|it) ", f"{whose} ", looks).removesuffix(" against the first log")


def _refusals(row: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what is wrong with the logs that are refused, and what mends it; the newest names those that say the same
    with other numbers."""
    alike: dict[str, list[tuple[str, str]]] = {}
    for told in row["refusals"]:
        what, _, why = told.partition("; ")
        if told != row["reason"]:
            alike.setdefault(_NUMBERS.sub("", why or what.partition(": ")[2]), []).append((what, why))
    result = []
    for *others, (what, why) in alike.values():
        names = [one.partition(": ")[0] for one, _ in others]
        result.append((f"{what}; likewise {listed(names)}" if names else what, why))
    return result


def _to_check(row: Mapping[str, Any], zone: tzinfo) -> list[tuple[str, bool]]:
    """Return the findings of a robot in words, each with its day and whether it is a note that asks for nothing: first
    those that ask for an answer, then those that somebody has to mend, the newest first.

    Those on backlash say what cannot be judged, those that an event has answered are done: neither is to be checked.
    What is over comes last, and of several of a kind the newest alone, with how many there were before.
    """
    open_ones = [f for f in row["findings"] if f["kind"] != BACKLASH and not f.get("answered")]
    newest = sorted(told_together(open_ones), key=lambda f: (to_do(f), is_note(f, row), -(f.get("time") or 0)))
    words = [(_dated(f, row, zone), is_note(f, row)) for f in newest if "end" not in f or lasts(f, row)]
    over: dict[str, list[tuple[str, bool]]] = {}
    for found in newest:
        if "end" in found and not lasts(found, row):
            over.setdefault(found["kind"], []).append((_dated(found, row, zone), is_note(found, row)))
    return words + [(f"{told[0][0]}{before_words(len(told) - 1)}", told[0][1]) for told in over.values()]


def _over(row: Mapping[str, Any]) -> list[str]:
    """Return what is said of the axes that are over their limit without an alarm."""
    return [f"Axis {axis['axis']}: {axis['over']}" for axis in row["axes"] if axis.get("over")]


def _dated(found: Mapping[str, Any], row: Mapping[str, Any], zone: tzinfo) -> str:
    """Return a finding in words with the day on which it was found, where it has one."""
    if not row["dated"] or found["kind"] in LASTING or found.get("time") is None:
        return found["words"]
    return f"{local_day(found['time'], zone)}: {found['words']}"


def _minute(row: Mapping[str, Any]) -> float:
    """The newest sample, to the minute where it has a date."""
    return row["last_sample"] - (row["last_sample"] % 60 if row["dated"] else 0.0)


def fleet_heading(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the heading: how many robots need attention."""
    waiting = [row for row in rows if row["urgency"] != HEALTHY]
    if not rows:
        return "No robot"
    higher = sum(any(axis.get("rising") for axis in row["axes"]) for row in rows)
    if not waiting and higher:
        return (
            f"No alarm on {len(rows)} robots, friction higher on {higher}"
            if len(rows) > 1
            else "No alarm; friction higher"
        )
    if not waiting:
        return f"Nothing to check on {len(rows)} robots" if len(rows) > 1 else "Nothing to check"
    return f"{len(waiting)} of {len(rows)} robots to look at" if len(rows) > 1 else "The robot needs attention"


def write_fleet_page(
    rows: Sequence[Mapping[str, Any]],
    output: str | Path,
    zone: tzinfo,
    now: float,
    link: str = "robots",
    waiting: Sequence[str] = (),
    others: Sequence[str] = (),
) -> None:
    """Write the page of ranked rows.

    Parameters
    ----------
    rows : of :func:`~jointwear.monitor.fleet.ranking.ranked`. now : [s since 1970] that they are as of.
    link : relative path from the page to the folders of the robots.
    waiting : channel of every message that could not be sent yet. others : robots beside these that another
        configuration named.
    """
    items = [robot_item(row, zone, link) for row in rows]
    context = {
        "heading": fleet_heading(rows),
        "unsent": {channel: list(waiting).count(channel) for channel in sorted(set(waiting))},
        "others": list(others),
        "as_of": local_time(now - now % 60, zone),
        "numbers": [(kind, BADGES[kind], sum(r["urgency"] == kind for r in rows)) for kind in ORDER],
        "waiting": [item for item in items if item["urgency"] != HEALTHY],
        "healthy": [item for item in items if item["urgency"] == HEALTHY],
        "items": items,
        "total": {key: sum(row[key] for row in rows) for key in COUNTS},
    }
    replace_text(output, render_page("fleet.html.j2", context))
