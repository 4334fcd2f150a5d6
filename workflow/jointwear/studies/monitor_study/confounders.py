"""Factory conditions that change friction or torque more than wear does, and what the corrected model makes of them.

A made-up arm, a few percent off its nominal model, repeats a motion; 24 s of every hour are logged. After 120 quiet
hours at constant temperature and full speed come conditions that this normal period did not show. The log holds the
temperature of the joints and the motion; it does not tell the load.

`temperature` : day and night, a heat wave and a warm-up every shift; the viscous friction of all axes falls as an
    oil's does (Vogel's law, not the library's exponential).
`payload` : a heavier tool from hour 120 on. `speed` : shifts at 100, 75 and 50 % override, and friction that rises at
    low speed on the three main axes (a Gaussian Stribeck curve that the nominal model lacks).
`all` : everything at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from jointwear.monitor.normal.estimate import Sums
from jointwear.monitor.reading.model import TorqueModel
from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Link, Robot
from jointwear.robots.trajectory import Motion, Task
from jointwear.statistics.randomness import generator
from jointwear.studies.monitor_study.nominal import coulomb_levels_of, wrong_nominal
from jointwear.studies.monitor_study.runs import DEAD_BAND, Regression, sums_of_torque

SCENARIOS = ("temperature", "payload", "speed", "all")
#: Hours of the normal period, of the week that is given to discovery, and of the weeks that are judged.
NORMAL, LEARNT, JUDGED = 120, 168, 336
SAMPLES, RATE_HZ = 240, 10.0
#: Noise over the root mean square of the torque; how far the arm is off its nominal model.
NOISE, INERTIAL, FRICTION = 0.01, 0.03, 0.05
WEAR_HOURS, WEAR_PERCENT, WEAR_SHAPE = 120, 20.0, 1.5
_WEAR = Wear(WEAR_PERCENT, WEAR_SHAPE, WEAR_HOURS)
TOOL = Link(0.8, np.array([0.0, 0.02, 0.12]), np.zeros((3, 3)))
TASK = Task(
    "factory",
    np.radians(
        [
            [-70, 60, -150, -30, -40, -60],
            [10, 110, -60, 60, 50, 40],
            [60, 20, -100, -50, 20, 120],
            [-20, 140, 10, 90, -60, -100],
        ]
    ),
    np.array([2.2, 3.8, 2.6, 3.4]),
)


@dataclass(frozen=True)
class Conditions:
    """What every hour is like: `temperature` (h,) [degC], `speed` (h,) share of full speed, `tool` (h,) bool."""

    temperature: np.ndarray
    speed: np.ndarray
    tool: np.ndarray

    def part(self, chosen: slice) -> Conditions:
        """Return some of the hours."""
        return Conditions(self.temperature[chosen], self.speed[chosen], self.tool[chosen])


def conditions(scenario: str | None) -> Conditions:
    """Return the conditions of a scenario of :data:`SCENARIOS`, or steady ones for None."""
    hours = NORMAL + LEARNT + JUDGED
    hour = np.arange(hours, dtype=float)
    after = hour >= NORMAL
    temperature, speed, tool = np.full(hours, 25.0), np.ones(hours), np.zeros(hours, dtype=bool)
    if scenario in ("temperature", "all"):
        day = np.sin(2 * np.pi * (hour - 9) / 24)
        on = np.mod(hour - 6, 24)
        # Two shifts from 6 to 22 h, then the drives cool down.
        warm = np.where(on < 16, 1 - np.exp(-on / 1.5), np.exp(-(on - 16) / 3.0))
        temperature = 30 + 0.5 * day
        wave = 3.0 * np.sin(2 * np.pi * (hour - NORMAL) / 290)
        temperature = np.where(after, 24 + 4.0 * day + 10.0 * warm + wave, temperature)
    if scenario in ("speed", "all"):
        shift = (hour // 8).astype(int)
        speed = np.where(after, np.array([1.0, 0.75, 0.5, 0.75, 1.0])[shift % 5], 1.0)
    if scenario in ("payload", "all"):
        tool = after
    return Conditions(temperature, speed, tool)


def motion_at(speed: float) -> Motion:
    """Return the motion of an hour at a share of full speed."""
    time = np.arange(SAMPLES) / RATE_HZ
    m = TASK.motion(time * speed)
    return Motion(time, m.position, m.velocity * speed, m.acceleration * speed**2)


class Factory:
    """Logs of one arm under some conditions.

    Parameters
    ----------
    robot : the nominal model. scenario : one of :data:`SCENARIOS` or None. seed : of the whole workflow.
    """

    def __init__(self, robot: Robot, scenario: str | None, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self.real = wrong_nominal(robot, generator(seed, "monitor", "arm", replicate=0), INERTIAL, FRICTION)
        self.conditions = conditions(scenario)
        self.levels = np.unique(self.conditions.speed)
        self._loaded = replace(self.real, payload=_heavier(self.real.payload))
        dynamics = {False: Dynamics(self.real), True: Dynamics(self._loaded)}
        self._rigid = {
            (level, tool): arm.rigid_body_torque(m.position, m.velocity, m.acceleration)
            for level, m in self._motions.items()
            for tool, arm in dynamics.items()
        }
        steady = self._rigid[1.0, False] + self._friction(self._motions[1.0].velocity, 25.0, None)
        self.noise = NOISE * np.sqrt(np.mean(steady**2, axis=0))

    @property
    def _motions(self) -> dict[float, Motion]:
        return {float(level): motion_at(float(level)) for level in {*self.levels, 1.0}}

    def _friction(self, velocity: np.ndarray, temperature: float, growth: tuple[int, float] | None) -> np.ndarray:
        """Friction of the real arm (s, n) at a temperature [degC]; `growth`: 0-based axis and its growth."""
        real = self.real
        factor = np.ones(real.joints)
        if growth is not None:
            factor[growth[0]] += growth[1]
        coulomb = real.coulomb(velocity) * factor
        # Vogel: ln(viscosity) = B / (T + C), with the constants of a gear oil.
        viscous = real.viscous * np.exp(700.0 / (temperature + 105.0) - 700.0 / 130.0)
        torque = coulomb + viscous * velocity
        if self.scenario in ("speed", "all"):
            rise = 0.25 * (real.coulomb_positive - real.coulomb_negative) / 2 * np.exp(-((velocity / 0.15) ** 2))
            torque[:, :3] += (np.sign(velocity) * rise)[:, :3]
        return torque

    def torque(self, hours: slice, replicates: int, key: str, axis: int | None = None) -> np.ndarray:
        """Return measured torque (r, h, s, n) [N m] of some hours; a 0-based `axis` wears from their first on."""
        here = self.conditions.part(hours)
        growth = np.zeros(len(here.speed))
        if axis is not None:
            growth = _WEAR.growth(np.arange(1, len(growth) + 1))
        motions = self._motions
        clean = np.stack(
            [
                self._rigid[float(v), bool(tool)]
                + self._friction(motions[float(v)].velocity, t, None if axis is None else (axis, g))
                for t, v, tool, g in zip(here.temperature, here.speed, here.tool, growth, strict=True)
            ]
        )
        words = (self.scenario or "steady", key, -1 if axis is None else axis)
        result = np.empty((replicates, *clean.shape), dtype=np.float32)
        for r in range(replicates):
            random = generator(self.seed, "monitor", "factory", words[0], words[1], words[2] + 1, replicate=r)
            result[r] = clean + self.noise * random.standard_normal(clean.shape, dtype=np.float32)
        return result

    def measured_temperature(self, hours: slice) -> np.ndarray:
        """Return the logged temperature (h,) [degC], to a tenth of a kelvin."""
        return np.round(self.conditions.temperature[hours], 1)

    def model_torque(self, models: Mapping[bool, Robot], hours: slice) -> tuple[np.ndarray, dict[float, Regression]]:
        """Return the torque (h, s, n) of the monitor's model and its regression at every speed.

        Parameters
        ----------
        models : the robot without and with the tool.
        """
        here, known = self.conditions.part(hours), self.measured_temperature(hours)
        torque = np.empty((len(known), SAMPLES, self.real.joints))
        regressions = {}
        for tool, robot in models.items():
            model = TorqueModel(robot)
            for level, m in self._motions.items():
                chosen = np.flatnonzero((here.speed == level) & (here.tool == tool))
                if not len(chosen):
                    continue
                found = model(
                    *(np.tile(a, (len(chosen), 1)) for a in (m.position, m.velocity, m.acceleration)),
                    time=(3600.0 * chosen[:, None] + m.time).ravel(),
                    temperature=np.repeat(known[chosen], SAMPLES)[:, None] * np.ones(self.real.joints),
                )
                torque[chosen] = found.total.reshape(len(chosen), SAMPLES, -1)
                used = np.abs(m.velocity) > 10 * DEAD_BAND
                parts = (found.gravity[:SAMPLES], found.inertial[:SAMPLES])
                columns = np.stack(
                    [used & (m.velocity > 0), -1.0 * (used & (m.velocity < 0)), m.velocity * used,
                     *(p * used for p in parts)], axis=-1,
                ).astype(float)  # fmt: skip
                zero = np.zeros((SAMPLES, self.real.joints))
                regressions[level] = Regression(
                    zero, columns, used, coulomb_levels_of(models[False]), models[False].viscous
                )
        return torque, regressions

    def sums(self, residual: np.ndarray, regressions: Mapping[float, Regression], hours: slice) -> Sums:
        """Return the sums of windows from residual torque (r, h, s, n)."""
        speed = self.conditions.speed[hours]
        r, h, _, n = residual.shape
        gram, moment = np.empty((1, h, n, 5, 5)), np.empty((r, h, n, 5))
        left, freedom = np.empty((r, h, n)), np.empty((r, h, n))
        for level, regression in regressions.items():
            chosen = np.flatnonzero(speed == level)
            if not len(chosen):
                continue
            part = sums_of_torque(residual[:, chosen], regression)
            gram[:, chosen] = part.gram
            moment[:, chosen], left[:, chosen] = part.moment, part.residual_square
            freedom[:, chosen] = part.freedom
        return Sums(gram, moment, left, freedom, np.ones((r, h, n), dtype=bool))


def _heavier(payload: Link | None) -> Link:
    """Return the payload with the tool bolted on."""
    if payload is None:
        return TOOL
    mass = payload.mass + TOOL.mass
    com = (payload.mass * payload.com + TOOL.mass * TOOL.com) / mass

    def about(link: Link) -> np.ndarray:
        d = link.com - com
        return link.inertia + link.mass * (d @ d * np.eye(3) - np.outer(d, d))

    return Link(mass, com, about(payload) + about(TOOL))
