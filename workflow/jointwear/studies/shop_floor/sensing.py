"""What the log of a robot holds: thirty seconds of every hour at 50 Hz, seen through its sensors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from jointwear.studies.shop_floor.cell import Cell
from jointwear.studies.shop_floor.closed_loop import RATE, SAMPLES, Driven, Runs, at_phase, drive
from jointwear.studies.shop_floor.lost_motion import drive_with_gaps
from jointwear.studies.shop_floor.programs import Job

#: The month begins on Monday 2026-03-02T00:00:00Z, in seconds since 1970.
START = 1_772_409_600.0
#: Windows that are integrated at a time, and that are sensed at a time: those fit into the cache.
BATCH, TOGETHER = 800, 40
#: Noise of a measured velocity over the speed of the axis.
VELOCITY_NOISE = 4e-4


@dataclass(frozen=True)
class Signals:
    """Windows (w,) of one job: `index` of the window in the cell, `begin` [s] of its first sample since 1970,
    `phase` (w, m) of the program [s], `override` (w,), `still` (w,); position, velocity (w, m, n), torque (w, m, n)
    with NaN where it is missing, `temperature` (w, n) [degC] with NaN where there is no sensor; `samples` (w,)."""

    job: Job
    index: np.ndarray
    begin: np.ndarray
    phase: np.ndarray
    override: np.ndarray
    still: np.ndarray
    samples: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    temperature: np.ndarray


def signals_of(cell: Cell, chosen: np.ndarray | None = None) -> Iterator[Signals]:
    """Yield the signals of a robot's windows, job by job; `chosen` : indices of windows, default all."""
    hours = cell.logged
    month = cell.month
    chosen = np.arange(len(hours)) if chosen is None else np.asarray(chosen)
    begin = _begin(cell)
    phases = cell.random("phase").uniform(0, 1, len(hours))
    coulomb, viscous, gain = cell.factors((begin - START) / 3600)
    keys = list(zip(month.program[hours].tolist(), month.mass[hours].tolist(), strict=True))
    for at in range(0, len(chosen), BATCH):
        rows = chosen[at : at + BATCH]
        known = sorted({keys[k] for k in rows})
        jobs, which = [cell.jobs(*key) for key in known], np.array([known.index(keys[k]) for k in rows])
        override, still = month.override[hours[rows]], cell.still[rows]
        phase = phases[rows] * np.array([job.program.period for job in jobs])[which]
        runs = Runs(phase, override, cell.oil[hours[rows]], coulomb[rows], viscous[rows])
        gaps = cell.gaps((begin[rows] - START) / 3600)
        if gaps is None:
            driven = drive(jobs, which, cell.gear, cell.controller, runs)
        else:
            driven = drive_with_gaps(jobs, which, cell.arm, cell.gear, cell.controller, runs, gaps)
        path = phase[:, None] + np.where(still, 0.0, override)[:, None] * np.arange(SAMPLES) / RATE
        for k, job in enumerate(jobs):
            whole = np.flatnonzero(which == k)
            for start in range(0, len(whole), TOGETHER):
                mine = whole[start : start + TOGETHER]
                yield _sensed(cell, job, rows[mine], path[mine], begin[rows[mine]], driven.part(mine), gain[rows[mine]])


@dataclass(frozen=True)
class _Faults:
    """Torque ripple of the gears over position, and noise: one set per robot."""

    marks: np.ndarray
    shift: np.ndarray
    ripple: np.ndarray
    noise: np.ndarray
    memory: float


def _faults(cell: Cell) -> _Faults:
    random, level = cell.random("ripple"), np.array(cell.arm.coulomb)
    n = len(level)
    return _Faults(
        marks=random.uniform(15, 45, n),
        shift=random.uniform(0, 2 * np.pi, n),
        ripple=random.uniform(0.003, 0.015, n) * level,
        noise=random.uniform(0.01, 0.04, n) * level,
        memory=float(random.uniform(0.3, 0.75)),
    )


def _sensed(
    cell: Cell, job: Job, rows: np.ndarray, path: np.ndarray, begin: np.ndarray, driven: Driven, gain: np.ndarray
) -> Signals:
    """Return the signals of the windows `rows` of one job, with noise, steps of the sensors and what is missing."""
    faults, still, n = _faults(cell), cell.still[rows], len(cell.arm.home)
    override = np.where(still, 0.0, cell.month.override[cell.logged[rows]])
    moved = ~still[:, None, None]
    position = at_phase(job.program.position, path) + moved * driven.deviation
    velocity = at_phase(job.program.velocity, path) * override[:, None, None] + moved * driven.rate
    torque = driven.torque.astype(float)
    if still.any():
        torque[still] = at_phase(job.true[:, 0], path[still])
    torque += faults.ripple * np.sin(faults.marks * position + faults.shift)
    # Every window has its own random numbers, whatever else is simulated.
    drawn = [cell.random("noise", int(row)).standard_normal((SAMPLES, n), dtype=np.float32) for row in rows]
    noise = lfilter([np.sqrt(1 - faults.memory**2)], [1.0, -faults.memory], np.stack(drawn), axis=1)
    torque = gain[:, None] * torque + faults.noise * noise
    step, quantum = np.array(cell.arm.torque_step), cell.arm.encoder_step
    torque = step * np.round(torque / step)
    lost = np.flatnonzero(cell.missing[rows] >= 0)
    torque[lost, :, cell.missing[rows][lost]] = np.nan
    velocity += VELOCITY_NOISE * np.array(cell.arm.speed) * noise[:, ::-1]
    return Signals(
        job=job,
        index=rows,
        begin=begin,
        phase=path,
        override=override,
        still=still,
        samples=cell.samples[rows],
        position=quantum * np.round(position / quantum),
        velocity=velocity,
        torque=torque,
        temperature=measured_temperature(cell)[rows],
    )


def _begin(cell: Cell) -> np.ndarray:
    """Return when every window begins [s since 1970]: some minutes past the hour, not always the same."""
    random = cell.random("minute")
    minute = random.uniform(0, 20)
    jitter = random.uniform(0, 30, len(cell.logged))
    return np.round(START + 3600.0 * cell.logged + 60 * minute + jitter, 2)


def measured_temperature(cell: Cell) -> np.ndarray:
    """Return what the robot logs of temperature in every window (w, n) [degC]: of the housings, near the gears."""
    random = cell.random("sensor")
    n = len(cell.arm.home)
    bias, step = random.normal(0, 1.5, n), float(random.choice([0.1, 0.5, 1.0]))
    seen = cell.housing[cell.logged] + bias + random.normal(0, 0.15, (len(cell.logged), n))
    if cell.thermometer == "none":
        return np.full(seen.shape, np.nan)
    if cell.thermometer == "one":
        seen = np.repeat(seen[:, 1:2], n, axis=1)
    return step * np.round(seen / step)
