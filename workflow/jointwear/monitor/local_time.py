"""Times as people on the shop floor read them: in their zone, and the zone is said."""

from __future__ import annotations

import math
import re
from datetime import UTC, datetime, tzinfo
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError, available_timezones

from jointwear.files.errors import InputError, nearest, shown
from jointwear.measurement.timestamps import zone_of_offset

DEFAULT_ZONE = "UTC"
#: A time in the words of a finding.
_UTC_MINUTE = re.compile(r"\b\d{4}-\d\d-\d\dT\d\d:\d\dZ")
#: Key of the zone in which people read times; every other one is of a robot, in which its logger writes them.
PAGES = "monitor.time_zone"
#: A whole number of hours east of Greenwich, and an abbreviation of a time.
_OFFSET = re.compile(r"(?:UTC|GMT)?(?P<hours>[+-][0-9]{1,2})(?::?00)?")
_ABBREVIATION = re.compile(r"[A-Z]{3,5}")


def zone_of(name: str | None, key: str = PAGES) -> tzinfo:
    """Return the time zone that a key of the config names, an IANA name; None is UTC.

    Two keys have one name: that of a robot tells what its logger writes, that of all robots what people read.

    Raises
    ------
    InputError : naming the nearest zone, if there is none of that name.
    """
    name = name or DEFAULT_ZONE
    if name == DEFAULT_ZONE:
        return UTC
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        # No abbreviation stands for another, and Etc/GMT+1 lies west of Greenwich.
        places = (z for z in available_timezones() if "/" in z and not z.startswith("Etc/"))
        hint = _meant(name) or nearest(name, places)
        what = "in which pages and messages tell times" if key == PAGES else "of times in the logs that name none"
        raise InputError(
            f"config: '{key}' is {shown(name)}{hint} (the zone {what}; allowed: IANA names, as Europe/Berlin)"
        ) from None


def _meant(name: str) -> str:
    """Return what to give in place of an offset, or of an abbreviation, which is no zone; empty for all else."""
    offset = _OFFSET.fullmatch(name.strip())
    if offset and -12 <= (hours := int(offset["hours"])) <= 14:
        return f"; '{zone_of_offset(hours)}' is this offset all year; where summer time is kept, name the place"
    return "; an abbreviation is no zone: name the place" if _ABBREVIATION.fullmatch(name) else ""


def repeats_after(seconds: float, zone: tzinfo) -> float:
    """Return after how many seconds the clock on the wall shows the same time again, 0 where it does not: where summer
    time ends, an hour comes twice. `seconds` since 1970 UTC."""
    try:
        local = datetime.fromtimestamp(seconds, tz=zone)
    except (ValueError, OverflowError, OSError):
        return 0.0
    early, late = (zone.utcoffset(local.replace(fold=fold)) for fold in (0, 1))
    if local.fold or early is None or late is None or early <= late:
        return 0.0
    return (early - late).total_seconds()


def odd_hour(text: str, zone: tzinfo) -> str:
    """Return in words what is to be written for an ISO 8601 time without a zone that the clock on the wall of `zone`
    never shows, where summer time begins, or shows twice, where it ends; empty for all others.

    Raises
    ------
    ValueError : if the text is no such time.
    """
    wall = datetime.fromisoformat(text)
    if wall.tzinfo is not None:
        return ""
    early, late = (wall.replace(tzinfo=zone, fold=fold) for fold in (0, 1))
    if early.utcoffset() == late.utcoffset():
        return ""
    both = [moment.astimezone(UTC).astimezone(zone).isoformat() for moment in (early, late)]
    if early.utcoffset() < late.utcoffset():
        return f"a time that does not exist in {zone}, where summer time begins; did you mean '{both[0]}'?"
    return f"a time that comes twice in {zone}, where summer time ends; write '{both[0]}' or '{both[1]}'"


def local_time(seconds: float, zone: tzinfo) -> str:
    """Return seconds since 1970 UTC as `2026-01-05 07:00 CET`; seconds are shown where they are not zero."""
    if not math.isfinite(seconds):
        return ""
    moment = datetime.fromtimestamp(round(seconds), tz=zone)
    shape = "%Y-%m-%d %H:%M" if moment.second == 0 else "%Y-%m-%d %H:%M:%S"
    return f"{moment.strftime(shape)} {moment.strftime('%Z')}"


def local_day(seconds: float, zone: tzinfo) -> str:
    """Return seconds since 1970 UTC as `Mon 2026-01-05`."""
    return datetime.fromtimestamp(seconds, tz=zone).strftime("%a %Y-%m-%d")


def with_local_times(words: str, zone: tzinfo) -> str:
    """Return words of a finding, in which times stand as ISO 8601 UTC to the minute, with times of a zone in their
    place: what is kept of a robot does not depend on where its page is read."""

    def local(found: re.Match[str]) -> str:
        return local_time(datetime.fromisoformat(found[0]).timestamp(), zone)

    return _UTC_MINUTE.sub(local, words)


def log_time(seconds: float, zone: tzinfo, dated: bool, short: bool = False) -> str:
    """Return a time of the logs; without dates it is hours, or seconds where the logs are `short`."""
    if not math.isfinite(seconds):
        return ""
    if dated:
        return local_time(float(seconds), zone)
    return f"{seconds:.4g} s" if short else f"{seconds / 3600:.4g} h"


def duration(hours: float) -> str:
    """Return a length of time in the unit in which it is easily read."""
    if hours < 1:
        return f"{round(hours * 60)} min"
    if hours < 48:
        return f"{round(hours)} h"
    return f"{round(hours / 24)} days"
