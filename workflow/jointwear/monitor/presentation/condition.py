"""The condition of a robot now, axis by axis: what a page, a fleet, a message and a metric say alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from jointwear.monitor.events import Event, events_of
from jointwear.monitor.findings.findings import SHARED
from jointwear.monitor.findings.loud import LOUD
from jointwear.monitor.judging.judge_settings import DEFAULT_LIMIT
from jointwear.monitor.judging.state import RobotState
from jointwear.monitor.presentation.advice import CONTRADICTED, REPAIRED, SCALED, UNSURE, advice, at_next_service
from jointwear.monitor.presentation.episodes import Episode, episodes_of
from jointwear.monitor.presentation.overnight import greased_since, rose_alike, rose_overnight
from jointwear.monitor.presentation.with_part import asked_of_part
from jointwear.monitor.reading.zeros import ZERO
from jointwear.monitor.watching.backlash import BACKLASH
from jointwear.monitor.watching.limits import COULOMB, VISCOUS, LimitDate
from jointwear.monitor.watching.present import FEWEST_NOW, NOW, mean_now, now_windows
from jointwear.monitor.watching.records import CHANGED, HEALTHY, UNJUDGED, VISCOUS_UNIT, Reason

#: An axis with alarms that nobody has explained, though its friction is back to normal or no longer seen.
UNRESOLVED = "unresolved alarm"
#: What is said of a changed axis whose growth has reached its limit.
REACHED = "limit reached"
#: Quantity of an alarm other than Coulomb friction -> the estimate that shows it.
SHOWN_BY = {VISCOUS: "viscous", BACKLASH: "backlash"}
#: Probability of an axis below which it is no likelier than all others together.
EVEN_ODDS = 0.5
#: Standard deviations of a growth that is more than chance.
MORE_THAN_CHANCE = 2.0
#: Share of the limit, and standard deviations, from which on growth of Coulomb friction is told without an alarm.
RISING, SURELY = 0.4, 3.0
#: Share of the limit below which growth is small, and time [s], a month, in which a limit is near: a service that can
#: wait has its turn by then.
SMALL, SOON = 0.1, 30 * 86400.0
#: Share of the limit by which Coulomb friction is clearly below normal, as no wear makes it.
BELOW = 0.25
#: Growth of viscous friction [%] above which no value is told: there was too little of it before to measure it by.
MOST_TOLD = 100.0
#: An axis not judged for longer than this [s] and than this many times its longest pause before is healthy no more.
UNSEEN, PAUSES = 3 * NOW, 2.0
#: Why an axis that moves is not judged, where that is no pause: it waits for what is normal to be learnt, or for its
#: logs to be mended. A program that never shows its friction is one.
WAITS = (Reason.LEARNING, Reason.CONDITIONS, Reason.LOUD, Reason.DRIVES, Reason.UNSURE)


@dataclass(frozen=True)
class AxisCondition:
    """What is known of an axis now.

    `axis` 1-based. `level`: CHANGED, UNRESOLVED, UNJUDGED or HEALTHY. `growth`, `growth_std` of the Coulomb friction
    now and `limit`, all [%], NaN where unknown; `viscous`, `viscous_std`: the same of viscous friction. `limited`: when
    which growth reaches that limit, None where no date is told. `episodes`: unresolved ones of alarms that count, the
    newest first; `past`: resolved. `estimates`: quantity of an alarm -> its change now, NaN where unknown. `seen`: it
    has been judged after the baseline. `loud`: its torque has grown uneven.
    `turned`: time [s] from which a joint of the robot counts from another zero, which nobody has answered. `anew`: the
    newest event that mends it, from which its growth counts; None where there is none. `event`: the newest event after
    which nothing of the axis has been judged yet, None where there is none; its growth is then that of before, up to
    `until` [s], the end of the window that it was judged in last, and NaN elsewhere. `grown`: what its newest alarm of
    friction is of by what is known today, empty where that is not known. `together`: by now all axes have moved
    together, as in the cold. `overnight`: viscous friction alone rose from one day to the next and has kept, or
    Coulomb friction fell with it. `scaled`: both kinds rose by the same share at once; `repaired`: Coulomb friction
    fell at once after its alarm while viscous friction rose. `part`: what to ask first where its newest episode soon
    followed a part, see :mod:`.with_part`, else empty. `now`: end of the newest window [s].
    """

    axis: int
    joint: str
    level: str
    growth: float
    growth_std: float
    limit: float
    limited: LimitDate | None
    episodes: tuple[Episode, ...]
    past: tuple[Episode, ...]
    estimates: Mapping[str, float] = field(default_factory=dict)
    viscous: float = math.nan
    viscous_std: float = math.nan
    seen: bool = True
    loud: bool = False
    turned: float = math.inf
    anew: Event | None = None
    event: Event | None = None
    until: float = math.nan
    grown: str = ""
    together: bool = False
    overnight: bool = False
    scaled: bool = False
    repaired: bool = False
    part: str = ""
    now: float = math.nan

    @property
    def closed(self) -> bool:
        """Whether an event closed what the axis had grown by, and nothing has been judged since."""
        return self.event is not None and self.event.mends and not self.episodes

    @property
    def quantity(self) -> str:
        """The quantity to act on, empty without one: of the newest alarm, which keeps the name that it was told under,
        by what is known today."""
        told = "" if self.main is None else self.main.quantity
        return self.grown or told if told in (COULOMB, VISCOUS) else told

    @property
    def change(self) -> float | None:
        """What the quantity to act on has changed by: now where an estimate shows it, else at its newest alarm; None
        where that was told under another name."""
        now = self.estimates.get(self.quantity, math.nan)
        if math.isfinite(now):
            return now
        return self.main.newest["change"] if self.main and self.quantity == self.main.quantity else None

    @property
    def unit(self) -> str:
        """The unit of :attr:`change`, empty without one."""
        if self.change is None:
            return ""
        return self.main.newest["unit"] if self.quantity == self.main.quantity else VISCOUS_UNIT

    @property
    def main(self) -> Episode | None:
        """The episode to act on, the newest one."""
        return max(self.episodes, key=lambda e: e.last, default=None)

    @property
    def check(self) -> str:
        """What to check, one line; empty where nothing calls for it."""
        if self.main is None:
            return "its alarm was closed under 'events'; keep watching it" if self.level == CHANGED else ""
        if self.turned <= self.main.last:
            return "first settle from which zero the joints count, as told below: another zero looks like friction"
        if self.level != CHANGED:
            what = "play" if self.quantity == BACKLASH else "friction"
            state = f"{what} is back to normal" if self.seen else f"{what} can no longer be judged"
            return f"{state}, and nobody has said why: enter what was done under 'events', or look for it on the robot"
        told = CONTRADICTED if self.contradicted else advice(self.quantity, self.main.newest["change"], self.greased)
        if self.small and not self.greased:
            told = at_next_service(told)
        first = REPAIRED if self.repaired else SCALED if self.scaled else self.part or (UNSURE if self.unsure else "")
        told = first + told
        if self.probability is not None and self.probability < EVEN_ODDS:
            return f"compare the other axes before opening anything, as it may well be another; then {told}"
        return told

    @property
    def probability(self) -> float | None:
        """How likely it is that this is the axis, by the newest alarm to act on; None where none says so."""
        value = self.main.newest.get("probability_axis") if self.main else None
        return value if value is not None and math.isfinite(value) else None

    @property
    def viscous_alarm(self) -> bool:
        """Whether an unresolved alarm is of viscous friction."""
        return self.quantity == VISCOUS or any(e.quantity == VISCOUS for e in self.episodes)

    @property
    def viscous_told(self) -> bool:
        """Whether growth of viscous friction is told: it has alarmed, or has clearly passed the limit beside another
        alarm while the axes do not all move together, in which it could not alarm either."""
        beyond = self.viscous >= max(self.limit, MORE_THAN_CHANCE * self.viscous_std)
        beside = self.level == CHANGED and not self.together and beyond
        return self.viscous_alarm or bool(beside)

    @property
    def greased(self) -> str:
        """What an alarm of viscous friction has of new grease, a sentence; empty where it has nothing of it."""
        if self.overnight:
            return "It rose overnight and has kept since"
        return "Coulomb friction fell meanwhile" if self._fell and not self.contradicted else ""

    @property
    def _fell(self) -> bool:
        return self.growth < -max(MORE_THAN_CHANCE * self.growth_std, BELOW * self.limit)

    @property
    def contradicted(self) -> bool:
        """Whether a changed axis has Coulomb friction clearly below normal beside viscous friction that is over the
        limit, though Coulomb friction alarmed, or by more than can be measured: no friction does that."""
        far = self.viscous > MOST_TOLD or not self.viscous_alarm
        beyond = self.viscous >= max(self.limit, MORE_THAN_CHANCE * self.viscous_std)
        return self.level == CHANGED and self._fell and far and beyond

    @property
    def reached(self) -> bool:
        """Whether the growth that is told has reached the limit while the axis counts as changed; growth that an event
        has closed, or that is :attr:`contradicted`, counts no more, nor does viscous friction of an axis that was
        :attr:`repaired`."""
        viscous = self.viscous_told and self._at_limit(VISCOUS) and not self.contradicted and not self.repaired
        return self.level == CHANGED and not self.closed and (self._at_limit(COULOMB) or viscous)

    def _at_limit(self, kind: str) -> bool:
        """Whether growth of a kind of friction has reached the limit. Where its standard error is as large as the limit
        that cannot be told: the error of a normal state that is hardly known is a rough one."""
        grown, std = (self.viscous, self.viscous_std) if kind == VISCOUS else (self.growth, self.growth_std)
        return grown >= self.limit and not std >= self.limit

    @property
    def unsure(self) -> bool:
        """Whether the standard error of the growth that alarmed is as large as the limit."""
        kinds = {VISCOUS: self.viscous_std, COULOMB: self.growth_std}
        return kinds.get(self.quantity, 0.0) >= self.limit

    @property
    def small(self) -> bool:
        """Whether all growth that is told is small and far from its limit: no reason to open a gear by itself."""
        told = [self.growth, *([self.viscous] if self.viscous_told else [])]
        far = self.limited is not None and self.limited.low - self.now > SOON
        return far and self.quantity in (COULOMB, VISCOUS) and all(g < SMALL * self.limit for g in told)

    @property
    def over(self) -> str:
        """The friction of an axis without an alarm that has clearly grown over the limit, empty where none has.

        What alarms is the friction as a whole, or one kind of it alone: of an axis whose one kind grew while the other
        one fell neither may.
        """
        if self.level != HEALTHY:
            return ""
        kinds = ((VISCOUS, self.viscous, self.viscous_std), (COULOMB, self.growth, self.growth_std))
        return next((kind for kind, grown, std in kinds if grown >= max(self.limit, MORE_THAN_CHANCE * std)), "")

    @property
    def rising(self) -> bool:
        """Whether Coulomb friction of an axis without an alarm has clearly grown by a good part of the limit. Alarms
        wait for more, as they have to be right for every axis at every hour; viscous friction may, as grease and the
        cold raise it."""
        grown = self.growth >= max(RISING * self.limit, SURELY * self.growth_std)
        return self.level == HEALTHY and not self.over and bool(grown)


def axis_conditions(state: RobotState) -> list[AxisCondition]:
    """Return the condition of every axis."""
    events = events_of(state.entry)
    found = episodes_of(state.counted, events, state.length)
    return [_condition(state, j, found, events) for j in range(state.axes)]


def robot_episodes(state: RobotState) -> list[Episode]:
    """Return the episodes that concern the robot as a whole."""
    return [e for e in episodes_of(state.counted, events_of(state.entry), state.length) if e.axis is None]


def _condition(state: RobotState, j: int, found: list[Episode], events: Sequence[Event]) -> AxisCondition:
    own = [e for e in found if e.axis == j + 1]
    begin, until = _last_judged(state, j)
    told = [e for e in events if e.concerns(j) and state.start[0] < e.time]
    mending = [e for e in told if e.mends and e.time <= begin]
    event = told[-1] if told and told[-1].time > begin and math.isfinite(until) else None
    open_ones = tuple(e for e in own if e.resolved is None)
    judged = np.flatnonzero(state.status[:, j] != UNJUDGED)
    after = judged[state.after[judged]]
    level = str(state.status[after[-1], j]) if len(after) else UNJUDGED
    loud = any(j + 1 in f["axes"] and "end" not in f for f in _unanswered(state, LOUD))
    if level == HEALTHY and (loud or _long_unseen(state, j, int(judged[-1]))):
        level = UNJUDGED
    if level == CHANGED and state.back[j] and open_ones:
        level = UNRESOLVED
    if level == CHANGED and not open_ones and _mended(own):
        level = UNJUDGED
    if level != CHANGED and open_ones:
        level = UNRESOLVED
    growth, std = latest(state, "coulomb_percent", j)
    viscous, viscous_std = latest(state, "viscous_percent", j)
    found_now = AxisCondition(
        axis=j + 1,
        joint=state.joints[j],
        level=level,
        growth=growth,
        growth_std=std,
        limit=float(state.entry.get("limits", {}).get("coulomb_increase_percent", DEFAULT_LIMIT)),
        limited=state.limits[j] if level == CHANGED and (open_ones or not event) else None,
        episodes=open_ones,
        past=tuple(e for e in own if e.resolved is not None),
        estimates={quantity: latest(state, name, j)[0] for quantity, name in SHOWN_BY.items()},
        viscous=viscous,
        viscous_std=viscous_std,
        seen=len(after) > 0,
        loud=loud,
        turned=min((f["time"] for f in _unanswered(state, ZERO)), default=math.inf),
        anew=mending[-1] if mending else None,
        event=event,
        until=until if event else math.nan,
        grown=state.grown[j],
        together=any(f["kind"] == SHARED and "end" not in f for f in state.findings),
        overnight=_as_told(_viscous_overnight, VISCOUS, state, j, open_ones) and not growth > MORE_THAN_CHANCE * std,
        scaled=_as_told(rose_alike, COULOMB, state, j, open_ones),
        repaired=_as_told(greased_since, COULOMB, state, j, open_ones),
        part=asked_of_part(state, j, open_ones, events),
        now=float(state.end[-1]),
    )
    # One step has no rate of growth, and what was done to the axis is another than what was followed until then.
    dateless = found_now.contradicted or found_now.scaled or found_now.repaired
    return replace(found_now, limited=None) if dateless else found_now


def _as_told(
    told: Callable[[np.ndarray, np.ndarray, np.ndarray, float], bool],
    quantity: str,
    state: RobotState,
    j: int,
    episodes: Sequence[Episode],
) -> bool:
    """Whether what Coulomb and viscous friction of a 0-based axis did is as `told` of an alarm of a quantity."""
    named = {e.quantity for e in episodes} | {state.grown[j]}
    if quantity not in named or not {"coulomb_percent", "viscous_percent"} <= set(state.estimates):
        return False
    after = state.after
    kinds = [state.estimates[name][0][after, j] for name in ("coulomb_percent", "viscous_percent")]
    # Its first alarm may have been told under the other name.
    return any(told(state.end[after], *kinds, e.first) for e in episodes if e.quantity in (COULOMB, VISCOUS))


def _viscous_overnight(end: np.ndarray, coulomb: np.ndarray, viscous: np.ndarray, alarm: float) -> bool:
    return rose_overnight(end, viscous, alarm, coulomb)


def _last_judged(state: RobotState, j: int) -> tuple[float, float]:
    """Return begin and end [s] of the window in which a 0-based axis was judged last; NaN where it never was. While it
    is learnt anew it is not judged, whatever alarm stays open."""
    judged = np.flatnonzero((state.status[:, j] != UNJUDGED) & (state.reason[:, j] != Reason.LEARNING))
    judged = judged[state.after[judged]]
    return (float(state.start[judged[-1]]), float(state.end[judged[-1]])) if len(judged) else (math.nan, math.nan)


def _mended(resolved: list[Episode]) -> bool:
    """Whether the newest event that closed alarms of an axis did something to it, so that its growth until then tells
    nothing of it now; somebody who looked at an alarm has changed nothing, nor has another program."""
    events = [e.resolved for e in resolved if e.resolved is not None and e.resolved.mends]
    return bool(events) and max(events, key=lambda e: e.time).kind != "acknowledged"


def _unanswered(state: RobotState, kind: str) -> list[Mapping[str, Any]]:
    """Return the findings of a kind that no event of the config has answered."""
    return [f for f in state.findings if f["kind"] == kind and not f.get("answered")]


def _long_unseen(state: RobotState, j: int, last: int) -> bool:
    """Whether a 0-based axis has gone on unjudged since its `last` judged window for longer than it ever paused."""
    told = (state.status[:, j] != UNJUDGED) | np.isin(state.reason[:, j], WAITS)
    pauses = np.diff(state.end[: last + 1][told[: last + 1]])
    since = float(state.end[-1] - state.end[last])
    return since > max(UNSEEN, PAUSES * float(pauses.max(initial=0.0)))


def latest(state: RobotState, name: str, j: int) -> tuple[float, float]:
    """Return an estimate of a 0-based axis over the windows of now, weighted, and its standard deviation.

    That of the judgement, where it tells: windows share a part of their error.
    """
    if name not in state.estimates:
        return math.nan, math.nan
    values, std, _ = state.estimates[name]
    value = mean_now(values[:, j], std[:, j], state.end)
    if not math.isfinite(value):
        return math.nan, math.nan
    told = float(state.now_error[name][j]) if name in state.now_error else math.nan
    if not math.isfinite(told):
        error = std[now_windows(state.end), j]
        told = float(1 / np.sqrt(np.sum(1 / error[error > 0] ** 2)))
    return value, told


def urgency(conditions: list[AxisCondition]) -> list[AxisCondition]:
    """Return the axes that need attention, the most urgent first: limit reached, soonest limit, largest growth."""

    def order(c: AxisCondition) -> tuple[Any, ...]:
        rank = 0 if c.reached else 1 if c.level == CHANGED else 2
        median, low = (c.limited.median, c.limited.low) if c.limited else (math.inf, math.inf)
        return rank, median, low, -c.growth if math.isfinite(c.growth) else 0.0, c.axis

    return sorted((c for c in conditions if c.level in (CHANGED, UNRESOLVED)), key=order)


__all__ = [
    "CHANGED", "FEWEST_NOW", "HEALTHY", "MOST_TOLD", "REACHED", "UNJUDGED", "UNRESOLVED", "AxisCondition",
    "axis_conditions", "latest", "robot_episodes", "urgency",
]  # fmt: skip
