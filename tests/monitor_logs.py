"""Small logs for the tests of monitoring: a simulated arm, written in every format, well or badly."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from jointwear.files.storage import Variable, write_dataset
from jointwear.measurement.formats import layout_of
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.model import TorqueModel
from jointwear.monitor.reading.survey import Survey, survey_log
from jointwear.robots.robot import load_robot
from jointwear.studies.monitor_study.example import TASK

#: Length of the windows of :func:`read` [s].
LENGTH = 12.0

ROOT = Path(__file__).resolve().parents[1]
ROBOT = ROOT / "config/robots/puma560.yaml"
RATE = 50.0
START = 1_767_225_600.0  # 2026-01-01T00:00:00Z


@cache
def model() -> TorqueModel:
    """The nominal arm."""
    return TorqueModel(load_robot(ROBOT))


def layout(**entry):
    """The layout of a config entry for that arm."""
    return layout_of(entry, model().robot.joint_names)


@dataclass(frozen=True)
class Log:
    """Samples of a log: time (m,), position, velocity, acceleration, torque (m, n)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray

    def part(self, chosen) -> Log:
        """Some of the samples."""
        return Log(*(getattr(self, f)[chosen] for f in self.__dataclass_fields__))


def make_log(seconds: float = 60.0, seed: int = 1, start: float = 0.0, rate: float = RATE, noise: float = 0.01) -> Log:
    """A log of the nominal arm on the example's task, with white noise on the torque."""
    time = np.arange(round(seconds * rate)) / rate
    motion = TASK.motion(time)
    torque = model()(motion.position, motion.velocity, motion.acceleration).total
    torque = torque + noise * np.std(torque, axis=0) * np.random.default_rng(seed).standard_normal(torque.shape)
    return Log(start + time, motion.position, motion.velocity, motion.acceleration, torque)


def columns(log: Log, *roles: str) -> dict[str, np.ndarray]:
    """One column an axis, as CSV and Parquet have them; default position and torque."""
    table = {"time": log.time}
    for role in roles or ("position", "torque"):
        table |= {f"{role}_{j + 1}": getattr(log, role)[:, j] for j in range(log.torque.shape[1])}
    return table


def write_csv(path: Path, table: dict[str, np.ndarray]) -> Path:
    """Write columns of numbers or text as CSV."""
    rows = [",".join(table)]
    rows += [
        ",".join(str(v) for v in row) for row in zip(*(np.asarray(c).tolist() for c in table.values()), strict=True)
    ]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def write_parquet(path: Path, table: dict[str, np.ndarray]) -> Path:
    """Write columns as Parquet."""
    parquet.write_table(pa.table({k: pa.array(v) for k, v in table.items()}), path)
    return path


def write_netcdf(path: Path, log: Log, *roles: str, units: str = "s") -> Path:
    """Write a log as netCDF."""
    variables = {"time": Variable(("time",), log.time, "time", units)}
    for role in roles or ("position", "torque"):
        variables[role] = Variable(("time", "joint"), getattr(log, role), role)
    write_dataset(path, variables, {})
    return path


def write_bag(
    path: Path, log: Log, storage: str = "mcap", names=None, effort: bool = True, velocity: bool = False, order=None
) -> Path:
    """Write a log as a bag of joint states on /joint_states; returns the folder."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    state, header = types.types["sensor_msgs/msg/JointState"], types.types["std_msgs/msg/Header"]
    stamp = types.types["builtin_interfaces/msg/Time"]
    names = list(names or model().robot.joint_names)
    order = list(range(len(names))) if order is None else order
    empty = np.zeros(0)
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()]) as writer:
        connection = writer.add_connection("/joint_states", state.__msgtype__, typestore=types)
        for k, time in enumerate(log.time):
            second = int(np.floor(time))
            nanosecond = min(round((time - second) * 1e9), 999_999_999)
            message = state(
                header=header(stamp=stamp(sec=second, nanosec=nanosecond), frame_id=""),
                name=[names[i] for i in order],
                position=log.position[k, order],
                velocity=log.velocity[k, order] if velocity else empty,
                effort=log.torque[k, order] if effort else empty,
            )
            writer.write(connection, second * 10**9 + nanosecond, types.serialize_cdr(message, state.__msgtype__))
    return path


def survey_of(path, **entry) -> Survey:
    """Survey of a first log; see :func:`survey_once`."""
    return survey_once(str(path), layout(**entry), model(), LENGTH)


def survey_once(path: str, *how) -> Survey:
    """Survey a log as `survey_log` does; of a file with the same content, read in the same way, once a process."""
    log = Path(path)
    if not log.is_file():
        return survey_log(path, *how)
    reading, arm, *more = how
    key = log.suffix, log.read_bytes(), pickle.dumps((reading, arm.robot, more))
    if key not in _SURVEYS:
        _SURVEYS[key] = survey_log(path, *how)
    return replace(_SURVEYS[key], log=path)


_SURVEYS: dict[tuple[str, bytes, bytes], Survey] = {}


def read(path, first=None, **entry):
    """Statistics of a log, surveyed with itself or with another."""
    return log_statistics(str(path), layout(**entry), model(), survey_of(first or path, **entry), LENGTH)


def flagged(found, flag, axis=None):
    """Whether a flag is set in some window, of one axis or of any."""
    flags = found.statistics.flags if axis is None else found.statistics.flags[:, axis]
    return bool((flags & int(flag)).any())
