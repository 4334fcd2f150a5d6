"""Numbers that no arm can have, and tables that say two things: refused or missing, in logs and in recordings alike."""

import netCDF4
import numpy as np
import pyarrow as pa
import pytest
from monitor_logs import columns, layout, make_log, write_csv
from pyarrow import parquet

from jointwear.files.errors import InputError
from jointwear.measurement.checks.checks import check_recording
from jointwear.measurement.formats import read_log
from jointwear.measurement.possible import check_clock, without_sentinels
from jointwear.measurement.recording_files import load_recording
from jointwear.robots.robot import load_robot

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


def heavy(table):
    """Make the second torque one of some thousand newton metres; return the row at which it passes -999."""
    row = int(np.argmin(np.abs(table["torque_2"] - np.median(table["torque_2"]))))
    table["torque_2"] = 40.0 * table["torque_2"]
    table["torque_2"] += -999.0 - table["torque_2"][row]
    return row


def test_a_mark_for_a_missing_value_that_lies_among_its_neighbours_is_a_value(tmp_path, table):
    row = heavy(table)
    table["torque_2"][row] = -999.0
    write_csv(tmp_path / "log.csv", table)
    for read in (recording, chunk):
        assert read(tmp_path / "log.csv").torque[row, 1] == -999.0
    rows = slice(row - 3, row + 3)
    table["torque_2"][rows] = -999.0
    table["torque_2"][[20, 40]] = -9999.0
    write_csv(tmp_path / "log.csv", table)
    for read in (recording, chunk):
        found = read(tmp_path / "log.csv")
        assert np.flatnonzero(np.isnan(found.torque[:, 1])).tolist() == sorted([20, 40, *range(row - 3, row + 3)])
        assert found.missing == {"torque": (-9999.0, -999.0)}


@pytest.mark.parametrize("mark", [32767.0, 65535.0])
def test_the_largest_number_of_16_bits_is_a_mark_where_it_stands_alone(tmp_path, table, mark):
    table["torque_2"][[20, 40]] = mark
    write_csv(tmp_path / "log.csv", table)
    for read in (recording, chunk):
        found = read(tmp_path / "log.csv")
        assert np.flatnonzero(np.isnan(found.torque[:, 1])).tolist() == [20, 40]
        assert found.missing == {"torque": (mark,)}


def test_the_largest_number_of_16_bits_is_a_value_where_others_lie_beside_or_beyond_it():
    time = np.arange(400)
    # A torque in counts that is cut off there, one that goes on, and a mark beside a count that goes through it.
    cut = np.minimum(60000 * np.sin(0.02 * time), 32767.0).round()
    beyond = (90000 * np.sin(0.02 * time)).round()
    beyond[[10, 60]] = 32767.0
    for values in (cut, beyond):
        assert without_sentinels(values) == (pytest.approx(values), ())


def test_what_was_read_as_missing_is_told(tmp_path):
    data = load_recording({"measured": "data/examples/puma560_hidden.nc"}, "arm")
    table = {"time": data.time, "trajectory": data.trajectory}
    table |= {f"position_{j + 1}": q for j, q in enumerate(data.position.T)}
    table |= {f"torque_{j + 1}": q.copy() for j, q in enumerate(data.torque.T)}
    table["torque_6"][7] = -999.0
    write_csv(tmp_path / "log.csv", table)
    told = check_recording(recording(tmp_path / "log.csv"), load_robot("config/robots/puma560.yaml"))
    assert (
        told[0]
        == "0.05 % of the samples are missing or not finite (read as missing: -999 of the torque) and were left out"
    )


@pytest.mark.parametrize("empty", [np.nan, -999.0, 1e12])
def test_a_role_without_one_possible_number_is_left_out_and_told(tmp_path, table, empty):
    """The monitor took such a log, and discovery refused it."""
    table["temperature"] = np.full(len(table["time"]), empty)
    for joint in range(1, 7):
        table[f"velocity_{joint}"] = np.full(len(table["time"]), empty)
    write_csv(tmp_path / "log.csv", table)
    found = recording(tmp_path / "log.csv")
    assert (found.velocity, found.temperature, found.missing) == (None, None, {})
    assert found.unread == (
        "the velocity holds no number that an arm can have and was left out; "
        "the temperature holds no number that an arm can have and was left out"
    )


@pytest.mark.parametrize("role", ["position", "torque"])
def test_a_position_or_torque_without_one_possible_number_is_named(tmp_path, table, role):
    for joint in range(1, 7):
        table[f"{role}_{joint}"] = np.full(len(table["time"]), np.nan)
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match=f"{role} holds no number that an arm can have"):
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


@pytest.mark.parametrize(
    ("label", "said"),
    [(1e300, "1e.300"), (-1e300, "-1e.300"), (2.0**31, "2147483648"), (0.5, "0.5"), (np.nan, "no number")],
)
def test_a_label_of_a_trajectory_is_a_whole_number_that_can_be_stored(tmp_path, table, label, said):
    table["trajectory"] = np.zeros(len(table["time"]))
    table["trajectory"][3:] = label
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match=f"whole numbers of at most 2147483647; sample 4 holds {said}$"):
        recording(tmp_path / "log.csv")
    assert chunk(tmp_path / "log.csv").trajectory.max() < 2**31


@pytest.mark.parametrize("factor", [1e-9, 1e6, 1e15])
def test_a_clock_that_no_controller_has_is_refused(tmp_path, table, factor):
    table["time"] = factor * table["time"]
    write_csv(tmp_path / "log.csv", table)
    for read in (recording, chunk):
        with pytest.raises(InputError, match=r"from sample to sample .* state its unit, as units: \{time: [mun]s\}"):
            read(tmp_path / "log.csv")


def test_a_date_beyond_all_clocks_is_refused(tmp_path, table):
    table["time"][100:] += 1e12
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match="the time reaches"):
        recording(tmp_path / "log.csv")


def test_a_joint_without_numbers_is_told(tmp_path, table):
    table["torque_6"] = np.array(["x"] * len(table["time"]), dtype=object)
    WRITERS["parquet"](tmp_path / "log.parquet", table)
    with pytest.raises(InputError, match="column 'torque_6' holds string, not numbers"):
        recording(tmp_path / "log.parquet")


def test_a_list_names_one_column_for_each_axis(tmp_path, table):
    entry = {"measured": str(tmp_path / "log.csv"), "robot": "config/robots/puma560.yaml"}
    write_csv(tmp_path / "log.csv", table)
    turned = [f"torque_{j}" for j in range(6, 0, -1)]
    found = load_recording({**entry, "variables": {"torque": turned}})
    np.testing.assert_allclose(found.torque[:, 0], table["torque_6"])
    with pytest.raises(InputError, match="has no column 'moment' for torque"):
        load_recording({**entry, "variables": {"torque": ["moment"] * 6}})
    # The nearest name is that of another joint; the one that nobody has asked for is meant.
    table["moment_6"] = table.pop("torque_6")
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match="no column 'torque_6' for torque; did you mean 'moment_6'"):
        load_recording({**entry, "variables": {"torque": turned}})
    table["torque_6"] = table.pop("moment_6")
    write_csv(tmp_path / "log.csv", table)
    with pytest.raises(InputError, match="has 1 column of torque, the position has 6 joints"):
        load_recording({**entry, "variables": {"torque": ["torque_1"]}})


def packed_log(path, change=lambda data: None, kind="f8"):
    """Write a log as netCDF through its own library, and change it."""
    log = make_log(4.0)
    path.unlink(missing_ok=True)
    with netCDF4.Dataset(path, "w") as data:
        data.createDimension("time", len(log.time))
        data.createDimension("joint", 6)
        data.createVariable("time", "f8", ("time",))[:] = log.time
        data["time"].units = "s"
        data.createVariable("position", "f8", ("time", "joint"))[:] = log.position
        torque = data.createVariable("torque", kind, ("time", "joint"), fill_value=-32768 if kind == "i2" else None)
        if kind == "i2":
            torque.scale_factor, torque.add_offset = 0.01, 5.0
            stored = np.rint((log.torque - 5.0) / 0.01)
            stored[3, 2] = -32768
            torque.set_auto_scale(False)
            torque[:] = stored
        else:
            torque[:] = log.torque
        change(data)
    return path


@pytest.mark.parametrize("read", [recording, chunk])
def test_a_packed_number_that_is_marked_as_missing_is_missing(tmp_path, read):
    found = read(packed_log(tmp_path / "log.nc", kind="i2")).torque
    assert np.argwhere(np.isnan(found)).tolist() == [[3, 2]]


@pytest.mark.parametrize("read", [recording, chunk])
@pytest.mark.parametrize(
    ("attribute", "value", "words"),
    [
        ("missing_value", "none", "'missing_value' is"),
        ("scale_factor", np.array([1.0, 2.0]), "'scale_factor' is"),
        ("add_offset", np.inf, "'add_offset' is"),
    ],
)
def test_an_attribute_that_packs_or_marks_must_be_a_number(tmp_path, read, attribute, value, words):
    def change(data):
        data["torque"].setncattr(attribute, value)

    with pytest.raises(InputError, match=words):
        read(packed_log(tmp_path / "log.nc", change))


@pytest.mark.parametrize("read", [recording, chunk])
def test_several_marks_are_all_missing(tmp_path, read):
    def change(data):
        data["torque"][4, 1], data["torque"][5, 1] = 77.0, 88.0
        data["torque"].setncattr("missing_value", np.array([77.0, 88.0]))

    assert np.isnan(read(packed_log(tmp_path / "log.nc", change)).torque[[4, 5], 1]).all()


@pytest.mark.parametrize(("unit", "step"), [("min", 1.2), ("milliseconds", 2e-5), ("us", 2e-8)])
def test_the_unit_of_time_counts_in_recordings_and_logs(tmp_path, unit, step):
    def change(data):
        data["time"].units = unit

    path = packed_log(tmp_path / "log.nc", change)
    for read in (recording, chunk):
        if step < 1e-6:
            with pytest.raises(InputError, match="the time rises by"):
                read(path)
        else:
            assert np.diff(read(path).time[:2])[0] == pytest.approx(step)


def test_the_unit_of_time_counts_before_a_date_too(tmp_path):
    def change(data):
        data["time"].units = "minutes since 2026-01-01"

    assert np.diff(recording(packed_log(tmp_path / "log.nc", change)).time[:2])[0] == pytest.approx(1.2)


@pytest.mark.parametrize("read", [recording, chunk])
def test_an_unknown_unit_of_time_is_refused(tmp_path, read):
    def change(data):
        data["time"].units = "fortnights"

    with pytest.raises(InputError, match="'fortnights' of time is not known"):
        read(packed_log(tmp_path / "log.nc", change))


def test_a_calendar_that_no_controller_keeps_is_refused(tmp_path):
    def change(data):
        data["time"].units, data["time"].calendar = "seconds since 2026-01-01", "360_day"

    with pytest.raises(InputError, match="calendar of time is '360_day'"):
        chunk(packed_log(tmp_path / "log.nc", change))


@pytest.mark.parametrize("attribute", ["jointwear_checksum", "result"])
def test_an_attribute_of_ours_with_several_numbers_is_one_line(tmp_path, attribute):
    (tmp_path / "results").mkdir()

    def change(data):
        data.setncattr(attribute, np.array([1, 2]))

    with pytest.raises(InputError, match=r"log\.nc: (was changed|holds the result)"):
        chunk(packed_log(tmp_path / "results/log.nc", change))


@pytest.mark.parametrize(("step", "unit"), [(0.02e3, "ms"), (0.02e6, "us"), (0.02e9, "ns"), (3e3, "us")])
def test_a_clock_in_another_unit_is_told_with_the_unit_that_fits(step, unit):
    with pytest.raises(InputError, match=rf"units: {{time: {unit}}}"):
        check_clock("a.csv", 1.8e9 / 0.02 * step + step * np.arange(5))


def test_rows_in_no_order_are_told_and_not_taken_for_another_unit():
    time = np.random.default_rng(1).permutation(5000) * 0.1
    with pytest.raises(
        InputError, match=r"a\.csv: \d+% of its rows have an earlier .* out of order; sort them by time"
    ):
        check_clock("a.csv", time[:1000])
    # Of trajectories whose times begin anew few steps go back, and a wrong unit stays one.
    with pytest.raises(InputError, match="state its unit"):
        check_clock("a.csv", np.tile(1e5 * np.arange(50), 4))


def test_days_of_a_spreadsheet_are_told():
    with pytest.raises(InputError, match=r"units: {time: d}"):
        check_clock("a.csv", 46000.25 + 0.008 / 86400 * np.arange(5))
