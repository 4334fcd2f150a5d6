"""Order in time: repeated, late, missing and restarted stamps."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from monitor_logs import START

from jointwear.files.errors import InputError
from jointwear.measurement.clock import Clock, join
from jointwear.measurement.flags import Flag
from jointwear.measurement.formats.chunk import Chunk, joined


def chunk(time, dated=False, trajectory=None, first=0):
    time = np.asarray(time, dtype=float)
    rows = first + np.arange(len(time), dtype=float)[:, None] * np.ones((1, 2))
    label = None if trajectory is None else np.asarray(trajectory)
    return Chunk(time=time, position=rows, torque=rows, trajectory=label, dated=dated)


def order(time, length=10.0, sizes=None, **how):
    clock, found, start = Clock(length), [], 0
    for size in sizes or [len(time)]:
        label = how.get("trajectory")
        part = None if label is None else label[start : start + size]
        found.append(clock.order(chunk(time[start : start + size], how.get("dated", False), part, start)))
        start += size
    return (
        np.concatenate([f.chunk.time for f in found]),
        np.concatenate([f.stretch for f in found]),
        np.concatenate([f.flags for f in found]),
    )


def test_time_in_order_stays_as_it_is():
    time = np.arange(100) * 0.1
    found, stretch, flags = order(time)
    np.testing.assert_array_equal(found, time)
    assert not stretch.any()
    assert not flags.any()


def test_repeated_and_missing_stamps_are_left_out_and_told():
    time = np.array([0, 0.1, 0.1, 0.2, np.nan, 0.4, 0.5])
    found, stretch, flags = order(time)
    np.testing.assert_allclose(found, [0, 0.1, 0.2, 0.4, 0.5])
    assert flags[2] & Flag.DUPLICATE_STAMPS
    assert flags[3] & Flag.NOT_FINITE
    assert not stretch.any()


def test_a_late_sample_is_left_out():
    time = np.r_[np.arange(50), 20.5, np.arange(50, 100)] * 0.1
    found, stretch, flags = order(time)
    np.testing.assert_allclose(found, np.arange(100) * 0.1)
    assert np.flatnonzero(flags).tolist() == [50]
    assert not stretch.any()


@pytest.mark.parametrize("many", [1, 3])
@pytest.mark.parametrize("dated", [False, True])
@pytest.mark.parametrize("jump", [60.0, 3600.0, 2e9])
def test_a_stamp_ahead_of_all_that_follow_is_left_out(jump, dated, many):
    time = np.arange(100) * 0.1 + START * dated
    astray = np.r_[time[:50], time[50] + jump + np.arange(many), time[50:]]
    found, stretch, flags = order(astray, dated=dated)
    np.testing.assert_array_equal(found, time)
    assert not stretch.any()
    assert np.flatnonzero(flags).tolist() == [50]
    assert flags[50] == Flag.DUPLICATE_STAMPS


def test_more_stamps_ahead_are_a_clock_that_was_set_back():
    time = START + np.arange(100) * 0.1
    found, _, flags = order(np.r_[time[:50], time[50:54] + 3600, time[50:]], dated=True)
    assert len(found) == 104
    assert flags[54] & Flag.CLOCK_RESET


@pytest.mark.parametrize("many", [1, 3])
@pytest.mark.parametrize("sizes", [None, [60, 40]])
def test_first_stamps_of_a_clock_that_was_not_set_yet_are_left_out(many, sizes):
    time = START + np.arange(100) * 0.1
    time[:many] = np.arange(many)
    found, stretch, flags = order(time, sizes=sizes, dated=True)
    np.testing.assert_array_equal(found, time[many:])
    assert not stretch.any()
    assert np.flatnonzero(flags).tolist() == [0]


@pytest.mark.parametrize("sizes", [None, [97, 3], [99, 1], [60, 40]])
def test_last_stamps_far_after_the_log_are_left_out(sizes):
    time = START + np.arange(100) * 0.1
    found, _, _ = order(np.r_[time[:97], time[97:] + 2e9], sizes=sizes, dated=True)
    np.testing.assert_array_equal(found, time[:97])


@pytest.mark.parametrize("sizes", [None, [52, 48]])
def test_a_stamp_astray_at_the_end_of_a_chunk_sets_no_clock_back(sizes):
    time = START + np.arange(100) * 0.1
    time[51] = 2e9
    found, stretch, flags = order(time, sizes=sizes, dated=True)
    np.testing.assert_array_equal(found, np.delete(time, 51))
    assert not np.any(flags & Flag.CLOCK_RESET)
    assert not stretch.any()


def test_a_pause_of_days_is_no_stamp_astray():
    day = np.arange(50) * 0.1
    time = START + np.r_[day, day + 3 * 86400, day[:4] + 9 * 86400]
    found, _, _ = order(time, dated=True)
    np.testing.assert_array_equal(found, time)


@pytest.mark.parametrize("sizes", [[120], [55, 65], [50, 70]])
@pytest.mark.parametrize("dated", [False, True])
def test_a_block_that_is_written_twice_sets_no_clock_back(sizes, dated):
    time = np.arange(100) * 0.1
    written = np.r_[0:50, 30:50, 50:100]
    clock, found = Clock(10.0), []
    for a, b in itertools.pairwise(np.cumsum([0, *sizes])):
        rows = written[a:b, None] * np.ones((1, 2))
        found.append(clock.order(Chunk(time=time[written[a:b]], position=rows, torque=rows, dated=dated)))
    np.testing.assert_allclose(np.concatenate([f.chunk.time for f in found]), time)
    flags = np.concatenate([f.flags for f in found])
    assert np.any(flags & Flag.DUPLICATE_STAMPS)
    assert not np.any(flags & Flag.CLOCK_RESET)
    assert not np.concatenate([f.stretch for f in found]).any()


def test_the_same_stamps_with_other_values_are_a_clock_set_back():
    time = np.r_[np.arange(50), np.arange(30, 80)] * 0.1
    _, _, flags = order(time, dated=True)
    assert np.any(flags & Flag.CLOCK_RESET)


def test_a_gap_begins_a_stretch_and_is_told_within_a_window():
    found, stretch, flags = order(np.r_[np.arange(20) * 0.1, 5 + np.arange(20) * 0.1, 20 + np.arange(20) * 0.1])
    assert len(found) == 60
    assert np.flatnonzero(np.diff(stretch)).tolist() == [19, 39]
    assert np.flatnonzero(flags).tolist() == [20]


@pytest.mark.parametrize("sizes", [None, [50, 50], [49, 51], [60, 40]])
def test_a_clock_that_starts_anew_goes_on(sizes):
    time = np.r_[np.arange(50), np.arange(50)] * 0.1
    found, stretch, flags = order(time, sizes=sizes)
    assert (np.diff(found) > 0).all()
    np.testing.assert_allclose(found[50:], 5.0 + time[50:])
    assert stretch[49] != stretch[50]
    assert flags[50] & Flag.CLOCK_RESET
    assert not flags[51:].any()


def test_a_clock_with_a_date_that_is_set_back_is_believed():
    time = START + np.r_[np.arange(50), 10 + np.arange(50)] * 0.1
    found, stretch, flags = order(time, dated=True)
    np.testing.assert_allclose(found, time)
    assert stretch[49] != stretch[50]
    assert flags[50] & Flag.CLOCK_RESET


def test_a_trajectory_begins_a_window():
    time = np.r_[np.arange(50), np.arange(50), 30 + np.arange(50)] * 0.1
    found, stretch, flags = order(time, trajectory=np.repeat([0, 1, 5], 50))
    np.testing.assert_allclose(found[[0, 50, 100]], [0, 10, 20])
    assert len(np.unique(stretch)) == 3
    assert not flags.any()


@pytest.mark.parametrize(
    ("time", "words"),
    [
        ([np.nan, np.nan, np.nan, 1.0], "not finite"),
        ([1e15, 1e15 + 1], "state its unit"),
        (np.tile([5, 4, 3, 2, 1, 0.5], 60).astype(float), "again and again"),
    ],
)
def test_what_is_no_time_is_refused(time, words):
    with pytest.raises(InputError, match=words):
        order(np.asarray(time))


@settings(max_examples=200, deadline=None)
@given(
    steps=st.lists(st.floats(-3, 3) | st.just(0.0) | st.just(float("nan")), min_size=2, max_size=60),
    cut=st.integers(0, 60),
    dated=st.booleans(),
)
def test_whatever_the_stamps_time_rises_within_a_stretch(steps, cut, dated):
    time = np.cumsum(np.nan_to_num(steps)) + (START if dated else 0.0)
    time[np.isnan(steps)] = np.nan
    sizes = [s for s in (min(cut, len(time)), len(time) - min(cut, len(time))) if s]
    try:
        found, stretch, flags = order(time, sizes=sizes, dated=dated)
    except InputError:
        return
    assert np.isfinite(found).all()
    same = np.diff(stretch) == 0
    assert (np.diff(found)[same] > 0).all()
    assert (np.diff(stretch) >= 0).all()
    if not dated:
        assert (np.diff(found) > 0).all()
    if len(found) < len(time) and len(found) and len(sizes) == 1:
        assert flags.any()


def test_a_role_that_some_chunks_lack_is_filled_for_a_stream_and_left_out_of_a_recording():
    def chunk(start, **more):
        time = start + np.arange(3) * 0.1
        return Chunk(time, np.zeros((3, 2)), np.zeros((3, 2)), missing={"torque": (start,)}, **more)

    parts = [chunk(0.0, velocity=np.ones((3, 2)), temperature=np.full(3, 20.0)), chunk(0.3)]
    clock = Clock(3600.0, "log")
    stream = join([clock.order(part) for part in parts]).chunk
    assert np.isnan(stream.velocity[3:]).all()
    assert stream.velocity[:3].tolist() == np.ones((3, 2)).tolist()
    assert np.isfinite(stream.temperature).tolist() == [True] * 3 + [False] * 3
    whole = joined(parts)
    assert whole.velocity is None
    assert whole.temperature is None
    assert whole.missing == {"torque": (0.0, 0.3)}
    assert len(whole.time) == 6


@pytest.mark.parametrize(("missing", "gap"), [(3, False), (5, True)])
def test_a_step_longer_than_five_usual_ones_is_a_gap(missing, gap):
    time = np.concatenate([np.arange(20), np.arange(20 + missing, 40)]) * 0.1
    _, stretch, flags = order(time)
    assert (stretch[-1] > stretch[0]) == gap
    assert bool(flags[20] & Flag.GAP) == gap
