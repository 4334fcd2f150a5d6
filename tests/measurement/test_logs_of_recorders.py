"""Logs as recorders and converters of the field write them: their names, separators, lists and times."""

import gzip

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from written_logs import HEADER, one, write

from jointwear.files.errors import InputError
from jointwear.measurement.formats import ends_within_a_row, layout_of, read_log

ROWS = [["0.00", "0.5", "1.25"], ["0.01", "0.6", "1.5"]]
SECONDS = 1767225600


def of(path, axes, **entry):
    """The samples of a log of some joints, in one chunk."""
    return next(iter(read_log(path, layout_of(entry, [f"joint_{k + 1}" for k in range(axes)]))))


def table(path, columns):
    """Write columns, name -> values, with commas."""
    return write(path, [",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))])


@pytest.mark.parametrize("between", [" ", "   ", " \t "])
@pytest.mark.parametrize("packed", [False, True])
def test_columns_between_blanks(tmp_path, between, packed):
    lines = ["# recorded at 100 Hz", *(f"  {between.join(row)} " for row in [HEADER, *ROWS])]
    path = write(tmp_path / "a.csv", lines)
    if packed:
        path = tmp_path / "a.csv.gz"
        path.write_bytes(gzip.compress("\n".join(lines).encode()))
    chunk = one(path)
    assert chunk.time.tolist() == [0.0, 0.01]
    assert chunk.torque[:, 0].tolist() == [1.25, 1.5]


def test_many_blocks_between_blanks_are_whole(tmp_path):
    lines = ["  ".join(HEADER), *(f"{0.01 * k:9.2f}   {0.001 * k:.3f} {k}" for k in range(120_000))]
    chunks = list(read_log(write(tmp_path / "a.csv", lines), layout_of({}, ["joint_1"]), rows=5000))
    assert len(chunks) > 5
    assert np.array_equal(np.concatenate([c.torque[:, 0] for c in chunks]), np.arange(120_000.0))


def test_a_row_between_blanks_that_is_still_written_is_no_fault(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"time  position_1  torque_1\n0.00  0.5  1.25\n0.01  0.6  1.5\n0.02   0.7")
    assert len(one(path).time) == 2
    assert ends_within_a_row(path, layout_of({}, ["joint_1"]))


def test_blanks_within_names_separate_nothing(tmp_path):
    """A header of which the words alone would be columns."""
    path = write(tmp_path / "a.csv", ["time;position_1 torque_1", "0;1", "1;2"])
    with pytest.raises(InputError, match=r"has no position .* \(it has: time, position_1 torque_1\)"):
        one(path)


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize(
    ("form", "names"),
    [
        ("q_{}", ("q", "tau")),
        ("q{}", ("q", "tau")),
        ("q{}", ("q{}", "tau{}")),
        ("J{}_q", ("J{}_q", "J{}_tau")),
        ("A{} q [deg]", ("A{} q", "A{} tau")),
    ],
)
def test_forms_of_numbered_names(tmp_path, first, form, names):
    columns = {"time": [0.0, 0.1]}
    for k in range(11):
        columns[form.format(first + k)] = [k, k + 0.5]
        columns[form.format(first + k).replace("q", "tau").replace("deg", "Nm")] = [10 * k, 10 * k + 0.5]
    chunk = of(table(tmp_path / "a.csv", columns), 11, variables=dict(zip(("position", "torque"), names, strict=True)))
    turn = np.pi / 180 if "deg" in form else 1.0
    assert np.allclose(chunk.position[0], turn * np.arange(11))
    assert np.allclose(chunk.torque[1], 10 * np.arange(11) + 0.5)


def test_default_names_without_a_line(tmp_path):
    columns = {"time": [0.0], "position1": [1], "position2": [2], "torque1": [3], "torque2": [4], "velocity1": [5]}
    chunk = of(table(tmp_path / "a.csv", columns), 2)
    assert chunk.position.tolist() == [[1, 2]]
    assert chunk.torque.tolist() == [[3, 4]]
    # What nobody asks for is not looked for under another name.
    assert chunk.velocity is None


def test_names_of_joints_stand_for_their_order(tmp_path):
    columns = {"t": [0.0], "elbow/q": [2], "base/q": [1], "elbow/m": [20], "base/m": [10]}
    entry = {"variables": {"time": "t", "position": "{}/q", "torque": "{}/m"}}
    path = table(tmp_path / "a.csv", columns)
    chunk = of(path, 2, joints=["base", "elbow"], **entry)
    assert chunk.position.tolist() == [[1, 2]]
    assert chunk.torque.tolist() == [[10, 20]]
    with pytest.raises(InputError, match=r"has no position \(looked for '1/q'\)"):
        of(path, 2, joints=["base", "wrist"], **entry)


def test_a_gap_is_told_in_the_form_of_the_names(tmp_path):
    columns = {"time": [0.0], "J1_q": [1], "J3_q": [3], "tau1": [1], "tau2": [1], "tau3": [1]}
    with pytest.raises(InputError, match=r"the columns 'J1_q', 'J2_q' \.\.\. have gaps .*'J2_q' is missing"):
        of(table(tmp_path / "a.csv", columns), 3, variables={"position": "J{}_q", "torque": "tau"})


def test_forms_that_fit_are_proposed(tmp_path):
    columns = {"time": [0.0], "J1_pos": [1], "J2_pos": [2], "J1_trq": [3], "J2_trq": [4], "relay_7": [0]}
    with pytest.raises(InputError, match=r"as 'position: \"J\{\}_pos\"' if it is one of 'J\{\}_pos', 'J\{\}_trq' \("):
        of(table(tmp_path / "a.csv", columns), 2)
    # What has a role already is not proposed.
    with pytest.raises(InputError, match=r"as 'position: \"J\{\}_pos\"' if it is one of 'J\{\}_pos' \("):
        of(table(tmp_path / "a.csv", columns), 2, variables={"torque": "J{}_trq"})


def test_two_columns_of_one_joint_are_told(tmp_path):
    columns = {"time": [0.0], "q1": [1], "q01": [1], "q2": [2], "tau1": [1], "tau2": [1]}
    with pytest.raises(InputError, match="the columns 'q01' and 'q1' are of the same joint"):
        of(table(tmp_path / "a.csv", columns), 2, variables={"position": "q", "torque": "tau"})


def test_a_long_line_is_told_in_part(tmp_path):
    path = write(tmp_path / "a.csv", [" ".join(f"c{k}" for k in range(20_000)), "1 " * 20_000])
    with pytest.raises(InputError) as caught:
        one(path)
    assert len(str(caught.value)) < 500


def test_names_are_told_of_the_header_below_a_preamble(tmp_path):
    lines = ["Trace;V8.6;", "robot;12", "", "Zeit;A1 Ist;A1 Moment", "0,00;1,5;2,5", "0,01;1,6;2,5"]
    with pytest.raises(InputError, match=r"\(it has: Zeit, A1 Ist, A1 Moment\)"):
        one(write(tmp_path / "a.csv", lines))


def test_names_of_joints_among_the_values_of_a_first_line(tmp_path):
    """As `ros2 topic echo --csv` writes: no header."""
    with pytest.raises(InputError, match="the first line holds numbers; a header line"):
        one(write(tmp_path / "a.csv", ["1767225600,12,,elbow,0.5,0.0,1.25", "1767225600,22,,elbow,0.5,0.0,1.25"]))


def test_date_and_time_of_day_in_two_columns(tmp_path):
    columns = {"Date": ["31.01.2026", "01.02.2026"], "Time": ["23:59:59.5", "0:00:00.5"]}
    entry = {"variables": {"time": ["Date", "Time"]}, "time_zone": "Europe/Berlin"}
    path = table(tmp_path / "a.csv", columns | {"position_1": [1, 2], "torque_1": [1, 2]})
    chunk = of(path, 1, **entry)
    assert chunk.dated
    assert np.allclose(np.diff(chunk.time), 1.0)
    assert chunk.time[0] == np.datetime64("2026-01-31T22:59:59.5", "ms").astype(float) / 1e3


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_seconds_and_nanoseconds_in_two_columns(tmp_path, kind):
    columns = {"sec": [SECONDS, SECONDS + 1], "nanosec": [5_000_000, 0], "position_1": [1, 2], "torque_1": [1, 2]}
    path = tmp_path / f"a.{kind}"
    table(path, columns) if kind == "csv" else parquet.write_table(pa.table(columns), path)
    entry = {"variables": {"time": ["sec", "nanosec"]}}
    chunk = of(path, 1, **entry)
    assert chunk.dated
    assert np.allclose(chunk.time, [SECONDS + 0.005, SECONDS + 1], rtol=0, atol=1e-6)
    columns["nanosec"] = [0.5, 0.25]
    table(path, columns) if kind == "csv" else parquet.write_table(pa.table(columns), path)
    with pytest.raises(InputError, match=r"'nanosec' is no whole number of nanoseconds below a second: '0\.5'"):
        of(path, 1, **entry)


def test_damaged_cells_of_two_columns_are_left_out(tmp_path):
    rows = [f"{SECONDS},{10_000_000 * k},{k},{k}" for k in range(60)]
    rows[30] = f"{SECONDS},,30,30"
    chunk = of(
        write(tmp_path / "a.csv", ["sec,nsec,position_1,torque_1", *rows]), 1, variables={"time": ["sec", "nsec"]}
    )
    assert np.sum(np.isfinite(chunk.time)) == 59


@pytest.mark.parametrize(("role", "names"), [("time", ["a", "b", "c"]), ("trajectory", ["a", "b"])])
def test_a_role_takes_so_many_columns(tmp_path, role, names):
    columns = {name: [1.0] for name in ("time", "position_1", "torque_1", "a", "b", "c")}
    with pytest.raises(InputError, match=rf"'variables\.{role}' has {len(names)} names; allowed: one"):
        of(table(tmp_path / "a.csv", columns), 1, variables={role: names})


@pytest.mark.parametrize("kind", [pa.list_(pa.float64()), pa.list_(pa.float32(), 2), pa.large_list(pa.int64())])
def test_lists_of_all_joints_in_parquet(tmp_path, kind):
    rows = [[float(k), k + 1.0] for k in range(50)]
    holes = [None if k == 7 else row for k, row in enumerate(rows)]
    columns = {"time": np.arange(50.0), "q": pa.array(rows, kind), "torque": pa.array(holes, kind)}
    parquet.write_table(pa.table(columns), tmp_path / "a.parquet")
    chunks = list(read_log(tmp_path / "a.parquet", layout_of({"variables": {"position": "q"}}, ["a", "b"]), rows=20))
    assert len(chunks) == 3
    assert np.array_equal(np.concatenate([c.position for c in chunks]), rows)
    torque = np.concatenate([c.torque for c in chunks])
    assert np.isnan(torque[7]).all()
    assert np.array_equal(np.delete(torque, 7, 0), np.delete(rows, 7, 0))


def test_lists_of_another_length_are_told(tmp_path):
    rows = [[0.0, 1.0]] * 30 + [[0.0]] + [[0.0, 1.0]] * 5
    columns = {"time": np.arange(36.0), "position": rows, "torque": [[0.0, 1.0]] * 36}
    parquet.write_table(pa.table(columns), tmp_path / "a.parquet")
    layout = layout_of({}, ["a", "b"])
    with pytest.raises(InputError, match="row 31 of the column 'position' holds 1 value, the first one 2"):
        list(read_log(tmp_path / "a.parquet", layout, rows=20))
    columns["position"] = [[]] * 36
    parquet.write_table(pa.table(columns), tmp_path / "b.parquet")
    with pytest.raises(InputError, match="has no position"):
        list(read_log(tmp_path / "b.parquet", layout))


def test_a_list_that_nobody_asks_for_is_in_nobodys_way(tmp_path):
    columns = {"time": np.arange(50.0), "position_1": np.arange(50.0), "torque_1": np.arange(50.0)}
    parquet.write_table(pa.table(columns | {"velocity": [[1.0, 2.0]] * 50}), tmp_path / "a.parquet")
    assert one(tmp_path / "a.parquet").velocity is None


def test_lists_in_text_are_told_with_the_way_out(tmp_path):
    lines = ["time,position,torque", '0.0,"[0.1, 0.2]","[1.0, 2.0]"', '0.1,"[0.1, 0.2]","[1.0, 2.0]"']
    with pytest.raises(
        InputError, match=r"'position' holds lists, which are not read from text: .* 'position_1', 'pos"
    ):
        of(write(tmp_path / "a.csv", lines), 2)


@pytest.mark.parametrize(
    ("name", "words"),
    [("a.txt", "name ends with .csv"), ("a.mat", "export it as CSV or Parquet"), ("a.bag", "a bag of ROS 2")],
)
def test_other_files_are_told_what_makes_a_log_of_them(tmp_path, name, words):
    (tmp_path / name).write_text("")
    with pytest.raises(InputError, match=words):
        one(tmp_path / name)


def joints_of(name, values):
    """Columns of two joints, counted from 0, of one value each."""
    return {name.format(k): [v] for k, v in enumerate(values)}


RECORDERS = {
    "rtde": (
        " ",
        {"timestamp": [12.5]}
        | joints_of("actual_q_{}", [0.1, 0.2])
        | joints_of("actual_current_{}", [1.0, 2.0])
        | joints_of("joint_temperatures_{}", [30.0, 31.0]),
        {
            "variables": {
                "time": "timestamp",
                "position": "actual_q",
                "torque": "actual_current",
                "temperature": "joint_temperatures",
            },
            "units": {"torque": "A"},
            "torque_constant": 10.0,
        },
    ),
    "rostopic": (
        ",",
        {"%time": [12_500_000_000], "field.header.stamp": [12_500_000_000], "field.header.frame_id": [""]}
        | joints_of("field.name{}", ["pan", "lift"])
        | joints_of("field.position{}", [0.1, 0.2])
        | joints_of("field.effort{}", [10.0, 20.0]),
        {
            "variables": {"time": "field.header.stamp", "position": "field.position", "torque": "field.effort"},
            "units": {"time": "ns"},
        },
    ),
    "plotjuggler": (
        ",",
        {
            "__time": [12.5],
            "/joint_states/lift/position": [0.2],
            "/joint_states/pan/position": [0.1],
            "/joint_states/lift/effort": [20.0],
            "/joint_states/pan/effort": [10.0],
        },
        {
            "variables": {
                "time": "__time",
                "position": "/joint_states/{}/position",
                "torque": "/joint_states/{}/effort",
            },
            "joints": ["pan", "lift"],
        },
    ),
}


@pytest.mark.parametrize("recorder", RECORDERS)
def test_keys_of_common_recorders(tmp_path, recorder):
    """Those of docs/howto/monitor.md."""
    between, columns, entry = RECORDERS[recorder]
    rows = [columns, *zip(*columns.values(), strict=True)]
    path = write(tmp_path / "a.csv", [between.join(map(str, row)) for row in rows] + [""])
    chunk = next(iter(read_log(path, layout_of(entry, ["a", "b"]))))
    assert chunk.time.tolist() == [12.5]
    assert chunk.position.tolist() == [[0.1, 0.2]]
    assert chunk.torque.tolist() == [[10.0, 20.0]]
    assert recorder != "rtde" or chunk.temperature.tolist() == [[30.0, 31.0]]
