"""The condition of a robot now, axis by axis: what a page, a fleet, a message and a metric say alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from jointwear.monitor.advice import advice
from jointwear.monitor.episodes import Episode, episodes_of
from jointwear.monitor.events import events_of
from jointwear.monitor.judge import CHANGED, DEFAULT_LIMIT, DETECTORS, HEALTHY, UNJUDGED
from jointwear.monitor.state import RobotState

#: An axis with alarms that nobody has explained, though its friction is back to normal or no longer seen.
UNRESOLVED = "unresolved alarm"
#: Length of time at the end [s] that counts as now: a day, so that the shifts of a day weigh alike.
NOW = 86400.0
#: Fewest windows of now, where the windows are longer than that.
FEWEST_NOW = 3
#: Quantity of an alarm other than Coulomb friction -> the estimate that shows it.
SHOWN_BY = {"viscous friction": "viscous", "backlash": "backlash"}
#: An axis not judged for longer than this [s] and than this many times its longest pause before is healthy no more.
UNSEEN, PAUSES = 3 * NOW, 2.0


@dataclass(frozen=True)
class Outlook:
    """Hours from the newest window until the limit: median and 80 % interval; infinite where it may stay below."""

    hours: float
    low: float
    high: float


@dataclass(frozen=True)
class AxisCondition:
    """What is known of an axis now.

    `axis` 1-based. `level`: CHANGED, UNRESOLVED, UNJUDGED or HEALTHY. `growth`, `growth_std` of the Coulomb friction
    now and `limit`, all [%], NaN where unknown. `episodes`: unresolved ones, the newest first; `past`: resolved.
    `estimates`: quantity of an alarm -> its change now, NaN where unknown.
    """

    axis: int
    joint: str
    level: str
    growth: float
    growth_std: float
    limit: float
    outlook: Outlook | None
    episodes: tuple[Episode, ...]
    past: tuple[Episode, ...]
    estimates: Mapping[str, float] = field(default_factory=dict)

    @property
    def change(self) -> float | None:
        """What the quantity to act on has changed by: now where an estimate shows it, else at its newest alarm."""
        if self.main is None:
            return None
        now = self.estimates.get(self.main.quantity, math.nan)
        return now if math.isfinite(now) else self.main.newest["change"]

    @property
    def main(self) -> Episode | None:
        """The episode to act on: of the model-based detector before the paper's, the newest first."""
        ordered = sorted(self.episodes, key=lambda e: (e.detector != DETECTORS[0], -e.last))
        return ordered[0] if ordered else None

    @property
    def check(self) -> str:
        """What to check, one line; empty where nothing calls for it."""
        if self.main is None:
            return "known from an event of the config; keep watching it" if self.level == CHANGED else ""
        if self.level != CHANGED and self.main.detector == DETECTORS[0]:
            return (
                "friction is no longer raised, and nobody has said why: enter what was done under 'events', "
                "or look for it on the robot"
            )
        return advice(self.main.quantity, self.main.newest["change"])

    @property
    def reached(self) -> bool:
        """Whether the growth that is told has reached the limit while the axis counts as changed."""
        return self.level == CHANGED and bool(self.growth >= self.limit)


def axis_conditions(state: RobotState) -> list[AxisCondition]:
    """Return the condition of every axis."""
    found = episodes_of(state.alarms, events_of(state.entry))
    return [_condition(state, j, found) for j in range(state.axes)]


def robot_episodes(state: RobotState) -> list[Episode]:
    """Return the episodes that concern the robot as a whole."""
    return [e for e in episodes_of(state.alarms, events_of(state.entry)) if e.axis is None]


def _condition(state: RobotState, j: int, found: list[Episode]) -> AxisCondition:
    own = [e for e in found if e.axis == j + 1]
    open_ones = tuple(e for e in own if e.resolved is None)
    judged = np.flatnonzero(state.status[:, j] != UNJUDGED)
    after = judged[judged >= state.baseline]
    level = str(state.status[after[-1], j]) if len(after) else UNJUDGED
    if level == HEALTHY and _long_unseen(state, judged):
        level = UNJUDGED
    if level != CHANGED and open_ones:
        level = UNRESOLVED
    growth, std = latest(state, "coulomb_percent", j)
    return AxisCondition(
        axis=j + 1,
        joint=state.joints[j],
        level=level,
        growth=growth,
        growth_std=std,
        limit=float(state.entry.get("limits", {}).get("coulomb_increase_percent", DEFAULT_LIMIT)),
        outlook=_outlook(state, j) if level == CHANGED else None,
        episodes=open_ones,
        past=tuple(e for e in own if e.resolved is not None),
        estimates={quantity: latest(state, name, j)[0] for quantity, name in SHOWN_BY.items()},
    )


def _long_unseen(state: RobotState, judged: np.ndarray) -> bool:
    """Whether an axis has moved on unjudged since the last of its `judged` windows for longer than it ever paused."""
    pauses = np.diff(state.end[judged])
    since = float(state.end[-1] - state.end[judged[-1]])
    return since > max(UNSEEN, PAUSES * float(pauses.max(initial=0.0)))


def now_windows(state: RobotState) -> np.ndarray:
    """Return the indices of the windows that count as now."""
    recent = np.flatnonzero(state.end > state.end[-1] - NOW)
    return recent if len(recent) >= FEWEST_NOW else np.arange(max(0, len(state.end) - FEWEST_NOW), len(state.end))


def latest(state: RobotState, name: str, j: int) -> tuple[float, float]:
    """Return an estimate of a 0-based axis over the windows of now, weighted, and its standard deviation."""
    if name not in state.estimates:
        return math.nan, math.nan
    values, std, _ = state.estimates[name]
    recent = now_windows(state)
    value, error = values[recent, j], std[recent, j]
    good = np.isfinite(value) & (error > 0)
    if not good.any():
        return math.nan, math.nan
    weight = 1 / error[good] ** 2
    return float(np.average(value[good], weights=weight)), float(1 / np.sqrt(weight.sum()))


def _outlook(state: RobotState, j: int) -> Outlook | None:
    """The forecast as of the newest judged window, None where none is due."""
    stored = state.hours_to_limit[j]
    return None if np.isnan(stored).all() else Outlook(*(float(h) for h in stored))


def urgency(conditions: list[AxisCondition]) -> list[AxisCondition]:
    """Return the axes that need attention, the most urgent first: limit reached, soonest limit, largest growth."""

    def order(c: AxisCondition) -> tuple[Any, ...]:
        rank = 0 if c.reached else 1 if c.level == CHANGED else 2
        hours = c.outlook.hours if c.outlook else math.inf
        low = c.outlook.low if c.outlook else math.inf
        return rank, hours, low, -c.growth if math.isfinite(c.growth) else 0.0, c.axis

    return sorted((c for c in conditions if c.level in (CHANGED, UNRESOLVED)), key=order)


__all__ = [
    "CHANGED", "HEALTHY", "UNJUDGED", "UNRESOLVED", "AxisCondition", "Outlook", "axis_conditions", "latest",
    "now_windows", "robot_episodes", "urgency",
]  # fmt: skip
