"""One robot of the fleet with its month: everything that is drawn, from the seed set and the robot's index alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.statistics.randomness import generator
from jointwear.studies.shop_floor.arms import HEAVY, LIGHT, ArmType, robot_data
from jointwear.studies.shop_floor.closed_loop import SAMPLES, Controller, draw_controller
from jointwear.studies.shop_floor.confounders import THERMOMETERS, present, scenario_of
from jointwear.studies.shop_floor.gear import NEW_GAP, Gear, Wear, draw_gear, draw_wear
from jointwear.studies.shop_floor.heat import Body, draw_body, warm
from jointwear.studies.shop_floor.month import (
    BASELINE_DAYS,
    DAY,
    DAYS,
    HOURS,
    ONSET_DAYS,
    WORN_SHARE,
    Month,
    draw_month,
)
from jointwear.studies.shop_floor.programs import Jobs, draw_program

#: Roots of the random numbers: settings are chosen on one set, figures are reported on the other.
SEEDS = {"choose": 70_411, "report": 90_823}
PROGRAMS = 3


@dataclass(frozen=True)
class Event:
    """What somebody did: `kind` service or sensor, at `hour`, to 0-based `axes`; `told` in the config or not.

    `coulomb`, `viscous`, `gain` : factors from then on.
    """

    kind: str
    hour: float
    axes: tuple[int, ...]
    told: bool
    coulomb: float = 1.0
    viscous: float = 1.0
    gain: float = 1.0


@dataclass(frozen=True)
class Cell:
    """One robot and its month. `built` : content of the robot file of the arm as it is; `minute` of each hour at which
    the logger starts [s]; `power` (HOURS, n); `oil`, `housing` (HOURS, n) [degC]; `logged` (w,) the hours with a
    window; `samples` (w,) logged in each; `still` (w,) the arm rests; `missing` (w,) axis without a torque or -1."""

    name: str
    scenario: str
    arm: ArmType
    built: dict[str, Any]
    gear: Gear
    controller: Controller
    body: Body
    jobs: Jobs
    month: Month
    thermometer: str
    wear: Wear | None
    events: tuple[Event, ...]
    running_in: tuple[np.ndarray, np.ndarray]
    oil: np.ndarray
    housing: np.ndarray
    logged: np.ndarray
    samples: np.ndarray
    still: np.ndarray
    missing: np.ndarray
    seed: tuple[int, int]

    def factors(self, hour: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the factors (w, n) on boundary friction, on viscous friction, and on the scale of the torque."""
        n = len(self.arm.home)
        coulomb, viscous, gain = (np.ones((len(hour), n)) for _ in range(3))
        for event in self.events:
            rows, axes = np.flatnonzero(hour >= event.hour), list(event.axes)
            for factor, value in ((coulomb, event.coulomb), (viscous, event.viscous), (gain, event.gain)):
                factor[np.ix_(rows, axes)] *= value
        size, pace = self.running_in
        fresh = 1 + size * np.exp(-hour[:, None] / pace)
        coulomb, viscous = coulomb * fresh, viscous * fresh
        if self.wear is not None and self.wear.kind != "backlash":
            grown = coulomb if self.wear.kind == "coulomb" else viscous
            grown[:, self.wear.axis] *= 1 + self.wear.growth(hour)
        return coulomb, viscous, gain

    def gaps(self, hour: np.ndarray) -> np.ndarray | None:
        """Return the lost motion (w, n) [rad]; None where the gears of this robot have none."""
        if self.wear is None or self.wear.kind != "backlash":
            return None
        gap = np.full((len(hour), len(self.arm.home)), NEW_GAP)
        gap[:, self.wear.axis] += self.wear.growth(hour)
        return gap

    def random(self, *key: str | int) -> np.random.Generator:
        """Return random numbers of this robot by the name of their use."""
        return generator(self.seed[0], "shop_floor", *key, replicate=self.seed[1])


def draw_cell(seed_set: str, index: int, scenario: str | None = None) -> Cell:
    """Draw one robot of a seed set of :data:`SEEDS`; `scenario` in place of the one that its turn gives it."""
    seed = (SEEDS[seed_set], index)

    def random(*key: str) -> np.random.Generator:
        return generator(seed[0], "shop_floor", *key, replicate=index)

    scenario = scenario or scenario_of(index)
    with_ = present(scenario)
    arm = (LIGHT, HEAVY)[int(random("type").integers(2))]
    n = len(arm.home)
    draw = random("arm")
    built, gear = robot_data(arm, draw), draw_gear(arm, draw)
    controller, body = draw_controller(arm, draw), draw_body(n, draw)
    draw = random("programs")
    programs = [draw_program(arm, draw) for _ in range(PROGRAMS)]
    month = draw_month(with_, PROGRAMS, arm.payloads, random("month"))
    draw = random("fate")
    wear = None
    onset = (ONSET_DAYS[0] * DAY, ONSET_DAYS[1] * DAY)
    if draw.random() < WORN_SHARE:
        wear = draw_wear(n, onset, draw)
    events = _events(with_, wear, n, random("events"))
    draw = random("running in")
    size, pace = np.zeros(n), np.ones(n)
    if "running_in" in with_:
        fresh = draw.choice(n, int(draw.integers(1, 4)), replace=False)
        size[fresh], pace[fresh] = draw.uniform(0.05, 0.15, len(fresh)), draw.uniform(4, 10, len(fresh)) * DAY
    power = _power(arm, programs, month)
    oil, housing = warm(body, gear, power, month.room)
    names = list(THERMOMETERS)
    thermometer = str(random("thermometer").choice(names, p=[THERMOMETERS[k] for k in names]))
    return Cell(
        name=f"{seed_set}_{index:03d}",
        scenario=scenario,
        arm=arm,
        built=built,
        gear=gear,
        controller=controller,
        body=body,
        jobs=Jobs(arm, programs, built),
        month=month,
        thermometer=thermometer,
        wear=wear,
        events=events,
        running_in=(size, pace),
        oil=oil,
        housing=housing,
        **_logged(with_, month, n, random("logger")),
        seed=seed,
    )


def _power(arm: ArmType, programs: list, month: Month) -> np.ndarray:
    """Return the friction power (HOURS, n) over that of the first program at full speed."""
    coulomb, viscous = np.array(arm.coulomb), np.array(arm.viscous)

    def of(program: int, s: float) -> np.ndarray:
        v = s * np.abs(programs[program].velocity)
        return (coulomb * v + viscous * v * v).mean(axis=0)

    usual = np.maximum(np.mean([of(k, 1.0) for k in range(len(programs))], axis=0), 1e-9)
    known = {key: of(*key) / usual for key in set(zip(month.program.tolist(), month.override.tolist(), strict=True))}
    rows = [known[key] for key in zip(month.program.tolist(), month.override.tolist(), strict=True)]
    return np.array(rows) * month.running[:, None]


def _events(with_: frozenset[str], wear: Wear | None, n: int, random: np.random.Generator) -> tuple[Event, ...]:
    """Grease and steps of the torque's scale; neither touches an axis that has begun to wear."""
    events = []

    def axes_at(hour: float, count: int) -> tuple[int, ...]:
        free = [j for j in range(n) if wear is None or j != wear.axis or hour < wear.onset]
        return tuple(sorted(int(j) for j in random.choice(free, min(count, len(free)), replace=False)))

    if "service" in with_:
        hour = float(random.uniform(BASELINE_DAYS + 1, DAYS - 3)) * DAY
        axes = axes_at(hour, int(random.integers(1, 4)))
        coulomb, viscous = float(random.uniform(0.82, 0.95)), float(random.uniform(0.75, 1.1))
        events.append(Event("service", hour, axes, bool(random.random() < 0.5), coulomb=coulomb, viscous=viscous))
    if "sensor_gain" in with_:
        hour = float(random.uniform(BASELINE_DAYS + 1, DAYS - 3)) * DAY
        axes = axes_at(hour, 1 if random.random() < 0.6 else n)
        gain = float(1 + random.choice([-1, 1]) * random.uniform(0.03, 0.09))
        events.append(Event("sensor", hour, axes, bool(random.random() < 0.5), gain=gain))
    return tuple(events)


def _logged(with_: frozenset[str], month: Month, n: int, random: np.random.Generator) -> dict[str, np.ndarray]:
    """Return the hours that are logged, samples in each, whether the arm rests, and the axis without a torque."""
    kept = month.running.copy()
    messy = "messy" in with_
    if messy:
        kept &= random.random(HOURS) > 0.07
        for _ in range(int(random.integers(1, 4))):
            start = int(random.integers(HOURS))
            kept[start : start + int(random.integers(6, 40))] = False
    logged = np.flatnonzero(kept)
    w = len(logged)
    samples, still, missing = np.full(w, SAMPLES), np.zeros(w, dtype=bool), np.full(w, -1)
    if messy:
        short = random.random(w) < 0.06
        samples[short] = random.integers(150, SAMPLES, int(short.sum()))
        still = random.random(w) < 0.03
        lost = random.random(w) < 0.02
        missing[lost] = random.integers(n, size=int(lost.sum()))
    return {"logged": logged, "samples": samples, "still": still, "missing": missing}
