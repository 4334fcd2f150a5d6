"""Broken logs of every format: one line, or samples whose numbers an arm can have; recordings of discovery too."""

import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from isolation import held, outcome_of
from monitor_logs import layout, make_log
from mutations import NUMBERS, WORDS, broken_bytes, seeds

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, write_dataset
from jointwear.measurement.formats import read_log
from jointwear.measurement.possible import ABSOLUTE_ZERO, ABSURD
from jointwear.measurement.recording_files import load_recording

pytestmark = pytest.mark.hostile
ROLES = ("position", "velocity", "torque")
#: Ends of the names of logs: of CSV with blanks between its columns and Parquet with a list in each row, too.
KINDS = ("csv", "blanks.csv", "parquet", "lists.parquet", "nc", "mcap")


def columns():
    log = make_log(2.0)
    table = {"time": log.time}
    for role in ROLES:
        table.update({f"{role}_{j + 1}": getattr(log, role)[:, j] for j in range(6)})
    return table | {"temperature": np.full(len(log.time), 30.0)}


def csv_text(table, between=","):
    rows = zip(*table.values(), strict=True)
    return "\n".join([between.join(table), *(between.join(f"{x:.9g}" for x in row) for row in rows)]) + "\n"


def write_log(path):
    """Write the sound log in the format that the name of `path` says."""
    log, table = make_log(2.0), columns()
    if path.suffix == ".csv":
        path.write_text(csv_text(table, "  " if "blanks" in path.name else ","))
    elif path.suffix == ".parquet":
        import pyarrow as pa
        from pyarrow import parquet

        if "lists" in path.name:
            table = {"time": log.time, **{role: list(getattr(log, role)) for role in ROLES}}
        parquet.write_table(pa.table(table), path)
    elif path.suffix == ".nc":
        both = ("sample", "joint")
        units = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
        variables = {role: Variable(both, getattr(log, role), role, units[role]) for role in ROLES}
        write_dataset(path, {"time": Variable(("sample",), log.time, "time", "s"), **variables}, {"title": "log"})
    else:
        write_bag(path, log)


def write_bag(path, log):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    kind = types.types["sensor_msgs/msg/JointState"]
    header, stamp = types.types["std_msgs/msg/Header"], types.types["builtin_interfaces/msg/Time"]
    folder = path.with_suffix("")
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/joint_states", kind.__msgtype__, typestore=types)
        for i, t in enumerate(log.time):
            ticks = round(t * 1e9)
            message = kind(
                header=header(stamp=stamp(sec=ticks // 10**9, nanosec=ticks % 10**9), frame_id=""),
                name=[f"joint_{j + 1}" for j in range(6)],
                position=log.position[i],
                velocity=log.velocity[i],
                effort=log.torque[i],
            )
            writer.write(connection, ticks, types.serialize_cdr(message, kind.__msgtype__))
    next(folder.glob("*.mcap")).rename(path)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """The bytes of the sound log in every format, written by processes of their own."""
    folder = tmp_path_factory.mktemp("logs")
    found = {}
    for kind in KINDS:
        path = folder / f"log.{kind}"
        assert outcome_of(lambda path=path: write_log(path)).kind == "accepted"
        found[kind] = path.read_bytes()
    return found


def accepted_log(path):
    """Read a log to its end; what it yields is missing or a number that an arm can have."""
    count = 0
    for chunk in read_log(path, layout(), rows=64):
        count += len(chunk.time)
        check_numbers(chunk)
    assert count <= 20_000
    return count


def check_numbers(samples):
    """Every number is missing or one that an arm can have."""
    for role in (*ROLES, "temperature"):
        values = getattr(samples, role)
        if values is not None:
            assert values.shape[0] == len(samples.time)
            assert role == "temperature" or values.shape[1] == 6
            assert (np.isnan(values) | (np.abs(values) <= ABSURD[role])).all()
            assert role != "temperature" or not (values < ABSOLUTE_ZERO).any()


def accepted_recording(path):
    recording = load_recording({"measured": str(path), "robot": "config/robots/puma560.yaml"})
    check_numbers(recording)
    return len(recording.time)


def read_both(path):
    """Read a log as monitoring does and as discovery does; one may refuse what the other takes."""
    ways = []
    for reader in (accepted_log, accepted_recording):
        try:
            ways.append(reader(path))
        except InputError as error:
            ways.append(str(error))
    if all(isinstance(way, str) for way in ways):
        raise InputError(ways[0])
    return ways


@pytest.mark.parametrize("kind", KINDS)
def test_the_sound_log_is_read(sound, tmp_path, kind):
    path = tmp_path / f"log.{kind}"
    path.write_bytes(sound[kind])
    assert outcome_of(lambda: accepted_log(path)).value == 100


@pytest.mark.parametrize("kind", KINDS)
def test_broken_bytes(sound, tmp_path, kind):
    path = tmp_path / f"log.{kind}"

    @given(broken_bytes(sound[kind]))
    @seeds(150)
    def check(data):
        path.write_bytes(data)
        held(outcome_of(lambda: read_both(path)))

    check()
    assert os.listdir(tmp_path) == [path.name]


@st.composite
def broken_tables(draw):
    """Lines of a CSV file with cells, names or separators exchanged."""
    lines = [line.split(",") for line in csv_text(columns()).splitlines()[:30]]
    for _ in range(draw(st.integers(1, 3))):
        row = draw(st.sampled_from(lines))
        cell = draw(st.integers(0, len(row) - 1))
        what = draw(st.sampled_from(["value", "value", "drop", "double", "line"]))
        if what == "value":
            row[cell] = draw(st.one_of(st.sampled_from(WORDS), st.sampled_from(NUMBERS).map(str_of)))
        elif what == "drop":
            del row[cell]
            row.extend([""] if not row else [])
        elif what == "double":
            row.insert(cell, row[cell])
        else:
            lines.append(list(row))
    separator = draw(st.sampled_from([",", ",", ",", ";", "\t", "|"]))
    return "\n".join(separator.join(row) for row in lines) + "\n"


def str_of(number):
    return f"1e{len(str(abs(number)))}" if isinstance(number, int) and abs(number) > 1e300 else str(number)


@given(broken_tables())
@seeds(200)
def test_broken_tables(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / "log.csv"
    path.write_text(text, encoding="utf-8")
    held(outcome_of(lambda: read_both(path)))


@st.composite
def impossible_tables(draw):
    """Columns that are scaled, shifted, constant, exchanged or doubled, as arrays by name."""
    table = [[name, values.copy()] for name, values in columns().items()]
    for _ in range(draw(st.integers(1, 2))):
        column = draw(st.sampled_from(table))
        size = draw(
            st.sampled_from([0.0, -1.0, 1e-12, 1e3, 1e9, 1e15, 1e300, float("nan"), float("inf"), -300.0, 1e10])
        )
        what = draw(st.sampled_from(["scale", "shift", "constant", "spike", "name", "double", "turn"]))
        with np.errstate(all="ignore"):
            if what == "scale":
                column[1] = column[1] * size
            elif what == "shift":
                column[1] = column[1] + size
            elif what == "constant":
                column[1][:] = size
            elif what == "spike":
                column[1][draw(st.integers(0, len(column[1]) - 1)) :][:3] = size
            elif what == "turn":
                column[1] = column[1][::-1].copy()
            elif what == "double":
                table.append([draw(st.sampled_from(table))[0], column[1]])
            else:
                column[0] = draw(st.sampled_from(["torque_٣", "position_" + "9" * 5000, "time", "trajectory", "x"]))
    return table


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_impossible_tables(tmp_path, kind):
    import pyarrow as pa
    from pyarrow import parquet

    path = tmp_path / f"log.{kind}"

    def write(table):
        names, values = [name for name, _ in table], [column for _, column in table]
        if kind == "parquet":
            parquet.write_table(pa.Table.from_arrays([pa.array(v) for v in values], names=names), path)
        else:
            rows = [
                ",".join(names),
                *(",".join(map(repr, row)) for row in zip(*(v.tolist() for v in values), strict=True)),
            ]
            path.write_text("\n".join(rows) + "\n")

    @given(impossible_tables())
    @seeds(60)
    def check(table):
        assert outcome_of(lambda: write(table)).kind == "accepted"
        held(outcome_of(lambda: read_both(path)))

    check()


def test_a_pipe_and_a_million_columns_do_not_hang(tmp_path):
    for kind in ("csv", "parquet", "nc", "mcap"):
        os.mkfifo(tmp_path / f"pipe.{kind}")
        found = held(outcome_of(lambda kind=kind: read_both(tmp_path / f"pipe.{kind}")))
        assert found.kind == "refused"
        assert "named pipe" in found.value
    wide = tmp_path / "wide.csv"
    wide.write_text(",".join(f"c{i}" for i in range(10**6)) + "\n" + ",".join(["1"] * 10**6) + "\n")
    found = held(outcome_of(lambda: read_both(wide)))
    assert found.kind == "refused"
