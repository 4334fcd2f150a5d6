"""What the monitor is to reach on the shop floor, and whether it did."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

#: Share of the fast worn axes to be found, median delay [h], share of right axes, and the coverage of 80 % intervals.
FOUND, DELAY, RIGHT, COVERAGE = 0.95, 48.0, 0.99, (0.72, 0.88)
#: The stated rate at which detection and forecasts are held to the aims [per 1,000 h].
AT = 1.0


def aims(scores: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return each aim as `words`, what was `found` in words, and whether it was `reached` (None without data).

    Parameters
    ----------
    scores : of :func:`jointwear.studies.shop_floor.scores.summary`, one per stated rate.
    """
    rows = []
    for s in scores:
        false = s["false"]
        inside = None if false["low"] is None else false["low"] <= s["rate"] <= false["high"]
        found = "no quiet hours" if inside is None else f"{false['per_1000_h']:.2f} in 1,000 h"
        words = f"the stated {s['rate']:g} false alarms in 1,000 h lie within the 95 % interval of those measured"
        rows.append({"words": words, "found": found, "reached": inside})
    middle = next((s for s in scores if s["rate"] == AT), scores[0])
    fast = middle["coulomb_in_two_weeks"]
    share, delay = fast["found"], fast["delay"]["median"]
    words = f"{100 * FOUND:.0f} % of the axes with 20 % growth within two weeks are found within two weeks"
    rows.append(_aim(words, share["share"], lambda x: x >= FOUND, f"{share['count']} of {share['of']}"))
    rows.append(_aim(f"their median delay is at most {DELAY:g} h", delay, lambda x: x <= DELAY, f"{delay or 0:.0f} h"))
    right = middle["coulomb"]["right"]
    words = f"the axis is right in {100 * RIGHT:.0f} %"
    rows.append(_aim(words, right["share"], lambda x: x >= RIGHT, f"{right['count']} of {right['of']}"))
    for key, when in (("forecast", "at the alarm"), ("forecast_later", "a day later")):
        held = middle[key]["held"]
        words = f"80 % forecast intervals hold in {100 * COVERAGE[0]:.0f} % to {100 * COVERAGE[1]:.0f} %, {when}"
        found = f"{held['count']} of {held['of']}, {middle[key]['open']} of them open ended"
        rows.append(_aim(words, held["share"], lambda x: COVERAGE[0] <= x <= COVERAGE[1], found))
    return rows


def _aim(words: str, value: float | None, good, found: str) -> dict[str, Any]:
    return {"words": words, "found": found, "reached": None if value is None else bool(good(value))}
