"""Logs that cannot be read, whole or in part, end in one clear line or in flagged windows, never in a traceback."""

import gzip
import os

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from monitor_logs import START, columns, layout, make_log, read, write_bag, write_csv, write_netcdf, write_parquet

from jointwear.files.errors import InputError
from jointwear.files.storage import Variable, write_dataset
from jointwear.measurement.formats import read_log

FILES = {
    "empty.csv": (lambda p: p.write_text(""), "is empty"),
    "header.csv": (lambda p: p.write_text(",".join(columns(make_log(1.0))) + "\n"), "holds no samples"),
    "numbers.csv": (lambda p: p.write_text("1,2,3\n4,5,6\n"), "header line"),
    "words.csv": (
        lambda p: write_csv(p, columns(make_log(1.0)) | {"torque_2": np.full(50, "=cmd()")}),
        "cannot be read as CSV",
    ),
    "ragged.csv": (
        lambda p: p.write_text(write_csv(p, columns(make_log(1.0))).read_text() + "1,2,3\n" * 11),
        "row 52 has 3 cells",
    ),
    "torn.csv": (lambda p: p.write_text(",".join(columns(make_log(1.0))) + "\n1,2,3\n"), "row 2 has 3 cells"),
    "utf16.csv": (lambda p: p.write_text("time,position_1\n", encoding="utf-16"), "UTF-16; save it as UTF-8"),
    "book.csv": (lambda p: p.write_bytes(b"PK\x03\x04" + bytes(90)), "a workbook of a spreadsheet or a zip file"),
    "packed.csv": (lambda p: p.write_bytes(gzip.compress(b"time,position_1\n")), "packed by gzip; unpack it"),
    "page.csv": (lambda p: p.write_text("\n<!DOCTYPE html><html><p>Sign in</p></html>\n"), "is a web page, not CSV"),
    "page.nc": (lambda p: p.write_text("<!DOCTYPE html>\n<html></html>\n"), "is a web page, not netCDF"),
    "page.parquet": (lambda p: p.write_text("<html><p>Sign in</p></html>\n"), "is a web page, not Parquet"),
    "pointer.csv": (lambda p: p.write_text("version https://git-lfs.github.com/spec/v1\nsize 1\n"), "git lfs pull"),
    "netcdf.csv": (lambda p: p.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(90)), "is netCDF, not CSV; let its name end"),
    "classic.parquet": (lambda p: p.write_bytes(b"CDF\x01" + bytes(90)), "is netCDF, not Parquet"),
    "parquet.nc": (lambda p: write_parquet(p, columns(make_log(1.0))), r"is Parquet, not netCDF; .* with \.parquet"),
    "json.csv": (lambda p: p.write_text('{"time": 0.0, "position_1": 1.5}\n' * 50), "holds JSON, not CSV"),
    "list.csv": (lambda p: p.write_text('[{"time": 0.0, "position_1": 1.5}]'), "holds JSON, not CSV"),
    "still.csv": (
        lambda p: write_csv(p, columns(make_log(1.0)) | {"time": np.full(50, START)}),
        "1 sample whose time goes on, in 50 rows",
    ),
    "date.csv": (lambda p: write_csv(p, columns(make_log(1.0)) | {"time": np.full(50, "yesterday")}), "ISO 8601"),
    "binary.csv": (lambda p: p.write_bytes(bytes(range(256)) * 20), "UTF-8"),
    "empty.parquet": (lambda p: p.write_bytes(b""), "not a Parquet file"),
    "text.parquet": (lambda p: p.write_text("time,position_1\n" * 50), "not a Parquet file"),
    "cut.parquet": (
        lambda p: p.write_bytes(write_parquet(p, columns(make_log(2.0))).read_bytes()[:-600]),
        "truncated or not a Parquet file",
    ),
    "empty.nc": (lambda p: p.write_bytes(b""), "netCDF"),
    "cut.nc": (lambda p: p.write_bytes(write_netcdf(p, make_log(9.0)).read_bytes()[:9000]), r"cut\.nc"),
    "empty.mcap": (lambda p: p.write_bytes(b""), "is empty"),
    "noise.mcap": (lambda p: p.write_bytes(os.urandom(5000)), "not a ROS 2 bag"),
    "noise.db3": (lambda p: p.write_bytes(b"SQLite format 3\0" + bytes(500)), "ROS 2 bag|damaged"),
    "few.csv": (lambda p: write_csv(p, {k: v for k, v in columns(make_log(1.0)).items() if k != "torque_6"}), "5 col"),
    "gap.csv": (lambda p: write_csv(p, {k: v for k, v in columns(make_log(1.0)).items() if k != "torque_3"}), "gaps"),
    "none.csv": (
        lambda p: write_csv(p, {k: v for k, v in columns(make_log(1.0)).items() if "torq" not in k}),
        "torque",
    ),
    "slow.csv": (lambda p: write_csv(p, columns(make_log(300.0, rate=2.0))), "log velocity and acceleration"),
    "twice.csv": (lambda p: p.write_text("time,time\n1,2\n"), "twice"),
    "words.parquet": (
        lambda p: write_parquet(p, columns(make_log(1.0)) | {"position_1": np.full(50, "x")}),
        "'position_1' holds string",
    ),
}


@pytest.mark.parametrize(("name", "column"), [("few.csv", "torque_6"), ("gap.csv", "torque_3")])
def test_a_column_that_is_missing_is_named_with_what_to_do(tmp_path, name, column):
    FILES[name][0](tmp_path / name)
    with pytest.raises(InputError, match=f"'{column}' is missing; log '{column}', or write it as an empty column"):
        read(tmp_path / name)


@pytest.mark.parametrize(
    ("also", "told"),
    [
        (("trq_act_3",), "rename the column 'trq_act_3', which nothing reads, to 'torque_3' in this log if it is"),
        (("line_speed", "trq_act_3 [N m]"), "rename the column 'trq_act_3 .N m.', which"),
        (("drive",), "rename the column 'drive', which"),
        (("drive", "line_speed"), "is missing; log 'torque_3'"),
        (("trq_act_4",), "is missing; log 'torque_3'"),
    ],
)
def test_a_column_that_got_another_name_is_told_where_one_is_likely(tmp_path, also, told):
    there = {k: v for k, v in columns(make_log(1.0)).items() if k != "torque_3"}
    path = write_csv(tmp_path / "log.csv", there | {name: np.ones(50) for name in also})
    with pytest.raises(InputError, match=told) as refused:
        read(path)
    assert ("'variables'" in str(refused.value)) == ("rename" in told)


@pytest.mark.parametrize("name", FILES)
def test_what_cannot_be_read_ends_in_one_line(tmp_path, good, name):
    make, words = FILES[name]
    path = tmp_path / name
    make(path)
    with pytest.raises(InputError, match=words) as error:
        read(path)
    assert "\n" not in str(error.value)
    assert name in str(error.value)
    if name not in ("slow.csv", "still.csv"):
        later = read(path, good)
        assert len(later.refused) == 1
        assert name in later.refused[0]


def test_a_torn_row_of_the_first_log_costs_itself(tmp_path):
    path = write_csv(tmp_path / "log.csv", columns(make_log(48.0)))
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:1000], "# restarted", *lines[1000:]]) + "\n")
    found = read(path)
    (words,) = found.refused
    assert "log.csv: row 1001 has 1 cell" in words
    assert len(found.statistics.count) == 4
    assert found.statistics.judgeable[:, :5].all()


def test_nobody_is_told_to_delete_a_log(tmp_path):
    path = tmp_path / "log.nc"
    path.write_bytes(write_netcdf(path, make_log(9.0)).read_bytes()[:9000])
    with pytest.raises(InputError, match=r"truncated or not a netCDF file \(NetCDF: [A-Z a-z]+\)$"):
        read(path)


def test_one_cell_that_cannot_be_read_costs_no_window(tmp_path, good):
    table = {name: list(values) for name, values in columns(make_log(48.0)).items()}
    table["position_1"][1000] = "?"
    found = read(write_csv(tmp_path / "log.csv", table), good)
    (words,) = found.refused
    assert "log.csv: row 1002 has '?' in column 'position_1'" in words
    assert len(found.statistics.count) == 4
    assert found.statistics.judgeable[:, :5].all()


def test_cells_that_cannot_be_read_for_long_end_the_log_with_row_and_column(tmp_path, good):
    table = {name: list(values) for name, values in columns(make_log(48.0)).items()}
    table["torque_2"][500:] = ["?"] * (len(table["time"]) - 500)
    (words,) = read(write_csv(tmp_path / "log.csv", table), good).refused
    assert "row 502 has '?' in column 'torque_2', which is not a number" in words


def test_a_bag_without_effort_says_so(tmp_path):
    with pytest.raises(InputError, match="carry no effort"):
        read(write_bag(tmp_path / "bag", make_log(2.0), effort=False))


def test_a_bag_without_joint_states_says_what_it_has(tmp_path):
    folder = write_bag(tmp_path / "bag", make_log(2.0))
    with pytest.raises(InputError, match=r"topic '/joint_stats'; did you mean '/joint_states'"):
        read(folder, topic="/joint_stats")


def test_a_cut_bag_ends_in_one_line(tmp_path):
    file = next(write_bag(tmp_path / "bag", make_log(20.0)).glob("*.mcap"))
    file.write_bytes(file.read_bytes()[:-3000])
    with pytest.raises(InputError, match=r"\.mcap: is (truncated|damaged)"):
        read(file)


def test_unknown_roles_and_units_are_named(tmp_path, good):
    with pytest.raises(InputError, match=r"'variables' has the role 'torqe'; did you mean 'torque'"):
        read(good, variables={"torqe": "x"})
    with pytest.raises(InputError, match=r"unit 'degre' of position is not known; did you mean 'deg'"):
        read(good, units={"position": "degre"})


def test_dates_and_no_dates_do_not_mix(tmp_path, good):
    found = read(write_parquet(tmp_path / "log.parquet", columns(make_log(24.0, start=START))), good)
    assert "cannot be put in order" in found.refused[0]
    assert found.statistics.windows == 0


def outcome(path, first):
    """Statistics, or the line that says why there are none."""
    try:
        return read(path, first)
    except InputError as error:
        return str(error)


def ends_well(path, good):
    """A log ends in an InputError of one line, or in statistics without nonsense."""
    for first in (None, good):
        found = outcome(path, first)
        if isinstance(found, str):
            assert "\n" not in found
            continue
        statistics = found.statistics
        for name in ("gram", "moment", "square", "residual_square", "score", "lag_square", "travel"):
            assert np.isfinite(getattr(statistics, name)).all(), name
        assert (statistics.square >= 0).all()
        assert (statistics.count <= statistics.samples[:, None]).all()
        assert all("\n" not in line for line in found.refused)


FUZZ = settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(scope="module")
def whole_files(tmp_path_factory):
    """Content of one log in every format, the same for every example."""
    folder, log = tmp_path_factory.mktemp("whole"), make_log(10.0)
    paths = [
        write_csv(folder / "x.csv", columns(log)),
        write_parquet(folder / "x.parquet", columns(log)),
        write_netcdf(folder / "x.nc", log),
        next(write_bag(folder / "bag", log).glob("*.mcap")),
    ]
    return {f"x{path.suffix}": path.read_bytes() for path in paths}


@FUZZ
@given(data=st.data(), name=st.sampled_from(["x.csv", "x.parquet", "x.nc", "x.mcap"]))
def test_flipped_bytes(tmp_path, good, whole_files, data, name):
    path = tmp_path / name
    content = bytearray(whole_files[name])
    for _ in range(data.draw(st.integers(1, 12))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    ends_well(path, good)


@FUZZ
@given(data=st.data())
def test_mangled_columns(tmp_path, good, data):
    table = columns(make_log(20.0), "position", "torque", "velocity")
    wild = st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 0.0, 1e-300])
    for name in data.draw(st.lists(st.sampled_from(list(table)), max_size=5)):
        values = table[name].copy()
        how = data.draw(st.sampled_from(["all", "some", "scale", "shuffle", "reverse"]))
        if how == "all":
            values[:] = data.draw(wild)
        elif how == "some":
            start = data.draw(st.integers(0, len(values) - 1))
            values[start : start + data.draw(st.integers(1, 400))] = data.draw(wild)
        elif how == "scale":
            with np.errstate(all="ignore"):
                values *= data.draw(st.sampled_from([-1.0, 57.3, 1e6, 1e-6, 0.0]))
        elif how == "shuffle":
            np.random.default_rng(0).shuffle(values)
        else:
            values = values[::-1].copy()
        table[name] = values
    with np.errstate(all="ignore"):
        ends_well(write_parquet(tmp_path / "mangled.parquet", table), good)


def test_a_variable_whose_dimensions_are_the_other_way_round_is_named(tmp_path):
    log = make_log(2.0)
    variables = {"time": Variable(("time",), log.time, "time", "s")}
    for role in ("position", "torque"):
        variables[role] = Variable(("joint", "time"), getattr(log, role).T, role)
    write_dataset(tmp_path / "turned.nc", variables, {})
    with pytest.raises(InputError, match=r"'position' has the dimensions \(joint, time\): write \(time, joint\), as"):
        list(read_log(tmp_path / "turned.nc", layout()))
