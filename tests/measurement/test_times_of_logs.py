"""Times of a log in many spellings, with zones and without: read, or told with what to write."""

import re

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from written_logs import HEADER, one, write

from jointwear.files.errors import InputError
from jointwear.measurement.formats import layout_of, read_log

BEFORE = "or name the column of the date before that of the time, as variables: {time: [date, time]}"


@pytest.mark.parametrize(
    ("stamp", "entry"),
    [
        ("2026-01-15 06:00:00,250", {}),
        ("15.01.2026 06:00:00.250", {}),
        ("2026/01/15 06:00:00.250", {}),
        ("20260115T060000,250", {}),
        ("2026-01-15T07:00:00.250+01:00", {}),
        ("2026-01-15 07:00:00.250", {"time_zone": "Europe/Berlin"}),
        ("1768456800250", {}),
        ("1768456800250000000", {}),
    ],
)
def test_times_in_many_spellings(tmp_path, stamp, entry):
    lines = [";".join(HEADER), f"{stamp};0.1;1.0", f"{stamp};0.2;1.0"]
    chunk = one(write(tmp_path / "a.csv", lines), **entry)
    assert chunk.dated
    assert chunk.time[0] == pytest.approx(1768456800.25, abs=1e-3)


@pytest.mark.parametrize(
    ("stamp", "words"),
    [
        ("15/01/2026 06:00:00", "; write all times of the log as ISO 8601, this one as '2026-01-15T06:00:00'"),
        ("1/15/26 6:00:00.5 PM", "this one as '2026-01-15T18:00:00.5'"),
        ("15.01.26 06:00:00", "this one as '2026-01-15T06:00:00'"),
        (
            "01/02/2026 06:00:00",
            "this one as '2026-02-01T06:00:00' (day first) or '2026-01-02T06:00:00' (month first)",
        ),
        (
            "26-01-15 06:00:00",
            "this one as '2015-01-26T06:00:00' (day first) or '2026-01-15T06:00:00' (year first)",
        ),
        ("06:00:00", "the day is lacking: write '2026-01-15T06:00:00', or seconds, " + BEFORE),
        ("6:00:00,5", "the day is lacking: write '2026-01-15T06:00:00.5', or seconds, " + BEFORE),
        ("15 Jan 2026 06:00:00", "nor dd.mm.yyyy hh:mm:ss"),
        ("31/02/2026 06:00:00", "nor dd.mm.yyyy hh:mm:ss"),
    ],
)
def test_what_to_write_for_a_time_in_another_spelling(tmp_path, stamp, words):
    lines = [";".join(HEADER), f"{stamp};0.1;1.0", f"{stamp};0.2;1.0"]
    with pytest.raises(InputError, match=re.escape(words) + "$"):
        one(write(tmp_path / "a.csv", lines))


def test_days_as_a_spreadsheet_counts_them(tmp_path):
    """The key that was advised for them dated the logs 70 years ahead."""
    days = 46037.25 + np.arange(50) * 0.02 / 86400
    path = write(tmp_path / "a.csv", [";".join(HEADER), *(f"{t:.10f};0.1;1.0" for t in days)])
    with pytest.raises(InputError, match=r"units: \{time: d\}"):
        one(path)
    chunk = one(path, units={"time": "d"}, time_zone="Europe/Berlin")
    assert chunk.dated
    assert np.allclose(chunk.time - (1768456800 - 3600), 0.02 * np.arange(50), atol=1e-4)
    # Days of a clock of its own, and days since 1970, are none.
    for begin, dated in ((3.0, False), (20468.25, True)):
        path = write(tmp_path / "b.csv", [";".join(HEADER), *(f"{t:.10f};0.1;1.0" for t in days - days[0] + begin)])
        chunk = one(path, units={"time": "d"})
        assert chunk.dated is dated
        assert chunk.time[0] == pytest.approx(begin * 86400)


@pytest.mark.parametrize("rows", [4, 8, 50, 1000])
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_the_hour_that_comes_twice_where_summer_time_ends(tmp_path, suffix, rows):
    begin = np.datetime64("2026-10-24T23:30:00", "s").astype(np.int64)
    utc = begin + 60.0 * np.arange(240)
    local = (utc + np.where(utc < begin + 5400, 7200, 3600)).astype("datetime64[s]")
    numbers = np.arange(240.0)
    path = tmp_path / f"a.{suffix}"
    if suffix == "csv":
        write(path, [";".join(HEADER), *(f"{t};{x};{x}" for t, x in zip(local, numbers, strict=True))])
    else:
        parquet.write_table(pa.table({"time": pa.array(local), HEADER[1]: numbers, HEADER[2]: numbers}), path)
    entry = {"time_zone": "Europe/Berlin"}
    chunks = list(read_log(path, layout_of(entry, ["a"]), rows))
    assert np.array_equal(np.concatenate([c.time for c in chunks]), utc)
    # The second time alone is the first: nothing tells.
    late = write(tmp_path / "late.csv", [";".join(HEADER), *(f"{t};0.1;1.0" for t in local[90:160])])
    assert one(late, **entry).time[0] == utc[90] - 3600


def test_times_with_a_zone_and_without_are_told_with_the_row(tmp_path):
    times = ["2026-01-15 06:00:00Z", "2026-01-15 06:00:01Z", "2026-01-15 06:00:02"]
    path = write(tmp_path / "a.csv", [";".join(HEADER), *(f"{time};0.1;1.0" for time in times)])
    with pytest.raises(InputError, match=r"with a zone and without are mixed: '2026-01-15 06:00:02' of row 4 names no"):
        one(path)


def test_nanoseconds_in_parquet(tmp_path):
    columns = {"time": pa.array([1768456800250000001, 1768456800270000003]), "position_1": [0.1, 0.2]}
    parquet.write_table(pa.table({**columns, "torque_1": [1.0, 2.0]}), tmp_path / "a.parquet")
    for entry in ({}, {"units": {"time": "ns"}}):
        chunk = one(tmp_path / "a.parquet", **entry)
        assert chunk.dated
        assert chunk.time.tolist() == pytest.approx([1768456800.25, 1768456800.27], abs=1e-6)


@pytest.mark.parametrize(
    "kind", [pa.string(), pa.large_string(), pa.string_view(), pa.dictionary(pa.int32(), pa.string())]
)
def test_times_as_text_of_any_type_in_parquet(tmp_path, kind):
    """Writers differ in the type that they take for texts."""
    times = pa.array(["2026-01-15T09:00:00.25Z", "2026-01-15T09:00:00.27Z"]).cast(kind)
    columns = {"time": times, "position_1": [0.1, 0.2], "torque_1": [1.0, 2.0]}
    parquet.write_table(pa.table(columns), tmp_path / "a.parquet")
    chunk = one(tmp_path / "a.parquet")
    assert chunk.dated
    assert chunk.time.tolist() == pytest.approx([1768467600.25, 1768467600.27], abs=1e-6)
