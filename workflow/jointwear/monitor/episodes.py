"""Alarms as episodes: what is one story to who keeps the robot running, and whether somebody has closed it.

An axis that has changed alarms again every day. All alarms of one quantity, axis and detector between two events of
that axis are one episode. Only an event of the config (service, sensor, program, acknowledged) resolves it: friction
that comes back by itself is no explanation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jointwear.measurement.timestamps import utc_seconds


@dataclass(frozen=True)
class Event:
    """What was done to a robot at `time` [s, the clock of the logs]; `axes` 1-based, empty for all."""

    time: float
    axes: tuple[int, ...]
    kind: str
    note: str

    def concerns(self, axis: int | None) -> bool:
        """Whether the event is about an axis; one about some axes does not explain a finding on the whole robot."""
        return not self.axes or axis in self.axes


@dataclass(frozen=True)
class Episode:
    """Alarms of one quantity, axis and detector between two events.

    `axis` 1-based, None for the whole robot; `alarms` in order of time, records as in alarms.csv with `time` in
    seconds; `resolved` by the event that followed, or None.
    """

    axis: int | None
    quantity: str
    detector: str
    alarms: tuple[Mapping[str, Any], ...]
    resolved: Event | None

    @property
    def first(self) -> float:
        """Time of the first alarm [s]."""
        return float(self.alarms[0]["time"])

    @property
    def last(self) -> float:
        """Time of the newest alarm [s]."""
        return float(self.alarms[-1]["time"])

    @property
    def newest(self) -> Mapping[str, Any]:
        """The newest alarm."""
        return self.alarms[-1]

    @property
    def key(self) -> str:
        """A name that stays the same as long as the episode lasts."""
        return f"{self.axis or 'all'}|{self.quantity}|{self.detector}|{self.first:.0f}"


def events_of(entry: Mapping[str, Any]) -> list[Event]:
    """Return the events of a robot's entry in order of time."""
    events = []
    for given in entry.get("events") or ():
        time = given["time"]
        events.append(
            Event(
                time=utc_seconds(time) if isinstance(time, str) else float(time),
                axes=tuple(int(a) for a in given.get("axes") or ()),
                kind=str(given.get("kind", "service")),
                note=str(given.get("note", "")),
            )
        )
    return sorted(events, key=lambda e: e.time)


def episodes_of(alarms: Sequence[Mapping[str, Any]], events: Sequence[Event]) -> list[Episode]:
    """Return the episodes, unresolved ones first, of these the newest first."""
    stories: dict[tuple, list[Mapping[str, Any]]] = {}
    closed: dict[tuple, Event | None] = {}
    for alarm in sorted(alarms, key=lambda a: a["time"]):
        axis = alarm["axis"] or None
        later = [e for e in events if e.concerns(axis) and e.time >= alarm["time"]]
        end = later[0] if later else None
        key = (axis, alarm["quantity"], alarm["detector"], None if end is None else end.time)
        stories.setdefault(key, []).append(alarm)
        closed[key] = end
    found = [Episode(*key[:3], tuple(rows), closed[key]) for key, rows in stories.items()]
    return sorted(found, key=lambda e: (e.resolved is not None, -e.last, e.axis or 0))
