"""The condition of an axis in the words of a page, a table or a message."""

from __future__ import annotations

import math
from collections.abc import Mapping
from datetime import tzinfo
from typing import Any

from jointwear.files.shown_numbers import fixed, number
from jointwear.monitor.local_time import duration, local_day, log_time, with_local_times
from jointwear.monitor.presentation.advice import advice
from jointwear.monitor.presentation.condition import (
    CHANGED,
    HEALTHY,
    MOST_TOLD,
    REACHED,
    UNJUDGED,
    UNRESOLVED,
    AxisCondition,
)
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.monitor.watching.limits import COULOMB, VISCOUS

#: What is said in place of the level of an axis without an alarm whose friction is over the limit all the same.
OVER = "over the limit, no alarm"
#: What is said in place of the level of one whose friction has clearly grown by a good part of the limit.
HIGHER = "higher, no alarm"
BADGES = {HEALTHY: "agrees", CHANGED: "differs", UNRESOLVED: "close", UNJUDGED: "other"}
#: A space at which no line ends.
NO_BREAK = "\u00a0"
#: Probability of an axis above which no digit is told.
SURE = 0.99
#: What a forecast of no hours says: half of all courses that agree with the logs are at the limit, the mean is not.
MAY_BE_REACHED = "may be reached by now"
#: The same of an alarm, as of then.
REACHED_THEN, MAY_HAVE_BEEN = "reached", "may have been reached"
#: Share of the limit below which growth has no bar: it would not be seen.
LEAST_BAR = 0.02


def todo(row: Mapping[str, Any], axis: Mapping[str, Any], zone: tzinfo) -> dict[str, Any]:
    """Return what a page says of an axis that needs attention; rows as :mod:`.standing` makes them."""
    dated = row["dated"]
    return {
        "axis": axis["axis"],
        "title": f"Axis {axis['axis']}" + (f" ({axis['joint']})" if axis["joint"] else ""),
        "level": REACHED if axis["reached"] else axis["level"],
        "badge": BADGES[axis["level"]],
        "sure": sure_words(axis.get("probability")),
        "change": change_words(axis, until_words(row, axis, zone)).replace(" %", NO_BREAK + "%"),
        "bar": bar(axis),
        "outlook": outlook_words(row, axis, zone),
        "since": "" if axis["since"] is None else log_time(axis["since"], zone, dated),
        "alarms": axis["alarms"],
        "anew": anew_words(row, axis, zone),
        "check": with_local_times(axis["check"][:1].upper() + axis["check"][1:], zone),
    }


def over_words(condition: AxisCondition) -> str:
    """Return what is said of an axis whose friction is over the limit though nothing has alarmed, empty elsewhere."""
    kind = condition.over
    if not kind:
        return ""
    grown = {VISCOUS: condition.viscous, COULOMB: condition.growth}
    (other,) = set(grown) - {kind}
    beside = "" if math.isnan(grown[other]) else f", {other} {fixed(grown[other], 1, True)} %"
    # Lots of parts make single windows jump by more than an alarm believes.
    why = "ask whether it carries another part or runs another program than the logs label; if not, "
    if kind == VISCOUS and grown[other] < 0:
        # An axis that was greased: the judgement knows it, and gives no alarm.
        why = f"thicker grease does that, wear does not. Enter it under 'events' if it was greased; if not, {why}"
    limit = f"over the limit of {number(condition.limit, 2)} % without an alarm"
    told = f"{kind} {fixed(grown[kind], 1, True)} % now{beside}, {limit}; {why}{advice(kind, None)}."
    return told.replace("coulomb", "Coulomb").replace(" %", f"{NO_BREAK}%")


def rising_words(condition: AxisCondition) -> str:
    """Return what is said of an axis whose friction has clearly grown though nothing has alarmed, empty elsewhere."""
    if not condition.rising:
        return ""
    told = (
        f"Coulomb friction {fixed(condition.growth, 1, True)} % now, with a standard error of "
        f"{fixed(condition.growth_std, 1)} %, of the limit of {number(condition.limit, 2)} %: too little for an alarm "
        "so far, too much to be called no change; keep an eye on it."
    )
    return told.replace(" %", f"{NO_BREAK}%")


def sure_words(probability: float | None) -> str:
    """Return in words how likely it is that an alarm names the right axis, empty where nothing says so."""
    percent = sure_percent(probability)
    return f"{percent.replace(' ', NO_BREAK)} this axis rather than another" if percent else ""


def sure_percent(probability: float | None) -> str:
    """Return a probability of an axis in percent, empty where there is none."""
    return "" if probability is None else "> 99 %" if probability > SURE else f"{100 * probability:.0f} %"


def growth_now(axis: Mapping[str, Any]) -> tuple[float | None, float | None]:
    """Return the growth of Coulomb and of viscous friction [%] as of now, None where unknown or not told.

    After an event that of before is told in words alone, with until when it holds, while nothing has been judged since.
    """
    return (None, None) if axis.get("event") else (axis["growth"], axis.get("viscous_growth"))


def bar(axis: Mapping[str, Any]) -> float | None:
    """Return the growth as a share of the limit in percent, at most 100; None where it is unknown or hardly any.

    Of Coulomb or viscous friction, whichever has used up more of its limit.
    """
    known = [g for g in growth_now(axis) if g is not None]
    growth = max(known, default=0.0)
    return None if growth < LEAST_BAR * axis["limit"] or not known else min(100.0, 100 * growth / axis["limit"])


def event_words(event: Mapping[str, Any], zone: tzinfo, dated: bool, of: str = "") -> str:
    """Return an event of the config as `service 2026-11-29 06:00 CET: greased`; `of` stands before its time."""
    note = f": {event['note']}" if event.get("note") else ""
    return f"{event['kind']} {of}{log_time(event['time'], zone, dated)}{note}"


def until_words(row: Mapping[str, Any], axis: Mapping[str, Any], zone: tzinfo) -> str:
    """Return until when the growth of an axis is told where nothing has been judged since an event, empty elsewhere."""
    event = axis.get("event")
    if event is None:
        return ""
    until = log_time(axis["until"], zone, row["dated"])
    return f"until {until}, before the event ({event_words({**event, 'note': ''}, zone, row['dated'])})"


def change_words(axis: Mapping[str, Any], until: str = "") -> str:
    """Return how much the friction of an axis has grown, beside its limit, and any other quantity that alarmed;
    `until` when where that is not now."""
    now = until or "now"
    words, limit = [], f"limit {number(axis['limit'], 2)} %"
    if axis["growth"] is not None:
        words.append(f"Coulomb friction {fixed(axis['growth'], 1, True)} % {now}, {limit}")
    quantity = axis["quantity"]
    size = "" if axis["change"] is None else f"{number(axis['change'], 2, True)} {axis['unit']}".rstrip()
    viscous = axis.get("viscous_growth")
    if viscous is not None:
        grown = f"more than {MOST_TOLD:+.0f}" if viscous > MOST_TOLD else fixed(viscous, 1, True)
        own = f" ({size})" if "viscous" in quantity and size else ""
        words.insert(0 if own else 1, f"viscous friction {grown} % {now}{own}, {limit}")
    elif quantity == BACKLASH and size:
        # What else the torque does near reversals is in the pulses before and after: they grew by more than it shows.
        words.append(f"{quantity}: pulses at reversals by {size} at least")
    elif quantity and "coulomb" not in quantity:
        words.append(f"{quantity} {size or 'changed'}")
    elif size and not words:
        words.append(f"Coulomb friction {size} at its newest alarm, not judged now; {limit}")
    told = "; ".join([*words, "being learnt anew"] if until else words)
    return told[:1].upper() + told[1:] if viscous is not None else told


def anew_words(row: Mapping[str, Any], axis: Mapping[str, Any], zone: tzinfo) -> str:
    """Return since when the growth of an axis counts, empty where it does since the normal period.

    Who has closed an alarm without a repair has to know that the limit is measured from there.
    """
    event = axis.get("anew")
    if event is None:
        return ""
    return f"growth counts from {log_time(event['time'], zone, row['dated'])} ({event['kind']})"


def row_words(alarm: Mapping[str, Any]) -> dict[str, str]:
    """Return what a page says of a row of alarms.csv: how much was `grown` by then, as a share where that is known, its
    interval `of_it`, the same `in_unit`; and the hours `ahead` to the limit, and their interval `of_ahead`.

    A forecast of no hours is told as of then: what was below the limit may have reached it, at the latest when its
    interval ends.
    """
    said = dict.fromkeys(("grown", "of_it", "in_unit", "ahead", "of_ahead"), "")
    said["grown"] = said["ahead"] = "–"
    size, share = ([alarm[f"{name}{end}"] for end in ("", "_low", "_high")] for name in ("change", "growth_percent"))
    if size[0] is not None:
        in_unit = f"{number(size[0], 3, True)} {alarm['unit'] or ''}".rstrip()
        told = share if share[0] is not None else size
        said["of_it"] = " to ".join(number(v) for v in told[1:])
        said["grown"] = in_unit
        if share[0] is not None:
            said["grown"], said["in_unit"] = f"{fixed(share[0], 1, True)}{NO_BREAK}%", in_unit
    middle, low, high = (alarm[f"hours_to_limit{end}"] for end in ("", "_low", "_high"))
    if middle == 0:
        beyond = share[0] is not None and alarm["limit_percent"] is not None and share[0] >= alarm["limit_percent"]
        said["ahead"] = REACHED_THEN if beyond else MAY_HAVE_BEEN
        latest = "" if beyond or high == 0 else f"in {number(high)} at the latest" if high is not None else "or never"
        said["of_ahead"] = latest
    elif middle is not None or low is not None:
        said["ahead"] = number(middle) if middle is not None else "∞"
        said["of_ahead"] = f"{number(low)} to {number(high) if high is not None else '∞'}"
    return said


def outlook_words(row: Mapping[str, Any], axis: Mapping[str, Any], zone: tzinfo) -> str:
    """Return the forecast of an axis in words: days for logs with dates, else the time since the newest window."""
    if axis["reached"]:
        return REACHED
    hours = axis.get("hours")
    if hours is None:
        return ""
    middle, low, high = hours
    limit, quantity = "limit", axis.get("quantity", "")
    kind = axis.get("limited_by") or quantity
    # Of two quantities it is told whose limit it is.
    if "viscous" in kind or ("coulomb" in kind and "viscous" in quantity):
        limit = f"limit of {'viscous' if 'viscous' in kind else 'Coulomb'} friction (+{number(axis['limit'], 2)} %)"
    if limit != "limit" and high == 0:
        # Growth that is told as less than the limit, though some of it may not be seen, has not reached it.
        # While the axis is not judged its limit comes by the forecast alone.
        grown = axis.get("viscous_growth" if "viscous" in kind else "growth")
        below = grown is None or round(grown, 1) < axis["limit"]
        return f"{limit} {MAY_BE_REACHED if below or axis.get('unsure') else 'reached'}"
    if limit == "limit" and (axis.get("growth") or 0.0) < 0.0:
        # It grew from where it was learnt anew: beside the growth since the baseline that date would mislead.
        return ""
    if middle == 0:
        return f"{limit} {MAY_BE_REACHED}"

    middle_at, low_at, high_at = (
        [local_day(moment, zone) if moment is not None else "" for moment in axis["limit_at"]]
        if row["dated"]
        else ["" if value is None else duration(value) for value in hours]
    )
    if low is None:
        return f"no {limit} in sight"
    if high is None and low == 0:
        # Half a sentence on its lower end would date it as from today.
        return f"{limit} may be reached by now, or never"
    if middle is None or high is None:
        return f"{limit} not {'before' if row['dated'] else 'within'} {low_at}"
    return f"{limit} {'around' if row['dated'] else 'in'} {middle_at} ({low_at} to {high_at})"
