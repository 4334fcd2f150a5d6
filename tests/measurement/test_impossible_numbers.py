"""Numbers that no arm can have, and tables that say two things: refused or missing, in logs and in recordings alike."""

import numpy as np
import pyarrow as pa
import pytest
from monitor_logs import columns, layout, make_log, write_csv
from pyarrow import parquet

from jointwear.files.errors import InputError
from jointwear.measurement.formats import read_log
from jointwear.measurement.recording_files import load_recording

WRITERS = {
    "csv": write_csv,
    "parquet": lambda path, table: parquet.write_table(
        pa.Table.from_arrays([pa.array(v) for v in table.values()], names=list(table)), path
    ),
}


@pytest.fixture
def table():
    log = make_log(4.0)
    return {**columns(log), "temperature": np.full(len(log.time), 30.0)}


def recording(path):
    return load_recording({"measured": str(path), "robot": "config/robots/puma560.yaml"})


def chunk(path):
    return next(iter(read_log(path, layout())))


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize(
    ("column", "value"), [("temperature", -300.0), ("position_2", 1e30), ("torque_3", -1e12), ("torque_1", -9999.0)]
)
def test_what_no_arm_can_have_counts_as_missing(tmp_path, table, kind, column, value):
    path = tmp_path / f"log.{kind}"
    table[column][5] = value
    WRITERS[kind](path, table)
    for read in (recording, chunk):
        found = getattr(read(path), column.partition("_")[0])[5]
        place = int(column[-1]) - 1 if column[-1].isdigit() else ...
        assert np.isnan(found[place]).all()
        assert np.isfinite(read(path).position[6]).all()


def test_a_role_without_one_possible_number_is_named(tmp_path, table):
    table["temperature"][:] = -280.0
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match="temperature holds no number that an arm can have"):
        recording(tmp_path / "log.csv")


@pytest.mark.parametrize("kind", WRITERS)
def test_a_column_that_is_there_twice_is_named(tmp_path, table, kind):
    path = tmp_path / f"log.{kind}"
    doubled = [*table, "torque_1"]
    if kind == "csv":
        rows = zip(*(table[name] for name in doubled), strict=True)
        path.write_text("\n".join([",".join(doubled), *(",".join(map(str, row)) for row in rows)]) + "\n")
    else:
        parquet.write_table(pa.Table.from_arrays([pa.array(table[name]) for name in doubled], names=doubled), path)
    for read in (recording, chunk):
        with pytest.raises(InputError, match=r"'torque_1' twice"):
            read(path)


@pytest.mark.parametrize("name", ["torque_٣", "torque_" + "9" * 5000, "torque_3e0"])
def test_only_plain_digits_number_a_column(tmp_path, table, name):
    table[name] = table.pop("torque_3")
    write_csv(tmp_path / "log.csv", table)
    for read in (recording, chunk):
        with pytest.raises(InputError, match="have gaps"):
            read(tmp_path / "log.csv")


@pytest.mark.parametrize("label", [1e300, -1e300, 2.0**31, 0.5])
def test_a_label_of_a_trajectory_is_a_whole_number_that_can_be_stored(tmp_path, table, label):
    table["trajectory"] = np.zeros(len(table["time"]))
    table["trajectory"][3:] = label
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match="whole numbers of at most 2147483647"):
        recording(tmp_path / "log.csv")
    assert chunk(tmp_path / "log.csv").trajectory.max() < 2**31


@pytest.mark.parametrize("factor", [1e-9, 1e6, 1e15])
def test_a_clock_that_no_controller_has_is_refused(tmp_path, table, factor):
    table["time"] = factor * table["time"]
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match=r"from sample to sample .* state its unit, as units: \{time: ms\}"):
        recording(tmp_path / "log.csv")


def test_a_date_beyond_all_clocks_is_refused(tmp_path, table):
    table["time"][100:] += 1e12
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match="the time reaches"):
        recording(tmp_path / "log.csv")


def test_a_joint_without_numbers_is_told(tmp_path, table):
    table["torque_6"] = np.array(["x"] * len(table["time"]), dtype=object)
    WRITERS["parquet"](tmp_path / "log.parquet", table)
    with pytest.raises(InputError, match=r"torque has shape \(200, 5\); 200 samples of 6 joints are expected"):
        recording(tmp_path / "log.parquet")


def test_a_list_names_one_column_for_each_axis(tmp_path, table):
    entry = {"measured": str(tmp_path / "log.csv"), "robot": "config/robots/puma560.yaml"}
    write_csv(tmp_path / "log.csv", table)
    turned = [f"torque_{j}" for j in range(6, 0, -1)]
    found = load_recording({**entry, "variables": {"torque": turned}})
    np.testing.assert_allclose(found.torque[:, 0], table["torque_6"])
    with pytest.raises(InputError, match="has no column 'moment' of numbers for torque"):
        load_recording({**entry, "variables": {"torque": ["moment"] * 6}})
    with pytest.raises(InputError, match=r"torque has shape \(200, 1\)"):
        load_recording({**entry, "variables": {"torque": ["torque_1"]}})
