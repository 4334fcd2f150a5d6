"""Robots by urgency, and what is said of each as of now."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from jointwear.monitor.local_time import duration
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, REACHED, UNJUDGED, UNRESOLVED
from jointwear.monitor.presentation.to_answer import AHEAD, asks_for_answer, lasts
from jointwear.monitor.presentation.words import growth_now

#: What a robot can be in, the most urgent first, and the words for it.
REFUSED, STALE, ASKS = "refused", "stale", "needs an entry under events"
ORDER = (REACHED, CHANGED, REFUSED, UNRESOLVED, ASKS, STALE, UNJUDGED, HEALTHY)
#: Times its rhythm after which a log that cannot be read yet is not one that is being written: by then the next one is
#: due, too.
BEING_WRITTEN = 2.0
#: Silence [h] after which a robot counts as stale where the config does not say: longer than a weekend.
STALE_AFTER_HOURS = 72.0
#: Time [s] by which the newest sample may be dated ahead of now: more than a wrong time zone makes of it.
MOST_AHEAD = 86400.0


def silence_hours(row: Mapping[str, Any], now: float) -> float:
    """Return the hours since the last sample, NaN for logs without a date or a robot without any."""
    if not row["dated"] or row["last_sample"] is None:
        return math.nan
    return max(now - row["last_sample"], 0.0) / 3600


def dated_ahead(row: Mapping[str, Any], now: float) -> list[dict[str, Any]]:
    """Return a finding on a newest sample of the time to come, none where it is of now or before.

    Nobody would be told when the logs of such a robot stop, until its date has passed.
    """
    ahead = row["last_sample"] - now if row["dated"] and row["last_sample"] is not None else 0.0
    if ahead <= MOST_AHEAD:
        return []
    words = (
        f"The newest sample is dated {duration(ahead / 3600)} ahead of now: the clock of a log is wrong, or that of "
        "this machine. Until that day it cannot be told whether new logs come; mend the dates or leave the log out."
    )
    return [{"time": None, "axes": [], "kind": AHEAD, "words": words}]


def asks(row: Mapping[str, Any]) -> bool:
    """Return whether a robot has a finding that somebody has to answer, or whose newest hour has it, or an axis that is
    over its limit without an alarm."""
    open_ones = [found for found in row["findings"] if not found.get("answered")]
    lasting = any(lasts(found, row) for found in open_ones)
    over = any(axis.get("over") for axis in row["axes"])
    return lasting or over or any(asks_for_answer(found) for found in open_ones)


def as_of(row: Mapping[str, Any], now: float, stale_after: float = STALE_AFTER_HOURS) -> dict[str, Any]:
    """Return a robot's row with `urgency`, `silence_hours`, `stale_logs`, `stale_windows` as of `now` [s since 1970].

    A last log without a sample counts as refused once the robot has been silent for too long for it to be the one that
    is being written, or where the logs do not tell. Stale logs are those that are overdue by the robot's own rhythm,
    stale windows those that they would have filled, as many of each as before; both are 0 until the robot has been
    silent for `stale_after` hours.
    """
    row = {**row, "findings": [*dated_ahead(row, now), *row["findings"]]}
    silence = silence_hours(row, now)
    stale = silence > stale_after
    overdue = max(1, math.floor(silence / row["rhythm_hours"])) if stale and row["rhythm_hours"] else int(stale)
    levels = {axis["level"] for axis in row["axes"]}
    being_written = bool(row["rhythm_hours"]) and silence <= BEING_WRITTEN * row["rhythm_hours"]
    refused = row["refused_newest"] + (row["unfinished"] and not being_written)
    if row["result"] != "judged":
        urgency = REFUSED
    elif any(axis["reached"] for axis in row["axes"]):
        urgency = REACHED
    elif CHANGED in levels:
        urgency = CHANGED
    # Not the logs of which something was left out: one with a torn row is judged by all its other rows.
    elif refused:
        urgency = REFUSED
    elif UNRESOLVED in levels or row["episodes"]:
        urgency = UNRESOLVED
    elif asks(row):
        urgency = ASKS
    elif stale:
        urgency = STALE
    elif HEALTHY not in levels:
        urgency = UNJUDGED
    else:
        urgency = HEALTHY
    return {
        **row,
        "urgency": urgency,
        "refused_newest": refused,
        "silence_hours": None if math.isnan(silence) else silence,
        "stale": bool(stale),
        "stale_logs": overdue,
        "stale_windows": math.ceil(overdue * row["windows"] / row["logs"]) if stale and row["logs"] else 0,
    }


def ranked(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return rows of :func:`as_of`, the most urgent first: within a kind the soonest limit, then the largest growth.

    Growth of before an event that has not been judged since counts as none: it is not that of now.
    """

    def order(row: Mapping[str, Any]) -> tuple[Any, ...]:
        first = row["axes"][0] if row["axes"] else {}
        hours = first.get("hours") or [math.inf] * 3
        soonest = [math.inf if h is None else h for h in hours]
        problems = row["refused_logs"] + row["stale_logs"]
        return (
            ORDER.index(row["urgency"]),
            soonest[0],
            soonest[1],
            -((growth_now(first)[0] if first else None) or 0.0),
            -problems,
            row["robot"],
        )

    return sorted((dict(row) for row in rows), key=order)
