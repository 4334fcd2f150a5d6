"""Alarms as episodes: what is one story to who keeps the robot running, and whether somebody has closed it.

An axis that has changed alarms again every day. All alarms of one quantity, axis and detector between two events of
that axis are one episode. Only an event of the config (service, sensor, acknowledged) resolves it: friction that comes
back by itself is no explanation, and wear goes on under another program.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jointwear.monitor.events import Event


@dataclass(frozen=True)
class Episode:
    """Alarms of one quantity, axis and detector between two events.

    `axis` 1-based, None for the whole robot; `alarms` in order of time, records as in alarms.csv with `time` in
    seconds; `resolved` by the event that followed, or None; `before`: the event that closed the episode before it, or
    None; `earlier`: how many episodes of the same quantity, axis and detector came before it.
    """

    axis: int | None
    quantity: str
    detector: str
    alarms: tuple[Mapping[str, Any], ...]
    resolved: Event | None
    before: Event | None = None
    earlier: int = 0

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
        """A name that stays the same as long as the episode lasts, whatever the times of its alarms become and whatever
        events come into the config that close nothing of its story."""
        return f"{self.axis or 'all'}|{self.quantity}|{self.detector}|{self.earlier or ''}"


def _resolves(event: Event, axis: int | None) -> bool:
    """Whether an event may explain alarms of a 1-based axis; one about some axes does not explain those of the whole
    robot."""
    about = not event.axes if axis is None else event.concerns(axis - 1)
    return about and event.mends


def episodes_of(alarms: Sequence[Mapping[str, Any]], events: Sequence[Event], length: float) -> list[Episode]:
    """Return the episodes, unresolved ones first, of these the newest first.

    Parameters
    ----------
    alarms : rows of alarms.csv, `time` in seconds. events : in order of time. length : of a window [s].
    """
    stories: dict[tuple, list[tuple[Event | None, list[Mapping[str, Any]]]]] = {}
    for alarm in sorted(alarms, key=lambda a: a["time"]):
        axis = alarm["axis"] or None
        end = next((e for e in events if _resolves(e, axis) and e.follows(alarm, length)), None)
        story = stories.setdefault((axis, alarm["quantity"], alarm["detector"]), [])
        if not story or story[-1][0] is not end:
            story.append((end, []))
        story[-1][1].append(alarm)
    found = [
        Episode(*key, tuple(rows), end, story[k - 1][0] if k else None, k)
        for key, story in stories.items()
        for k, (end, rows) in enumerate(story)
    ]
    return sorted(found, key=lambda e: (e.resolved is not None, -e.last, e.axis or 0))
