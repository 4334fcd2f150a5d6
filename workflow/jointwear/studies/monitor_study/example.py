"""The shipped example: five days of logs of a simulated arm on which one axis wears.

Twelve seconds of motion at 20 Hz are logged at the start of every hour, one file a day, in three formats. The arm is
not the nominal one: its inertial parameters are a few percent off and its friction more. Axis 6 never moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from jointwear.files.storage import Variable, write_dataset
from jointwear.files.text_files import replace_text
from jointwear.reproduction.wear import Wear
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot, load_robot
from jointwear.robots.trajectory import HOUR, Task
from jointwear.statistics.randomness import generator

SEED = 560
START = 1_767_225_600.0  # 2026-01-01T00:00:00Z in seconds since 1970 UTC
DAYS, HEALTHY_HOURS, SAMPLES, RATE = 5, 60, 240, 20.0
WORN_AXIS, WEAR = 3, Wear(20.0, 2.0, 60.0)
INERTIAL_ERROR, FRICTION_ERROR = 0.03, 0.08
#: Standard deviation over that of the torque, and lag-1 correlation, of the noise; resolution of position and torque.
NOISE, MEMORY = 0.02, 0.6
POSITION_STEP, TORQUE_STEP = 1e-5, 1e-3
TASK = Task(
    "monitor_example",
    np.radians([[-60, 20, -50, -40, 40, 10], [50, 75, 30, 60, -50, 10]]),
    np.array([6.0, 6.0]),
)


def real_arm(robot: Robot, random: np.random.Generator) -> Robot:
    """Return the robot with other inertial and friction parameters, a few percent from the nominal ones."""

    def off(size: float, shape: int | tuple[int, ...] = ()) -> np.ndarray:
        return 1 + size * random.standard_normal(shape)

    links = tuple(
        replace(
            link, mass=link.mass * off(INERTIAL_ERROR), com=link.com * off(INERTIAL_ERROR, 3),
            inertia=link.inertia * off(INERTIAL_ERROR),
        )
        for link in robot.links
    )  # fmt: skip
    n, size = robot.joints, FRICTION_ERROR
    return replace(
        robot,
        links=links,
        armature=robot.armature * off(INERTIAL_ERROR, n),
        viscous=robot.viscous * off(size, n),
        coulomb_positive=robot.coulomb_positive * off(size, n),
        coulomb_negative=robot.coulomb_negative * off(size, n),
    )


def simulate_day(arm: Robot, day: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time [s since 1970 UTC] (m,), position [rad] and torque [N m] (m, n) of a 0-based day."""
    dynamics, random = Dynamics(arm), generator(SEED, "monitor_example", day, replicate=0)
    motion = TASK.motion(np.arange(SAMPLES) / RATE)
    rigid = dynamics.rigid_body_torque(motion.position, motion.velocity, motion.acceleration)
    time, position, torque = [], [], []
    for hour in range(24 * day, 24 * (day + 1)):
        positive, negative = arm.coulomb_positive.copy(), arm.coulomb_negative.copy()
        j, age = WORN_AXIS - 1, max(hour - HEALTHY_HOURS, 0.0)
        positive[j], negative[j] = WEAR.coulomb(positive[j], negative[j], age)
        clean = rigid + dynamics.friction_torque(motion.velocity, (positive, negative))
        drawn = random.standard_normal((SAMPLES + 50, arm.joints)) * np.sqrt(1 - MEMORY**2)
        noise = lfilter([1.0], [1.0, -MEMORY], drawn, axis=0)[50:]
        time.append(START + HOUR * hour + motion.time)
        position.append(motion.position)
        torque.append(clean + NOISE * np.std(clean, axis=0) * noise)
    position, torque = np.concatenate(position), np.concatenate(torque)
    steps = (POSITION_STEP, TORQUE_STEP)
    position, torque = (s * np.round(x / s) for x, s in zip((position, torque), steps, strict=True))
    return np.concatenate(time), position, torque


def write_example(robot: str | Path, outputs: Sequence[str | Path]) -> None:
    """Write the logs, one a day; the ending of each name decides its format."""
    arm = real_arm(load_robot(robot), generator(SEED, "monitor_example_arm", replicate=0))
    for day, output in enumerate(outputs):
        time, position, torque = simulate_day(arm, day)
        writer = {".nc": write_netcdf, ".csv": _write_csv, ".parquet": _write_parquet}[Path(output).suffix]
        writer(Path(output), time, position, torque)


def write_netcdf(path: Path, time: np.ndarray, position: np.ndarray, torque: np.ndarray) -> None:
    """Write a log: `time` (m,) [s since 1970 UTC], `position` [rad] and `torque` [N m], each (m, n)."""
    pair = ("time", "joint")
    variables = {
        "joint": Variable(("joint",), np.arange(1, position.shape[1] + 1), "number of the joint", "1"),
        "time": Variable(("time",), time, "time", "seconds since 1970-01-01T00:00:00Z", compressed=True),
        "position": Variable(pair, position, "joint position", "rad", kind="f4", compressed=True),
        "torque": Variable(pair, torque, "joint torque", "N m", kind="f4", compressed=True),
    }
    write_dataset(path, variables, {"title": "log of a simulated arm"})


def _columns(position: np.ndarray, torque: np.ndarray) -> dict[str, np.ndarray]:
    named = {"position": position, "torque": torque}
    return {f"{role}_{j + 1}": x[:, j] for role, x in named.items() for j in range(x.shape[1])}


def _write_csv(path: Path, time: np.ndarray, position: np.ndarray, torque: np.ndarray) -> None:
    columns = _columns(position, torque)
    stamps = np.array(np.round(time * 1e3), dtype="datetime64[ms]")
    digits = {"position": 5, "torque": 3}
    rows = [",".join(["time", *columns])]
    formats = [f"%.{digits[name.partition('_')[0]]}f" for name in columns]
    for stamp, *values in zip(stamps.astype(str), *columns.values(), strict=True):
        rows.append(",".join([f"{stamp}Z", *(f % v for f, v in zip(formats, values, strict=True))]))
    replace_text(path, "\n".join(rows) + "\n")


def _write_parquet(path: Path, time: np.ndarray, position: np.ndarray, torque: np.ndarray) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    stamps = pa.array(np.array(np.round(time * 1e3), dtype=np.int64)).cast(pa.timestamp("ms", tz="UTC"))
    columns = {name: pa.array(x.astype(np.float32)) for name, x in _columns(position, torque).items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    parquet.write_table(pa.table({"time": stamps, **columns}), path, compression="zstd")
