"""The arm under its controller, many windows at once: what the motors deliver and where the axes are.

A controller follows the program with proportional and derivative gains and feeds forward the torque of a model of its
own: bodies a few percent off, part of the nominal friction, no thermal behaviour. Away from the program by x (n axes),

    J x'' + D x' + K x = feedforward - bodies(program) - friction(v + x'),  torque = feedforward - D x' - K x,

one equation per axis with the mean inertia J of the job, integrated in steps of :data:`~.programs.STEP`, the loop and
the slope of the friction implicitly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.studies.shop_floor.arms import ArmType
from jointwear.studies.shop_floor.gear import TURN, Gear
from jointwear.studies.shop_floor.programs import STEP, Job

#: Logged samples per second, steps of the loop between two of them, seconds of a window, and of settling before it.
RATE, DECIMATION, SECONDS, SETTLING = 50.0, 4, 30.0, 0.6
SAMPLES = round(RATE * SECONDS)
#: Damping of the loop; share of the nominal friction that is fed forward; error of the bodies fed forward.
DAMPING, FED_FRICTION, FED_ERROR = 0.8, 0.6, 0.05


@dataclass(frozen=True)
class Controller:
    """Gains relative to inertia, `stiffness` [1/s2] and `damping` [1/s], and the model fed forward; each (n,).

    `gravity`, `dynamic` : factors on the true torques. `coulomb` [N m], `viscous` [N m s/rad] fed forward.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    gravity: np.ndarray
    dynamic: np.ndarray
    coulomb: np.ndarray
    viscous: np.ndarray


def draw_controller(arm: ArmType, random: np.random.Generator) -> Controller:
    """Draw the controller of one arm."""
    n = len(arm.home)
    pace = 2 * np.pi * np.array(arm.bandwidth)
    return Controller(
        stiffness=pace**2,
        damping=2 * DAMPING * pace,
        gravity=1 + FED_ERROR * random.standard_normal(n),
        dynamic=1 + FED_ERROR * random.standard_normal(n),
        coulomb=FED_FRICTION * np.array(arm.coulomb),
        viscous=FED_FRICTION * np.array(arm.viscous),
    )


@dataclass(frozen=True)
class Runs:
    """What differs from window to window.

    `phase` (w,) [s] of the program at the first sample, `override` (w,), `temperature` (w, n) of the oil [degC],
    `coulomb`, `viscous` (w, n) factors on the friction (wear, grease, running-in).
    """

    phase: np.ndarray
    override: np.ndarray
    temperature: np.ndarray
    coulomb: np.ndarray
    viscous: np.ndarray

    def part(self, chosen: slice) -> Runs:
        """Return some of the windows."""
        return Runs(*(getattr(self, name)[chosen] for name in self.__dataclass_fields__))


@dataclass(frozen=True)
class Driven:
    """Windows (w, SAMPLES, n): deviation from the program [rad], its rate [rad/s], torque of the motors [N m]."""

    deviation: np.ndarray
    rate: np.ndarray
    torque: np.ndarray

    def part(self, chosen: np.ndarray) -> Driven:
        """Return some of the windows."""
        return Driven(self.deviation[chosen], self.rate[chosen], self.torque[chosen])


def at_phase(table: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Interpolate a periodic table (m, ...) at phases [s] of any shape."""
    place = phase / STEP
    low = np.floor(place).astype(np.int64)
    share = (place - low).reshape(*np.shape(phase), *[1] * (table.ndim - 1))
    low %= len(table)
    first = table[low]
    low += 1
    low[low == len(table)] = 0
    found = table[low]
    found -= first
    found *= share
    found += first
    return found


class _Tables:
    """Speed and both torques of the bodies along several jobs, looked up window by window."""

    def __init__(self, jobs: Sequence[Job], which: np.ndarray) -> None:
        # One row more than a cycle, so that the row after the last is there.
        rows = [np.concatenate([j.program.velocity[:, None], j.true], axis=1) for j in jobs]
        self._table = np.concatenate([np.concatenate([r, r[:1]]) for r in rows]).astype(np.float32)
        lengths = np.array([len(r) for r in rows])
        self._offset = np.concatenate([[0], np.cumsum(lengths + 1)[:-1]])[which]
        self._length = lengths[which]

    def __call__(self, phase: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return speed at full override, gravity and dynamic torque (w, n) at phases (w,) [s]."""
        place = phase / STEP
        low = np.floor(place)
        share = (place - low).astype(np.float32)[:, None, None]
        index = low.astype(np.int64) % self._length + self._offset
        first = self._table[index]
        found = self._table[index + 1]
        found -= first
        found *= share
        found += first
        return found[:, 0], found[:, 1], found[:, 2]


def drive(jobs: Sequence[Job], which: np.ndarray, gear: Gear, controller: Controller, runs: Runs) -> Driven:
    """Integrate the loop over all windows; `which` (w,) is the job of each."""
    single = np.float32
    w, n = runs.temperature.shape
    look = _Tables(jobs, which)
    inertia = np.stack([j.inertia for j in jobs])[which].astype(single)
    inverse = 1 / inertia
    pace, d = controller.stiffness.astype(single), controller.damping.astype(single)
    stiff, damp = pace * inertia, d * inertia
    thin = gear.viscosity(runs.temperature)
    level = (gear.level(runs.temperature) * runs.coulomb * gear.coulomb.mean(axis=1)).astype(single)
    uneven = ((gear.coulomb[:, 0] - gear.coulomb[:, 1]) / gear.coulomb.sum(axis=1)).astype(single)
    film = (thin / gear.film_speed).astype(single)
    rub = (gear.viscous * thin * runs.viscous).astype(single)
    loaded, rise = (gear.load / gear.load_scale).astype(single), gear.rise.astype(single)
    slow = (1 / gear.thin_speed).astype(single)
    override = runs.override[:, None].astype(single)
    s2 = override**2
    fed = [getattr(controller, k).astype(single) for k in ("gravity", "dynamic", "coulomb", "viscous")]
    turn = single(TURN * TURN)
    step_size = single(STEP)
    fixed = 1 + step_size * d + step_size**2 * pace
    settling = round(SETTLING / STEP)
    x, rate = np.zeros((w, n), single), np.zeros((w, n), single)
    out = [np.empty((SAMPLES, w, n), dtype=single) for _ in range(3)]
    begin = runs.phase - settling * STEP * runs.override
    for step in range(settling + (SAMPLES - 1) * DECIMATION + 1):
        v, gravity, dynamic = look(begin + step * STEP * runs.override)
        v = v * override
        dynamic = dynamic * s2
        bodies = gravity + dynamic
        feed = fed[0] * gravity + fed[1] * dynamic + fed[3] * v + fed[2] * (v / np.sqrt(v * v + turn))
        speed = v + rate
        fast = np.sqrt(speed * speed + turn)
        sign = speed / fast
        boundary = level * (1 + loaded * np.abs(bodies)) * (1 + rise / (1 + film * fast))
        rubbing = rub / (1 + fast * slow)
        square = sign * sign
        friction = boundary * (sign + uneven * square) + rubbing * speed
        torque = feed - damp * rate - stiff * x
        if step == 0:
            x = (feed - bodies - friction) / stiff
            continue
        if step >= settling and (step - settling) % DECIMATION == 0:
            sample = (step - settling) // DECIMATION
            out[0][sample], out[1][sample], out[2][sample] = x, rate, torque
        # The loop and the slopes of the friction (of its change of sign, of rubbing) act at the end of the step.
        slope = boundary * (1 - square) / fast + rubbing
        force = (torque - bodies - friction) * inverse - step_size * pace * rate
        rate = rate + step_size * force / (fixed + step_size * inverse * slope)
        x = x + step_size * rate
    return Driven(*(x.transpose(1, 0, 2) for x in out))
