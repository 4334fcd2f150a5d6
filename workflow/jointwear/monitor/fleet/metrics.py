"""Metrics of the fleet in the text format of Prometheus, for the textfile collector of its node exporter."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from prometheus_client import CollectorRegistry, Gauge, write_to_textfile

from jointwear.monitor.fleet.ranking import ORDER
from jointwear.monitor.presentation.condition import CHANGED, HEALTHY, UNJUDGED, UNRESOLVED
from jointwear.monitor.presentation.words import growth_now

LEVELS = (HEALTHY, UNRESOLVED, CHANGED, UNJUDGED)
#: Columns of a robot's row that are gauges of their own: name of the metric -> what it counts.
COUNTS = {
    "logs": "Logs that were read",
    "refused_logs": "Logs that were refused, at least in part",
    "copied_logs": "Logs with the samples of another, which count once",
    "stale_logs": "Logs expected since the newest one of a robot that is silent",
    "unjudged_logs": "Logs in which no axis could be judged",
    "windows": "Windows",
    "refused_windows": "Windows with refused samples",
    "stale_windows": "Windows expected since then",
    "unjudged_windows": "Windows in which no axis could be judged",
}


def write_metrics(rows: Sequence[Mapping[str, Any]], now: float, output: str | Path) -> None:
    """Write the metrics of the rows of :func:`~jointwear.monitor.fleet.ranking.as_of`; `now` [s since 1970]."""
    registry = CollectorRegistry()

    def gauge(name: str, words: str, labels: Iterable[str] = ()) -> Gauge:
        return Gauge(f"jointwear_{name}", words, list(labels), registry=registry)

    gauge("run_timestamp_seconds", "Time of this summary, since 1970 UTC").set(now)
    robot = ("robot",)
    axis = ("robot", "axis", "joint")
    urgency = gauge("robot_urgency", "1 for the urgency that the robot has, 0 for the others", ("robot", "urgency"))
    counts = {name: gauge(f"robot_{name}", words, robot) for name, words in COUNTS.items()}
    alarms = gauge("robot_alarms_unresolved", "Alarms that no event has explained", robot)
    last = gauge("robot_last_sample_timestamp_seconds", "Newest sample, since 1970 UTC", robot)
    state = gauge("axis_state", "1 for the state that the axis is in, 0 for the others", (*axis, "state"))
    growth = gauge("axis_coulomb_growth_ratio", "Growth of the Coulomb friction, 0.05 is 5 percent", axis)
    viscous = gauge("axis_viscous_growth_ratio", "Growth of the viscous friction, while it is told", axis)
    limit = gauge("axis_coulomb_limit_ratio", "Growth that counts as the limit", axis)
    hours = gauge("axis_hours_to_limit", "Hours from the end of the newest window to the limit", (*axis, "bound"))
    for row in rows:
        name = row["robot"]
        for kind in ORDER:
            urgency.labels(name, kind).set(int(row["urgency"] == kind))
        for column, metric in counts.items():
            metric.labels(name).set(row[column])
        alarms.labels(name).set(len(row["episodes"]))
        if row["dated"] and row["last_sample"] is not None:
            last.labels(name).set(row["last_sample"])
        for found in row["axes"]:
            labels = (name, str(found["axis"]), found["joint"])
            for level in LEVELS:
                state.labels(*labels, level).set(int(found["level"] == level))
            coulomb_now, viscous_now = growth_now(found)
            if coulomb_now is not None:
                growth.labels(*labels).set(coulomb_now / 100)
                limit.labels(*labels).set(found["limit"] / 100)
            if viscous_now is not None:
                viscous.labels(*labels).set(viscous_now / 100)
            for bound, value in zip(("median", "low", "high"), found["hours"] or (), strict=False):
                hours.labels(*labels, bound).set(math.inf if value is None else value)
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    write_to_textfile(str(output), registry)
