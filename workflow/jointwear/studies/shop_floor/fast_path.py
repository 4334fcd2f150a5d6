"""A robot-month straight to the window statistics of the monitor, without files.

The survey is the product's own, of a first log that is written and read. Velocity and acceleration are derived with
its cut-off by the filters of the product, for all windows at once; the torque of the model is that of the robot file
along the program, with its mass matrix for the accelerations that differ from the program's.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.signal import butter, sosfiltfilt

from jointwear.measurement.flags import Flag
from jointwear.measurement.formats import layout_of
from jointwear.monitor.reading.accumulate import Samples, WindowSettings, moving, window_statistics
from jointwear.monitor.reading.carried import with_loads
from jointwear.monitor.reading.model import ModelTorque, TorqueModel
from jointwear.monitor.reading.reversals import reach_of
from jointwear.monitor.reading.survey import Survey, guard_of, survey_log
from jointwear.monitor.reading.windows import WindowStatistics, merge
from jointwear.robots.robot import Robot
from jointwear.studies.shop_floor.arms import robot_data, robot_of
from jointwear.studies.shop_floor.cell import Cell
from jointwear.studies.shop_floor.closed_loop import RATE, at_phase
from jointwear.studies.shop_floor.log_files import columns_of, write_log
from jointwear.studies.shop_floor.programs import Job
from jointwear.studies.shop_floor.sensing import Signals, signals_of

#: Length of a window [s]; windows of the first log, whose survey decides how all are read.
WINDOW, FIRST = 3600.0, 8


def survey_of(cell: Cell, left: float = 1.0) -> Survey:
    """Return the survey of the robot's first log.

    Parameters
    ----------
    left : share of what the model does not explain that stays in the torque. With little or none nothing contradicts
        the model: as after a user has looked at a refusal and gone on.

    Raises
    ------
    Refused : where the log seems to contradict the model.
    """
    model = TorqueModel(nominal_robot(cell))
    moving = np.flatnonzero(~cell.still & (cell.missing < 0))[:FIRST]
    signals = list(signals_of(cell, moving))
    if left < 1:
        signals = [_as_modelled(s, model, left) for s in signals]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "first.parquet"
        write_log(path, columns_of(cell, signals))
        return survey_log(str(path), layout_of({}, model.robot.joint_names), model, WINDOW)


def _as_modelled(signals: Signals, model: TorqueModel, left: float) -> Signals:
    program, s = signals.job.program, signals.override[:, None, None]
    path = [at_phase(x, signals.phase) for x in (program.position, program.velocity, program.acceleration)]
    torque = model(path[0], s * path[1], s**2 * path[2]).total
    return replace(signals, torque=torque + left * (signals.torque - signals.torque.mean(axis=1, keepdims=True)))


def nominal_robot(cell: Cell) -> Robot:
    """Return the robot of the file that a user has: the arm as its maker describes it."""
    return robot_of(robot_data(cell.arm))


def statistics_of(cell: Cell, survey: Survey | None = None) -> WindowStatistics:
    """Return the statistics of all windows of a robot."""
    survey = survey or survey_of(cell)
    robot = nominal_robot(cell)
    settings = WindowSettings(
        WINDOW,
        np.array(survey.dead_band),
        np.array(survey.torque_reference),
        guard_of(survey.rate),
        reach_of(survey.rate),
        survey.block,
    )
    return merge([_statistics(s, robot, cell, survey, settings) for s in signals_of(cell)])


def _statistics(
    signals: Signals, robot: Robot, cell: Cell, survey: Survey, settings: WindowSettings
) -> WindowStatistics:
    w, m, n = signals.position.shape
    velocity, acceleration, reach = _derived(signals, cell, np.array(survey.cutoff))
    s2 = (signals.override**2)[:, None, None]
    bodies = at_phase(signals.job.model, signals.phase)
    planned = at_phase(signals.job.program.acceleration, signals.phase) * s2
    gravity = bodies[:, :, 0]
    inertial = bodies[:, :, 1] * s2 + at_phase(signals.job.nominal, signals.phase) * (acceleration - planned)
    sign = np.sign(velocity)
    level = (robot.coulomb_positive - robot.coulomb_negative) / 2
    total = gravity + inertial + robot.viscous * velocity + level * sign
    sample = np.arange(m)
    inside = sample[None] < signals.samples[:, None]
    usable = inside & (sample >= reach) & (sample[None] < signals.samples[:, None] - reach)
    kept = inside.ravel()
    time = (signals.begin[:, None] + sample / RATE).ravel()[kept]

    def whole(values: np.ndarray) -> np.ndarray:
        return values.reshape(w * m, n)

    residual, every = whole(signals.torque - total), np.repeat(np.arange(w), m)
    used = usable.ravel()[:, None] & np.isfinite(residual)
    used &= moving(whole(velocity), every, settings.dead_band, settings.guard)
    phase, square = signals.phase.ravel(), np.repeat(signals.override**2, m)

    pieces = [[slice(k * m, k * m + int(count))] for k, count in enumerate(signals.samples)]
    model, clear = with_loads(
        ModelTorque(whole(total), whole(gravity), whole(inertial)),
        residual,
        whole(velocity),
        used,
        pieces,
        1 / RATE,
        _JobLoads(signals.job, phase, square),
    )

    def rows(values: np.ndarray) -> np.ndarray:
        return values.reshape(w * m, n)[kept]

    temperature = np.broadcast_to(signals.temperature[:, None], (w, m, n))
    torque = rows(signals.torque)
    flags = np.where(np.isfinite(torque), 0, int(Flag.NOT_FINITE))
    samples = Samples(
        time,
        rows(signals.position),
        rows(velocity),
        torque,
        ModelTorque(*(values[kept] for values in (model.total, model.gravity, model.inertial))),
        usable=(usable.ravel()[:, None] & clear)[kept],
        stretch=np.repeat(np.arange(w), m)[kept],
        temperature=rows(temperature) if cell.thermometer != "none" else None,
        flags=flags,
        dated=True,
    )
    return window_statistics(samples, settings)


@dataclass(frozen=True)
class _JobLoads:
    """Torques of loads along the phases (k,) of a job at a squared override (k,)."""

    job: Job
    phase: np.ndarray
    square: np.ndarray

    def unit(self, rows: np.ndarray) -> np.ndarray:
        """See :class:`jointwear.monitor.reading.carried.UnitTorques`."""
        return self._parts(rows).sum(axis=0)

    def torque(self, rows: np.ndarray, moments: np.ndarray) -> np.ndarray:
        """See :class:`jointwear.monitor.reading.carried.UnitTorques`."""
        return np.einsum("smkn,mk->smn", self._parts(rows), moments)

    def _parts(self, rows: np.ndarray) -> np.ndarray:
        """Return gravity and inertial torque (2, k, 4, n) of unit loads."""
        parts = at_phase(self.job.load, self.phase[rows])
        return np.stack([parts[:, 0], parts[:, 1] * self.square[rows, None, None]])


def _derived(signals: Signals, cell: Cell, cutoff: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Return velocity and acceleration (w, m, n), and the samples at either end that a filter edge reaches."""
    limit = np.minimum(cutoff, 0.4 * RATE)
    reach = int(np.ceil(1.2 * RATE / limit.min())) + 1
    source = signals.velocity if cell.arm.logs_velocity else signals.position
    smooth = np.empty_like(source)
    for j in range(source.shape[2]):
        sections = butter(4, limit[j], fs=RATE, output="sos")
        smooth[..., j] = sosfiltfilt(sections, source[..., j], axis=1)
    first = np.gradient(smooth, 1 / RATE, axis=1)
    first[:, 2:-2] = (8 * (smooth[:, 3:-1] - smooth[:, 1:-3]) - (smooth[:, 4:] - smooth[:, :-4])) * RATE / 12
    if cell.arm.logs_velocity:
        return signals.velocity, first, reach
    second = np.zeros_like(smooth)
    second[:, 2:-2] = (
        (16 * (smooth[:, 3:-1] + smooth[:, 1:-3]) - (smooth[:, 4:] + smooth[:, :-4]) - 30 * smooth[:, 2:-2])
        * RATE**2
        / 12
    )
    return first, second, reach
