"""Stamps by the clock on the wall where summer time begins and ends."""

import numpy as np
import pyarrow as pa
import pytest

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


def test_hours_on_end_that_do_not_exist_have_no_time_and_the_words_say_which_zone_to_state():
    """A logger that stays on winter time, or in UTC, under a key that says otherwise."""
    stamps = np.datetime64("2026-03-29T01:30:00", "s") + 60 * np.arange(120)
    local = LocalStamps("Europe/Berlin")
    found = local.seconds(pa.array(stamps))
    assert np.flatnonzero(np.isnan(found)).tolist() == list(range(30, 90))
    assert local.none_such[0] == 60
    assert local.none_such[1].startswith("the time 2026-03-29 02:00:00 does not exist in Europe/Berlin")
    assert "'Etc/GMT-1' where it keeps winter time, 'UTC' where it keeps that" in local.none_such[1]
    # What is known of the log stays known, what is told was of the stamps before.
    assert np.isnan(local.seconds(pa.array(stamps[30:31])))
    local.seconds(pa.array(stamps[90:]))
    assert local.none_such == (0, "")


@pytest.mark.parametrize(
    ("zone", "stamp", "words"),
    [
        ("America/New_York", "2026-03-08T02:10:00", "'Etc/GMT+5' where it keeps winter time, 'UTC'"),
        ("Europe/London", "2026-03-29T01:10:00", "state 'time_zone' as 'UTC' where"),
        ("Australia/Adelaide", "2026-10-04T02:10:00", "state 'time_zone' as 'UTC' where"),
    ],
)
def test_the_zone_to_state_is_one_that_exists(zone, stamp, words):
    local = LocalStamps(zone)
    local.seconds(pa.array(np.datetime64(stamp, "s") + np.arange(100)))
    assert words in local.none_such[1]


def test_seconds_of_the_clock_on_the_wall_are_those_of_stamps():
    stamps = np.datetime64("2026-10-25T01:59:00", "ms") + 1000 * np.arange(3600)
    again = np.concatenate([stamps, stamps + np.timedelta64(60_000)])
    shown = again.astype(np.int64) / 1000 + 1e-4
    expected = LocalStamps("Europe/Berlin").seconds(pa.array(again))
    np.testing.assert_allclose(LocalStamps("Europe/Berlin").of_wall_clock(shown), expected + 1e-4, rtol=0, atol=1e-6)
    odd = np.array([np.nan, 1e300, -1e11, shown[0]])
    found = LocalStamps("Europe/Berlin").of_wall_clock(odd)
    assert np.isnan(found[0])
    assert found[1:].tolist() == [1e300, -1e11, shown[0] - 7200]
    np.testing.assert_array_equal(LocalStamps().of_wall_clock(odd), odd)
