"""ROS 2 bags (rosbag2 with SQLite, MCAP) with messages of sensor_msgs/JointState.

Messages are decoded with the definition that the library brings, never with one that the bag brings.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from jointwear.files.errors import EMPTY, TRUNCATED, InputError, nearest
from jointwear.files.wording import count
from jointwear.measurement.formats.chunk import Chunk, make_chunk
from jointwear.measurement.formats.layout import Layout

JOINT_STATE = "sensor_msgs/msg/JointState"


@cache
def _types():
    return get_typestore(Stores.ROS2_HUMBLE)


def read(path: Path, layout: Layout, rows: int) -> Iterator[Chunk]:
    """Yield the samples of a bag; see :func:`jointwear.measurement.formats.read_log`.

    Messages that do not hold all joints (a gripper on the same topic) are left out. The time is that of the header,
    or of reception where the header has none.

    Raises
    ------
    InputError : if the file cannot be read, or lacks what the layout asks for.
    """
    if path.is_file() and path.stat().st_size == 0:
        raise InputError(f"{path}: {EMPTY}")
    try:
        reader = Reader(path)
        reader.open()
    except Exception as error:  # the library raises whatever a damaged file causes
        raise InputError(f"{path}: {TRUNCATED} ROS 2 bag ({_first_line(error)})") from None
    if layout.program:
        raise InputError(f"{path}: 'program.columns' names columns, and joint states have none; give 'program.logs'")
    try:
        connection = _connection(path, reader, layout)
        yield from _samples(path, reader, connection, layout, rows)
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path}: is damaged ({_first_line(error)})") from None
    finally:
        reader.close()


def _first_line(error: Exception) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)[:200]


def _connection(path: Path, reader: Reader, layout: Layout):
    """The connections of the topic with joint states: the one of the config, or the only one."""
    states = [c for c in reader.connections if c.msgtype == JOINT_STATE]
    topics = sorted({c.topic for c in states})
    if layout.topic is not None:
        chosen = [c for c in states if c.topic == layout.topic]
        if not chosen:
            raise InputError(
                f"{path}: has no joint states on topic '{layout.topic}'{nearest(layout.topic, topics)} "
                f"(there are: {', '.join(topics) or 'none'})"
            )
        return chosen
    if not states:
        other = ", ".join(sorted({c.msgtype for c in reader.connections})) or "nothing"
        raise InputError(f"{path}: has no messages of sensor_msgs/JointState (it has: {other})")
    if len(topics) > 1:
        raise InputError(f"{path}: has joint states on several topics ({', '.join(topics)}); name one under 'topic'")
    return states


def _order(names: tuple[str, ...], layout: Layout) -> np.ndarray | None:
    """Return where the axes are in a message with these joint names; None if it does not hold them all."""
    if not names:
        return np.arange(layout.axes)
    if not set(layout.joints) <= set(names):
        return None
    return np.array([names.index(joint) for joint in layout.joints])


def _messages(
    path: Path, reader: Reader, connections, layout: Layout
) -> Iterator[tuple[float, dict[str, np.ndarray | None]]]:
    """Yield time [s] and, of each role, the values (n,) of the axes, None where the message has none.

    Raises
    ------
    InputError : if a message has fewer values than joints, or none holds the joints of the robot.
    """
    decode, orders = _types().deserialize_cdr, {}
    other: tuple[str, ...] | None = None
    seen = False
    for _, received, raw in reader.messages(connections=connections):
        message = decode(raw, JOINT_STATE)
        names = tuple(message.name)
        if names not in orders:
            orders[names] = _order(names, layout)
        order = orders[names]
        if order is None:
            other = names
            continue
        stamp = message.header.stamp
        time = stamp.sec + 1e-9 * stamp.nanosec if stamp.sec or stamp.nanosec else 1e-9 * received
        parts = {"position": message.position, "velocity": message.velocity, "torque": message.effort}
        for role, values in parts.items():
            if 0 < len(values) <= order.max():
                raise InputError(
                    f"{path}: a message names {count(len(names), 'joint')} and has "
                    f"{count(len(values), 'value')} of {role}"
                )
        seen = True
        yield time, {role: values[order] if len(values) else None for role, values in parts.items()}
    if not seen and other is not None:
        raise InputError(
            f"{path}: its joints are {', '.join(other)}; the robot's are {', '.join(layout.joints)}; "
            "name the log's joints in order of the axes under 'joints'"
        )


def _check_carried(path: Path, messages: Iterator[tuple[float, dict[str, np.ndarray | None]]]) -> None:
    """Check that some message of a bag carries efforts, and some positions; a drive may pause with either.

    Raises
    ------
    InputError : if there are messages, and none carries them.
    """
    lacking = {
        "torque": "no effort; without torque nothing can be judged",
        "position": "no position",
    }
    seen = False
    for _, parts in messages:
        seen = True
        for role in list(lacking):
            values = parts[role]
            if values is not None and np.isfinite(values).any():
                del lacking[role]
        if not lacking:
            return
    if seen:
        raise InputError(f"{path}: the messages carry {next(iter(lacking.values()))}")


def _samples(path: Path, reader: Reader, connections, layout: Layout, rows: int) -> Iterator[Chunk]:
    _check_carried(path, _messages(path, reader, connections, layout))
    buffer: dict[str, list] = {role: [] for role in ("time", "position", "velocity", "torque")}
    empty = np.full(layout.axes, np.nan)
    for time, parts in _messages(path, reader, connections, layout):
        buffer["time"].append(time)
        for role, values in parts.items():
            buffer[role].append(empty if values is None else values)
        if len(buffer["time"]) >= rows:
            yield _chunk(path, buffer, layout)
            buffer = {role: [] for role in buffer}
    if buffer["time"]:
        yield _chunk(path, buffer, layout)


def _chunk(path: Path, buffer: dict[str, list], layout: Layout) -> Chunk:
    values = {role: np.array(column, dtype=float) for role, column in buffer.items()}
    if not np.isfinite(values["velocity"]).any():
        del values["velocity"]
    return make_chunk(path, values, layout, {}, False)
