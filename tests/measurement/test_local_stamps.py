"""Stamps by the clock on the wall where summer time begins and ends."""

import numpy as np
import pyarrow as pa

from jointwear.measurement.formats.local_stamps import LocalStamps


def utc(stamp):
    return np.datetime64(stamp, "ms").astype(np.int64) / 1000


def test_an_hour_that_does_not_exist_is_the_moment_at_which_summer_time_begins():
    stamps = np.array(["2026-03-29T01:59:59", "2026-03-29T02:30:00", "2026-03-29T03:00:01"], dtype="datetime64[ms]")
    found = LocalStamps("Europe/Berlin").seconds(pa.array(stamps))
    assert found.tolist() == [utc("2026-03-29T00:59:59"), utc("2026-03-29T01:00:00"), utc("2026-03-29T01:00:01")]


def test_an_hour_that_comes_twice_is_the_first_one_until_the_stamps_fall_back():
    first = np.datetime64("2026-10-25T02:00:00", "ms") + 1000 * np.arange(3000)
    found = LocalStamps("Europe/Berlin").seconds(pa.array(np.concatenate([first, first])))
    assert found[0] == utc("2026-10-25T00:00:00")
    assert found[3000] == utc("2026-10-25T01:00:00")
    assert np.all(np.diff(found) > 0)
