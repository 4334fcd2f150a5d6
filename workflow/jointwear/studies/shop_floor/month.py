"""Thirty days of a robot, hour by hour: whether it runs, what it makes, with which load, how fast, in which room."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

DAYS, DAY = 30, 24
HOURS = DAYS * DAY
#: Days of the baseline: the monitor is told that the robot is healthy until then. Wear begins between these days.
BASELINE_DAYS, ONSET_DAYS = 7, (10, 15)
#: Share of the robots that wear.
WORN_SHARE = 0.6


@dataclass(frozen=True)
class Month:
    """Arrays (HOURS,): `running`, `program`, `mass` [kg], `override`, `room` [degC]."""

    running: np.ndarray
    program: np.ndarray
    mass: np.ndarray
    override: np.ndarray
    room: np.ndarray


def draw_month(present: frozenset[str], programs: int, masses: tuple[float, ...], random: np.random.Generator) -> Month:
    """Draw the month of a robot with the confounders `present`."""
    running = _shifts(random) if "warm_up" in present else np.ones(HOURS, dtype=bool)
    late = int(random.uniform(9, 20) * DAY) if random.random() < 0.3 else 0
    program = np.zeros(HOURS, dtype=int)
    mass = np.full(HOURS, masses[1])
    hour = 0
    while hour < HOURS:
        batch = max(2, int(random.exponential(12)))
        known = programs - 1 if hour < late else programs
        if "products" in present:
            program[hour : hour + batch] = random.integers(known)
        if "payload" in present:
            mass[hour : hour + batch] = random.choice(masses)
        hour += batch
    override = np.ones(HOURS)
    if "override" in present:
        for start in range(0, HOURS, 8):
            override[start : start + 8] = random.choice([1.0, 0.8, 0.6, 0.45], p=[0.55, 0.2, 0.15, 0.1])
    return Month(running, program, mass, override, _room(present, random))


def _shifts(random: np.random.Generator) -> np.ndarray:
    """One, two or three shifts, Monday to Friday, sometimes on Saturday; a short break now and then."""
    first, length = [(6, 8), (6, 16), (0, 24)][int(random.integers(3))]
    hour = np.arange(HOURS)
    day, clock = hour // DAY, hour % DAY
    running = (day % 7 < 5) & (clock >= first) & (clock < first + length)
    for saturday in range(5, DAYS, 7):
        if random.random() < 0.3:
            running[saturday * DAY + 6 : saturday * DAY + 14] = True
    return running & (random.random(HOURS) > 0.03)


def _room(present: frozenset[str], random: np.random.Generator) -> np.ndarray:
    hour = np.arange(HOURS, dtype=float)
    room = np.full(HOURS, random.uniform(18, 25))
    if "weather" in present:
        room += random.uniform(1, 3.5) * np.sin(2 * np.pi * (hour - 9) / DAY)
        # The weather remembers two days.
        memory, slow = np.exp(-1 / 48), 0.0
        size = random.uniform(1.0, 2.5)
        for k in range(HOURS):
            slow = memory * slow + np.sqrt(1 - memory**2) * random.standard_normal()
            room[k] += size * slow
        if "warm_up" in present:
            room[(hour // DAY) % 7 >= 5] -= random.uniform(0, 4)
    if "cold_spell" in present:
        start = random.uniform(BASELINE_DAYS + 1, DAYS - 5) * DAY
        length = random.uniform(24, 84)
        room -= random.uniform(7, 12) / (1 + np.exp(-(hour - start) / 2)) / (1 + np.exp((hour - start - length) / 2))
    return room
