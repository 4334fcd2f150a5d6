"""Lengths of time in the config: windows, and after how long a silent robot is reported.

Read by the Snakefile at every call: nothing heavy is imported here.
"""

from __future__ import annotations

import re

from jointwear.files.errors import InputError, shown

#: Shortest and longest length of time [s] in a config: a stroke of an arm, and the life of one.
SHORTEST, LONGEST = 1.0, 3650 * 86400.0
_SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
#: Units as people write them, without the s of the plural: (how many, of which unit). Not "m", which may be a month.
_SAID = {
    "sec": (1, "s"), "second": (1, "s"), "minute": (1, "min"), "min": (1, "min"), "h": (1, "h"), "hr": (1, "h"),
    "hour": (1, "h"), "d": (1, "d"), "day": (1, "d"), "w": (7, "d"), "wk": (7, "d"), "week": (7, "d"),
    "fortnight": (14, "d"),
}  # fmt: skip


def window_seconds(text: str | float) -> float:
    """Return the length of a window [s] from `1h`, `30min`, `600s`, `1d` or a number of seconds, as text or not.

    Raises
    ------
    InputError : if the text is no length of time, or the length is out of range.
    """
    if isinstance(text, (int, float)):
        length = float(text)
    else:
        match = re.fullmatch(r"\s*([0-9.]+)\s*(s|min|h|d)?\s*", text)
        try:
            length = float(match[1]) * _SECONDS[match[2] or "s"]
        except (TypeError, ValueError):
            raise InputError(
                f"{shown(text)} is no length of time (allowed: a number with s, min, h or d, as 1h){_meant(text)}"
            ) from None
    if not SHORTEST <= length <= LONGEST:
        near = f"{LONGEST / 86400:g}d" if length > LONGEST else f"{SHORTEST:g}s"
        raise InputError(
            f"{shown(text)} is out of range (allowed: {SHORTEST:g} s to {LONGEST / 86400:g} d); the nearest valid "
            f"value is {near}"
        )
    return length


def _meant(text: str) -> str:
    """Return the length of time that a text most likely means, as a proposal; empty where nothing comes near."""
    said = re.fullmatch(r"\s*([0-9]{1,9}(?:\.[0-9]{1,9})?)\s*([A-Za-z]+?)s?\.?\s*", text)
    if said is None or said[2].lower() not in _SAID:
        return ""
    times, unit = _SAID[said[2].lower()]
    return f"; the nearest valid value is {times * float(said[1]):g}{unit}"
