"""The condition of an axis in the words of a page, a table or a message."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import tzinfo
from typing import Any

from jointwear.monitor.condition import CHANGED, HEALTHY, UNJUDGED, UNRESOLVED
from jointwear.monitor.local_time import duration, local_day, log_time
from jointwear.publishing.report.numbers import fixed, number

BADGES = {HEALTHY: "agrees", CHANGED: "differs", UNRESOLVED: "close", UNJUDGED: "other"}
#: A space at which no line ends.
NO_BREAK = "\u00a0"
#: Share of the limit below which growth has no bar: it would not be seen.
LEAST_BAR = 0.02


def todo(row: Mapping[str, Any], axis: Mapping[str, Any], zone: tzinfo) -> dict[str, Any]:
    """Return what a page says of an axis that needs attention; rows as :mod:`.standing` makes them."""
    dated = row["dated"]
    return {
        "axis": axis["axis"],
        "title": f"Axis {axis['axis']}" + (f" ({axis['joint']})" if axis["joint"] else ""),
        "level": axis["level"],
        "badge": BADGES[axis["level"]],
        "change": change_words(axis).replace(" %", NO_BREAK + "%"),
        "bar": bar(axis),
        "outlook": outlook_words(row, axis, zone),
        "since": "" if axis["since"] is None else log_time(axis["since"], zone, dated),
        "alarms": axis["alarms"],
        "check": axis["check"][:1].upper() + axis["check"][1:],
    }


def bar(axis: Mapping[str, Any]) -> float | None:
    """Return the growth as a share of the limit in percent, at most 100; None where it is unknown or hardly any."""
    growth = axis["growth"]
    return None if growth is None or growth < LEAST_BAR * axis["limit"] else min(100.0, 100 * growth / axis["limit"])


def change_words(axis: Mapping[str, Any]) -> str:
    """Return how much the friction of an axis has grown, beside its limit, and any other quantity that alarmed."""
    words = []
    if axis["growth"] is not None:
        words.append(f"Coulomb friction {fixed(axis['growth'], 1, True)} % now, limit {number(axis['limit'], 2)} %")
    quantity = axis["quantity"]
    if quantity and "coulomb" not in quantity:
        size = "" if axis["change"] is None else f" {number(axis['change'], 2, True)} {axis['unit']}".rstrip()
        words.append(f"{quantity}{size}")
    return "; ".join(words)


def outlook_words(row: Mapping[str, Any], axis: Mapping[str, Any], zone: tzinfo) -> str:
    """Return the forecast of an axis in words: days for logs with dates, else the time since the last sample."""
    hours = axis.get("hours")
    if hours is None:
        return ""
    middle, low, high = hours
    limit = "limit"
    if "viscous" in axis.get("quantity", ""):
        # The bar and the growth beside it are of Coulomb friction, the forecast is not.
        limit = f"limit of viscous friction (+{number(axis['limit'], 2)} %)"
    if axis["reached"]:
        return "limit reached"
    if limit != "limit" and high == 0:
        return f"{limit} reached"
    if limit == "limit" and (axis.get("growth") or 0.0) < 0.0:
        # It grew from where it was learnt anew: beside the growth since the baseline that date would mislead.
        return ""
    if middle == 0:
        return f"{limit} may be reached any {'day' if row['dated'] else 'time'}"

    def at(value: float) -> str:
        return local_day(row["last_sample"] + 3600 * value, zone) if row["dated"] else duration(value)

    if low is None:
        return f"no {limit} in sight"
    if middle is None or high is None:
        return f"{limit} not before {at(low)}" if row["dated"] else f"{limit} not within {at(low)}"
    return f"{limit} {'around' if row['dated'] else 'in'} {at(middle)} ({at(low)} to {at(high)})"
