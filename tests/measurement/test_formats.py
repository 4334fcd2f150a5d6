"""Every format gives the same samples; names, units and order of axes come from the config; memory stays small."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from monitor_logs import START, columns, layout, make_log, write_bag, write_csv, write_netcdf, write_parquet

from jointwear.files.errors import InputError
from jointwear.measurement.formats import layout_of, read_log
from jointwear.measurement.formats.chunk import make_chunk
from jointwear.measurement.units import converted, size_of, spelled


def whole(path, rows=100_000, **entry):
    chunks = list(read_log(path, layout(**entry), rows))
    names = ("time", "position", "velocity", "torque", "temperature", "trajectory")
    found = {}
    for name in names:
        values = [getattr(c, name) for c in chunks]
        found[name] = None if values[0] is None else np.concatenate(values)
    return found, chunks


@pytest.fixture(scope="module")
def log():
    return make_log(6.0)


WRITERS = {
    "log.csv": lambda path, log: write_csv(path, columns(log)),
    "log.parquet": lambda path, log: write_parquet(path, columns(log)),
    "log.nc": write_netcdf,
    "mcap_bag": lambda path, log: write_bag(path, log, "mcap"),
    "sqlite_bag": lambda path, log: write_bag(path, log, "sqlite3"),
}


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_same_samples(tmp_path, log, name):
    path = WRITERS[name](tmp_path / name, log)
    found, chunks = whole(path, rows=100)
    np.testing.assert_allclose(found["time"], log.time, atol=1e-9)
    np.testing.assert_allclose(found["position"], log.position, atol=1e-12)
    np.testing.assert_allclose(found["torque"], log.torque, atol=1e-12)
    assert found["velocity"] is None
    assert not chunks[0].dated
    if not name.endswith("csv"):
        assert len(chunks) >= 3


@pytest.mark.parametrize("size", [1.0, 1e3])
@pytest.mark.parametrize("name", ["log.csv", "log.parquet"])
def test_one_stamp_of_zero_decides_neither_date_nor_unit(tmp_path, log, name, size):
    # Blocks of a hundred rows: one of them begins with it.
    time = size * (START + log.time)
    time[200] = 0.0
    found, chunks = whole(WRITERS[name](tmp_path / name, replace(log, time=time)), rows=100)
    assert all(c.dated for c in chunks)
    np.testing.assert_allclose(np.delete(found["time"], 200), START + np.delete(log.time, 200))
    assert found["time"][200] == 0.0


def test_a_bare_mcap_file_is_a_log(tmp_path, log):
    folder = write_bag(tmp_path / "bag", log, velocity=True)
    found, _ = whole(next(folder.glob("*.mcap")))
    np.testing.assert_allclose(found["velocity"], log.velocity)


def test_joints_of_a_bag_are_ordered_by_name(tmp_path, log):
    folder = write_bag(tmp_path / "bag", log, order=[5, 0, 3, 1, 2, 4])
    np.testing.assert_allclose(whole(folder)[0]["torque"], log.torque)


def test_joints_of_a_bag_take_their_names_from_the_config(tmp_path, log):
    names = [f"arm_{k}" for k in "abcdef"]
    folder = write_bag(tmp_path / "bag", log, names=names)
    with pytest.raises(InputError, match=r"its joints are arm_a.*'joints'"):
        whole(folder)
    np.testing.assert_allclose(whole(folder, joints=names[::-1])[0]["torque"], log.torque[:, ::-1])


def test_a_bag_whose_efforts_pause_is_read_to_its_end(tmp_path, log):
    pause = log.torque.copy()
    pause[80:200] = np.nan
    folder = write_bag(tmp_path / "bag", replace(log, torque=pause))
    for rows in (50, len(log.time)):
        np.testing.assert_array_equal(whole(folder, rows=rows)[0]["torque"], pause)
    with pytest.raises(InputError, match="the messages carry no effort"):
        whole(write_bag(tmp_path / "without", log, effort=False), rows=50)


def test_units_and_names_of_the_config(tmp_path, log):
    table = {"t_ms": 1e3 * log.time}
    table |= {f"actual_q_{j}": np.degrees(log.position[:, j]) for j in range(6)}
    table |= {f"moment {j}": 1e3 * log.torque[:, j] for j in range(6)}
    path = write_csv(tmp_path / "log.csv", table)
    found, _ = whole(
        path,
        variables={"time": "t_ms", "position": "actual_q", "torque": [f"moment {j}" for j in range(6)]},
        units={"time": "ms", "position": "deg", "torque": "mN m"},
    )
    np.testing.assert_allclose(found["time"], log.time)
    np.testing.assert_allclose(found["position"], log.position)
    np.testing.assert_allclose(found["torque"], log.torque)


@pytest.mark.parametrize("stamps", ["zulu", "naive", "offset", "unix"])
def test_dates_in_csv(tmp_path, log, stamps):
    moments = np.array(np.round((START + log.time) * 1e3), dtype="datetime64[ms]")
    if stamps == "offset":
        time = [f"{m}+02:00" for m in (moments + np.timedelta64(2, "h")).astype(str)]
    else:
        time = [m + ("Z" if stamps == "zulu" else "") for m in moments.astype(str)]
    table = columns(log) | {"time": START + log.time if stamps == "unix" else np.array(time)}
    found, chunks = whole(write_csv(tmp_path / "log.csv", table))
    assert chunks[0].dated
    np.testing.assert_allclose(found["time"], START + log.time, atol=1e-3)


def test_dates_in_parquet_and_netcdf(tmp_path, log):
    moments = np.array(np.round((START + log.time) * 1e3), dtype="datetime64[ms]")
    for path in (
        write_parquet(tmp_path / "log.parquet", columns(log) | {"time": moments}),
        write_netcdf(tmp_path / "log.nc", log, units="seconds since 2026-01-01T00:00:00Z"),
    ):
        found, chunks = whole(path)
        assert chunks[0].dated
        np.testing.assert_allclose(found["time"], START + log.time, atol=1e-3)


@pytest.mark.parametrize(
    ("unit", "length"),
    [("nanoseconds", 1e-9), ("Nanoseconds", 1e-9), ("ns", 1e-9), ("microseconds", 1e-6), ("days", 86400.0)],
)
def test_netcdf_counts_from_a_date_in_any_unit_of_time(tmp_path, log, unit, length):
    for moment in ("2026-01-01", "2026-01-01 02:00:00 +02:00"):
        path = tmp_path / f"{len(moment)}.nc"
        write_netcdf(path, replace(log, time=log.time / length), units=f"{unit} since {moment}")
        found, chunks = whole(path)
        assert chunks[0].dated
        np.testing.assert_allclose(found["time"], START + log.time, atol=1e-5)
    write_netcdf(path, log, units="fathoms since 2026-01-01")
    with pytest.raises(InputError, match="'fathoms since 2026-01-01' of time is not known"):
        whole(path)


def test_semicolons_and_decimal_commas(tmp_path, log):
    path = write_csv(tmp_path / "log.csv", columns(log))
    text = path.read_text().replace(",", ";").replace(".", ",")
    path.write_text(text)
    np.testing.assert_allclose(whole(path)[0]["torque"], log.torque)


def test_missing_values_become_nan(tmp_path, log):
    table = {k: v.copy().astype(object) for k, v in columns(log).items()}
    table["torque_2"][::3] = ""
    table["torque_3"][5] = "NaN"
    found, _ = whole(write_csv(tmp_path / "log.csv", table))
    assert np.isnan(found["torque"][::3, 1]).all()
    assert np.isnan(found["torque"][5, 2])
    assert np.isfinite(found["torque"][:, 3]).all()


def test_temperature_of_the_arm_and_labels(tmp_path, log):
    label = np.repeat([4, 7, 9], len(log.time) // 3)
    table = columns(log) | {"temperature": np.linspace(20, 30, len(log.time)), "trajectory": label}
    found, _ = whole(write_parquet(tmp_path / "log.parquet", table))
    assert found["temperature"].shape == log.torque.shape
    assert found["trajectory"].tolist() == label.tolist()


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("Nmm", 1e-3),
        ("N·mm", 1e-3),
        ("mNm", 1e-3),
        ("Ncm", 1e-2),
        ("N·cm", 1e-2),
        ("kgf cm", 0.0980665),
        ("ft-lbf", 1.3558179483),
        ("lbf in", 0.112984829),
    ],
)
def test_units_of_torque_by_other_names(unit, factor):
    np.testing.assert_allclose(converted(np.ones(1), "torque", unit, "log"), factor)


@pytest.mark.parametrize(
    ("role", "unit", "factor"),
    [
        ("position", "mrad", 1e-3),
        ("position", "mdeg", np.pi / 180e3),
        ("position", "gon", np.pi / 200),
        ("velocity", "mrad/s", 1e-3),
        ("velocity", "deg s^-1", np.pi / 180),
        ("acceleration", "deg/s²", np.pi / 180),
        ("torque", "cNm", 1e-2),
        ("torque", "µNm", 1e-6),
        ("torque", "MN m", 1e6),
        ("torque", "daN m", 10.0),
        ("torque", "1e-3 N m", 1e-3),
        ("torque", "kg m2 s-2", 1.0),
        ("torque", "kg*m^2/s^2", 1.0),
        ("torque", "oz-in", 0.0070615518),
        ("torque", "ozf in", 0.0070615518),
        ("time", "0.1 s", 0.1),
    ],
)
def test_units_that_are_products_of_units_with_prefixes(role, unit, factor):
    np.testing.assert_allclose(converted(np.ones(1), role, unit, "log"), factor)
    np.testing.assert_allclose(size_of(role, spelled(role, unit)), factor)


@pytest.mark.parametrize(
    ("role", "unit"),
    [
        ("position", "mRad"),
        ("position", "milliradian"),
        ("velocity", "rad/s^2"),
        ("torque", "1e-3Nm"),
        ("torque", "uA"),
        ("torque", "Nm/A"),
        ("temperature", "0.1 degC"),
    ],
)
def test_no_unit_is_suggested_that_differs_by_a_factor(role, unit):
    with pytest.raises(InputError, match=r"is not known \(allowed"):
        converted(np.ones(1), role, unit, "log")


def test_the_german_word_for_a_degree_asks():
    with pytest.raises(InputError, match="write 'deg' for degrees, 'gon' for hundredths of a right angle"):
        converted(np.ones(1), "position", "grad", "log")


@pytest.mark.parametrize(
    ("unit", "factor"), [("rpm", np.pi / 30), ("1/min", np.pi / 30), ("rev/s", 2 * np.pi), ("deg/s", np.pi / 180)]
)
def test_units_of_velocity(unit, factor):
    np.testing.assert_allclose(converted(np.ones(1), "velocity", unit, "log"), factor)


def test_a_log_of_an_arm_with_more_joints_names_the_robot():
    layout = layout_of({}, ("shoulder", "elbow"))
    values = {"time": np.arange(5.0), "position": np.zeros((5, 6)), "torque": np.zeros((5, 6))}
    with pytest.raises(InputError, match=r"day\.nc: position is of 6 joints, .*'robot' names has 2: .*shoulder, elbow"):
        make_chunk(Path("day.nc"), values, layout, {}, dated=False)
