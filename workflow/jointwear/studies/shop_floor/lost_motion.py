"""The loop with lost motion in its gears: motor and link are two bodies, and between them lies a gap.

The motor is x, the link y away from the program (n axes each); the gear touches where x - y leaves the gap g,

    Jm x'' + D x' + K x = feedforward - Jm a - (1 - f) friction(v + x') - T,
    Jl y'' = T - (bodies - Jm a) - f friction(v + y'),
    T = k dead(x - y, g / 2) + c (x' - y') where the gear touches, else 0,

a the planned acceleration. The encoder sits on the motor. Integrated in steps of :data:`FINE`; the loop, the slope of
the friction and the damping of the gear act at the end of a step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jointwear.studies.shop_floor.arms import ArmType
from jointwear.studies.shop_floor.closed_loop import (
    DECIMATION,
    SAMPLES,
    SETTLING,
    Controller,
    Driven,
    Runs,
    at_phase,
)
from jointwear.studies.shop_floor.gear import TURN, Gear
from jointwear.studies.shop_floor.programs import STEP, Job

#: Step [s]; share of the friction on the link's side; resonance [Hz] of the link on the gear, and its damping.
FINE, LINK_FRICTION, RESONANCE, GEAR_DAMPING = 0.001, 0.3, 18.0, 0.1


def drive_with_gaps(
    jobs: Sequence[Job],
    which: np.ndarray,
    arm: ArmType,
    gear: Gear,
    controller: Controller,
    runs: Runs,
    gap: np.ndarray,
) -> Driven:
    """Integrate the loop of motors and links over all windows; `which` (w,) is the job of each, `gap` (w, n) [rad]."""
    w, n = runs.temperature.shape
    inertia = np.stack([j.inertia for j in jobs])[which]
    motor = np.minimum(np.array(arm.armature), 0.8 * inertia)
    link = inertia - motor
    stiff, damp = controller.stiffness * inertia, controller.damping * inertia
    spring = link * (2 * np.pi * RESONANCE) ** 2
    loss = 2 * GEAR_DAMPING * link * 2 * np.pi * RESONANCE
    thin = gear.viscosity(runs.temperature)
    level = gear.level(runs.temperature) * runs.coulomb * gear.coulomb.mean(axis=1)
    uneven = (gear.coulomb[:, 0] - gear.coulomb[:, 1]) / gear.coulomb.sum(axis=1)
    film, rub = thin / gear.film_speed, gear.viscous * thin * runs.viscous
    loaded = gear.load / gear.load_scale
    override = runs.override[:, None]
    half = gap / 2
    tables = [np.stack([j.program.velocity, j.true[:, 0], j.true[:, 1], j.program.acceleration], axis=1) for j in jobs]

    def look(phase: np.ndarray) -> list[np.ndarray]:
        found = np.empty((w, 4, n))
        for k, table in enumerate(tables):
            rows = which == k
            found[rows] = at_phase(table, phase[rows])
        return [found[:, 0] * override, found[:, 1], found[:, 2] * override**2, found[:, 3] * override**2]

    def rubbed(speed: np.ndarray, bodies: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Friction [N m] and its slope over the speed."""
        fast = np.sqrt(speed * speed + TURN * TURN)
        sign = speed / fast
        boundary = level * (1 + loaded * np.abs(bodies)) * (1 + gear.rise / (1 + film * fast))
        rubbing = rub / (1 + fast / gear.thin_speed)
        return boundary * (sign + uneven * sign * sign) + rubbing * speed, boundary * (1 - sign * sign) / fast + rubbing

    settling, fine = round(SETTLING / STEP), round(STEP / FINE)
    out = [np.empty((SAMPLES, w, n)) for _ in range(3)]
    begin = runs.phase - settling * STEP * runs.override
    x = y = rate = pace = None
    for step in range(settling + (SAMPLES - 1) * DECIMATION + 1):
        v, gravity, dynamic, planned = look(begin + step * STEP * runs.override)
        bodies = gravity + dynamic
        feed = controller.gravity * gravity + controller.dynamic * dynamic + controller.viscous * v
        feed = feed + controller.coulomb * v / np.sqrt(v * v + TURN * TURN)
        own = motor * planned
        if x is None:
            # At rest in the loop, with the gear touching on the side that carries the bodies.
            friction = rubbed(v, bodies)[0]
            carried = bodies - own + LINK_FRICTION * friction
            x = (feed - bodies - friction) / stiff
            y = x - half * np.sign(carried) - carried / spring
            rate, pace = np.zeros((w, n)), np.zeros((w, n))
        for part in range(fine):
            friction, slope = rubbed(v + rate, bodies)
            friction_link, slope_link = rubbed(v + pace, bodies)
            twist = x - y
            pressed = np.sign(twist) * np.maximum(np.abs(twist) - half, 0.0)
            touching = pressed != 0
            carried = spring * pressed + np.where(touching, loss, 0.0) * (rate - pace)
            torque = feed - damp * rate - stiff * x
            if part == 0 and step >= settling and (step - settling) % DECIMATION == 0:
                sample = (step - settling) // DECIMATION
                out[0][sample], out[1][sample], out[2][sample] = x, rate, torque
            pull = torque - own - (1 - LINK_FRICTION) * friction - carried - FINE * stiff * rate
            inner = damp + FINE * stiff + (1 - LINK_FRICTION) * slope
            rate = rate + FINE * pull / (motor + FINE * inner)
            pull = carried - (bodies - own) - LINK_FRICTION * friction_link
            pace = pace + FINE * pull / (link + FINE * LINK_FRICTION * slope_link)
            x, y = x + FINE * rate, y + FINE * pace
    return Driven(*(values.transpose(1, 0, 2).astype(np.float32) for values in out))
