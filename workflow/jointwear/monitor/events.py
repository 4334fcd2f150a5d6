"""What was done to a robot, as its entry in the config says: each event starts a new baseline of the axes concerned."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import tzinfo
from typing import Any

from jointwear.files.errors import InputError, shown
from jointwear.measurement.timestamps import LATEST, meant, moment_of, names_zone
from jointwear.monitor.local_time import zone_of

KINDS = ("service", "sensor", "program", "acknowledged")
#: Kind of an event that changes how a robot runs and nothing about its joints: what they had grown by goes on.
NEW_PROGRAM = "program"
#: Farthest that a clock runs ahead of UTC [s]: by as much may a time be ahead of now that is of the clock of the logs,
#: as neither it nor the entry states a zone.
ZONES = 14 * 3600.0
#: Time ahead [s], a year, beyond which nobody plans a service: the date is mistyped.
FAR = 366 * 86400.0
#: Key of an entry under which :func:`acting` puts events that are yet to come.
PLANNED = "planned_events"


@dataclass(frozen=True)
class Event:
    """`time` [s]; `axes`: 0-based, all where empty; `kind` of :data:`KINDS`; `note`: of the user."""

    time: float
    axes: tuple[int, ...]
    kind: str
    note: str = ""

    @property
    def mends(self) -> bool:
        """Whether it may be why an axis is no longer what it was; a change of program repairs no gear."""
        return self.kind != NEW_PROGRAM

    def concerns(self, axis: int) -> bool:
        """Return whether a 0-based axis is concerned."""
        return not self.axes or axis in self.axes

    def follows(self, alarm: Mapping[str, Any], length: float) -> bool:
        """Return whether it is what comes after an alarm, whose `time` [s] is the end of its window of `length` [s]: as
        in :func:`event_windows` what begins anew is the first window after the event, so that an alarm of the window in
        which it lies is one of before."""
        return self.time > float(alarm["time"]) - length


def events_of(entry: Mapping[str, Any]) -> tuple[Event, ...]:
    """Return the events of an entry of ``monitor.robots``, in order of time; as in its logs, times without a zone are
    those of its `time_zone`.

    Raises
    ------
    InputError : naming the event, if its time is none.
    """
    return _events(entry.get("events") or (), zone_of(entry.get("time_zone")))


def planned_events(entry: Mapping[str, Any]) -> list[tuple[Event, bool]]:
    """Return the events of an entry that are yet to come, see :func:`acting`, each with whether it is so far ahead that
    its date is mistyped."""
    zone = zone_of(entry.get("time_zone"))
    return [(_events([given], zone)[0], bool(given.get("far"))) for given in entry.get(PLANNED) or ()]


def _events(listed: Sequence[Mapping[str, Any]], zone: tzinfo) -> tuple[Event, ...]:
    events = []
    for k, given in enumerate(listed):
        try:
            time = moment_of(given["time"], zone)
        except (KeyError, ValueError):
            raise InputError(
                f"config: 'events[{k}].time' is {shown(given.get('time'))}{meant(given.get('time'))} (allowed: "
                f"ISO 8601, as 2026-02-01T06:00:00Z, or seconds for logs without a date, at most {LATEST:g} in size)"
            ) from None
        axes = tuple(int(a) - 1 for a in given.get("axes") or ())
        events.append(Event(time, axes, given.get("kind", "service"), given.get("note", "")))
    return tuple(sorted(events, key=lambda e: e.time))


def acting(entry: Mapping[str, Any], now: float) -> dict[str, Any]:
    """Return an entry with those `events` alone that act at `now` [s since 1970], the others under :data:`PLANNED`.

    One that is yet to come would close every alarm until then. It acts from its time on, as the entry changes then;
    where nothing states a zone, up to :data:`ZONES` earlier.
    """
    given = list(entry.get("events") or ())
    zone = zone_of(entry.get("time_zone"))

    def to_come(time: Any) -> bool:
        if not isinstance(time, str):
            return False
        unknown = not entry.get("time_zone") and not names_zone(time)
        return moment_of(time, zone) > now + (ZONES if unknown else 0.0)

    planned = [e for e in given if to_come(e["time"])]
    if not planned:
        return dict(entry)
    far = [{**e, "far": moment_of(e["time"], zone) > now + FAR} for e in planned]
    return {**entry, "events": [e for e in given if e not in planned], PLANNED: far}


def event_windows(events: Sequence[Event], start: Sequence[float], axes: int) -> list[list[int]]:
    """Return for each axis the first window that begins at or after each of its events; none after the last window."""
    result: list[list[int]] = [[] for _ in range(axes)]
    for event in events:
        k = bisect_left(start, event.time)
        for j in range(axes):
            if 0 < k < len(start) and event.concerns(j) and k not in result[j]:
                result[j].append(k)
    return result
