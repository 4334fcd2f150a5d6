"""Times that name no zone are of the `time_zone` of the robot in every format, where summer time begins or ends too."""

import netCDF4
import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from jointwear.files.errors import InputError
from jointwear.measurement.formats import layout_of, read_log
from jointwear.measurement.formats.chunk import RowsLeftOut

BERLIN = {"time_zone": "Europe/Berlin"}
MARCH, BEGIN, END = "2026-03-25T12:00:00", "2026-03-29T01:30:00", "2026-10-25T02:30:00"


def utc(stamp):
    return np.datetime64(stamp, "ms").astype(np.int64) / 1000


def read(path, rows=100_000, **entry):
    """The times of a log of one joint, and what is said at its end."""
    times, told = [], ""
    try:
        for chunk in read_log(path, layout_of(entry, ["a"]), rows):
            assert chunk.dated
            assert len(chunk.position) == len(chunk.time) == len(chunk.torque)
            times.append(chunk.time)
    except RowsLeftOut as error:
        told = str(error)
    return np.concatenate(times), told


def netcdf(path, values, units):
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", len(values))
        file.createDimension("joint", 1)
        time = file.createVariable("time", "f8", ("time",))
        time[:], time.units = values, units
        for name in ("position", "torque"):
            file.createVariable(name, "f8", ("time", "joint"))[:] = np.arange(len(values), dtype=float)[:, None]
    return path


def log(folder, kind, stamps):
    """A log whose times are what the clock on the wall shows, as pandas and xarray write them."""
    path, numbers = folder / f"a.{kind}", np.arange(len(stamps), dtype=float)
    if kind == "csv":
        rows = [f"{t},{x},{x}" for t, x in zip(stamps, numbers, strict=True)]
        path.write_text("\n".join(["time,position_1,torque_1", *rows]))
    elif kind == "parquet":
        parquet.write_table(pa.table({"time": pa.array(stamps), "position_1": numbers, "torque_1": numbers}), path)
    else:
        elapsed = (stamps - stamps[0]).astype(np.int64) / 1000
        netcdf(path, elapsed, f"seconds since {str(stamps[0]).replace('T', ' ')}")
    return path


@pytest.mark.parametrize("kind", ["csv", "parquet", "nc"])
def test_every_format_gives_times_in_the_zone_of_the_robot(tmp_path, kind):
    stamps = np.datetime64(MARCH, "ms") + 100 * np.arange(50)
    path = log(tmp_path, kind, stamps)
    np.testing.assert_allclose(read(path, **BERLIN)[0], utc(MARCH) - 3600 + 0.1 * np.arange(50), atol=1e-6)
    np.testing.assert_allclose(read(path)[0], utc(MARCH) + 0.1 * np.arange(50), atol=1e-6)


@pytest.mark.parametrize("kind", ["csv", "parquet", "nc"])
def test_every_format_follows_the_clock_on_the_wall_through_the_hour_that_comes_twice(tmp_path, kind):
    first = np.datetime64("2026-10-25T02:00:00", "ms") + 1000 * np.arange(3600)
    stamps = np.concatenate([first, first, first + np.timedelta64(3_600_000)])
    found, told = read(log(tmp_path, kind, stamps), rows=1000, **BERLIN)
    np.testing.assert_allclose(found, utc("2026-10-25T00:00:00") + np.arange(10_800.0), atol=1e-6)
    assert told == ""


@pytest.mark.parametrize("rows", [500, 100_000])
@pytest.mark.parametrize("origin", ["2026-10-25 01:30:00", "2026-10-01"])
def test_seconds_of_netcdf_that_go_on_through_the_hour_that_comes_twice_are_no_hour_late(tmp_path, rows, origin):
    """They had followed the clock on the wall, of which nothing falls back, and came an hour late from then on."""
    begin = utc("2026-10-24T23:30:00")
    first = begin - (utc(origin.replace(" ", "T")) - 7200)
    path = netcdf(tmp_path / "a.nc", first + np.arange(9000.0), f"seconds since {origin}")
    found, told = read(path, rows=rows, **BERLIN)
    np.testing.assert_allclose(found, begin + np.arange(9000.0), atol=1e-6)
    assert told == ""


def test_a_clock_on_the_wall_of_netcdf_may_pause_through_the_hour_that_comes_twice(tmp_path):
    """From 02:10 in summer time to 02:40 in winter time, as at the end of a shift: nothing goes on evenly."""
    stamps = np.datetime64("2026-10-25T01:30:00", "ms") + 1000 * np.arange(2400)
    stamps = np.concatenate([stamps, np.datetime64("2026-10-25T02:40:00", "ms") + 1000 * np.arange(3600)])
    found, _ = read(log(tmp_path, "nc", stamps), **BERLIN)
    assert found[0] == utc("2026-10-24T23:30:00")
    assert found[-1] == utc("2026-10-25T02:39:59")


def test_seconds_of_netcdf_that_go_on_through_the_hour_that_does_not_exist_are_told_with_both_mends(tmp_path):
    """A clock that is not turned and seconds that go on show the same there, and other logs ask for other mends."""
    values = np.arange(7200.0)
    _, told = read(netcdf(tmp_path / "a.nc", values, f"seconds since {BEGIN.replace('T', ' ')}"), **BERLIN)
    assert "'Etc/GMT-1' where it keeps winter time" in told
    assert told.endswith(", or an offset behind the date of the unit of time where its numbers are seconds that go on")
    mended = netcdf(tmp_path / "b.nc", values, f"seconds since {BEGIN.replace('T', ' ')} +01:00")
    found, told = read(mended, **BERLIN)
    np.testing.assert_allclose(found, utc(BEGIN) - 3600 + values, atol=1e-6)
    assert told == ""


@pytest.mark.parametrize("kind", ["csv", "parquet", "nc"])
@pytest.mark.parametrize("rows", [500, 100_000])
def test_a_logger_that_does_not_turn_its_clock_is_told_once_with_the_zone_to_state(tmp_path, kind, rows):
    stamps = np.datetime64(BEGIN, "ms") + 1000 * np.arange(7200)
    path = log(tmp_path, kind, stamps)
    found, told = read(path, rows=rows, **BERLIN)
    assert len(found) == 3600
    assert np.isfinite(found).all()
    assert told.startswith(f"{path}: 3600 rows left out: the time 2026-03-29 02:00:00 does not exist in Europe/Berlin")
    assert "'Etc/GMT-1' where it keeps winter time" in told
    found, told = read(path, rows=rows, time_zone="Etc/GMT-1")
    np.testing.assert_allclose(found, utc(BEGIN) - 3600 + np.arange(7200.0), atol=1e-6)
    assert told == ""


@pytest.mark.parametrize("kind", ["csv", "parquet", "nc"])
def test_a_single_stamp_that_does_not_exist_stops_nothing(tmp_path, kind):
    """One rounded up to the moment at which summer time begins."""
    stamps = np.datetime64(BEGIN, "ms") + 1000 * np.arange(1801)
    stamps = np.concatenate([stamps, stamps[-1:] + np.timedelta64(3_601_000)])
    found, told = read(log(tmp_path, kind, stamps), **BERLIN)
    np.testing.assert_allclose(found, utc(BEGIN) - 3600 + np.arange(1802.0), atol=1e-6)
    assert told == ""


def test_a_log_of_that_hour_alone_says_why_it_holds_nothing(tmp_path):
    path = log(tmp_path, "csv", np.datetime64("2026-03-29T02:10:00", "ms") + 1000 * np.arange(100))
    with pytest.raises(InputError, match="100 rows left out: the time 2026-03-29 02:10:00 does not exist") as refused:
        list(read_log(path, layout_of(BERLIN, ["a"])))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("units", "begin"),
    [
        ("seconds since 2026-03-25 12:00:00", "2026-03-25T11:00:00"),
        ("seconds since 2026-03-25", "2026-03-24T23:00:00"),
        ("milliseconds since 2026-03-25T12:00:00.500", "2026-03-25T11:00:00.500"),
        ("seconds since 2026-03-25 12:00:00 +02:00", "2026-03-25T10:00:00"),
        ("seconds since 2026-03-25 12:00:00-0430", "2026-03-25T16:30:00"),
        ("seconds since 2026-03-25 12:00 -1:00", "2026-03-25T13:00:00"),
        ("seconds since 2026-03-25 +1", "2026-03-24T23:00:00"),
        ("seconds since 2026-03-25T12:00:00Z", "2026-03-25T12:00:00"),
        ("seconds since 2026-03-25 12:00:00 UTC", "2026-03-25T12:00:00"),
        ("seconds since 2026-03-25 12:00:00 gmt", "2026-03-25T12:00:00"),
        # Unix time is UTC, as a number in CSV.
        ("seconds since 1970-01-01", "1970-01-01T00:00:00"),
        ("seconds since 1970-01-01 00:00:00", "1970-01-01T00:00:00"),
    ],
)
def test_the_zone_that_units_of_netcdf_name_goes_before_that_of_the_robot(tmp_path, units, begin):
    step = 1.0 if units.startswith("seconds") else 1000.0
    found, _ = read(netcdf(tmp_path / "a.nc", step * np.arange(5), units), **BERLIN)
    np.testing.assert_allclose(found, utc(begin) + np.arange(5.0), atol=1e-6)


def test_seconds_without_a_date_are_no_times_of_a_zone(tmp_path):
    path = netcdf(tmp_path / "a.nc", np.arange(5.0), "s")
    (chunk,) = read_log(path, layout_of(BERLIN, ["a"]))
    assert not chunk.dated
    assert chunk.time.tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("zone", ["CET", "Europe/Berlin", "+01:00:00", "noon"])
def test_a_zone_in_units_of_netcdf_that_is_not_known_is_refused(tmp_path, zone):
    path = netcdf(tmp_path / "a.nc", np.arange(5.0), f"seconds since 2026-03-25 12:00:00 {zone}")
    with pytest.raises(InputError, match=r"no zone \(allowed: Z, UTC, GMT, an offset as \+01:00, or none\)"):
        read(path, **BERLIN)
