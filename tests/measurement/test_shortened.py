"""Long data sets are read in part, spread over the whole of them, and say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.measurement.recording import Recording, split
from jointwear.measurement.shortened import SHORTEST, shortened

RATE = 100.0


def recording_of(sizes, rate=RATE, **roles):
    label = np.repeat(np.arange(len(sizes)), sizes)
    time = np.arange(len(label)) / rate
    values = np.stack([np.arange(len(label), dtype=float)] * 2, axis=1)
    return split(Recording(time=time, trajectory=label, position=values, torque=-values, temperature=time, **roles))


def test_what_fits_is_read_as_it_is():
    recording = recording_of([3000] * 5)
    read, told = shortened(recording, most=15_000)
    assert read is recording
    assert told == []


def test_a_high_rate_counts_as_what_is_left_of_it():
    # 1 kHz is reduced to 100 Hz.
    assert shortened(recording_of([30_000] * 5, rate=1000.0), most=15_000)[1] == []
    assert shortened(recording_of([30_000] * 5, rate=1000.0), most=14_999)[1] != []


@settings(max_examples=60, deadline=None)
@given(
    sizes=st.lists(st.integers(200, 20_000), min_size=2, max_size=30),
    most=st.integers(2_000, 40_000),
    keep_all=st.booleans(),
)
def test_the_middles_of_trajectories_fill_what_is_read(sizes, most, keep_all):
    recording = recording_of(sizes)
    read, told = shortened(recording, keep_all, most)
    if not told:
        assert sum(sizes) <= most
        return
    # What was read lies in one piece in the middle of each trajectory, with all that belongs to it.
    assert len(read.time) <= most
    assert set(read.train) <= set(recording.train)
    assert set(read.test) <= set(recording.test)
    assert read.train
    assert read.test
    assert sorted(read.labels) == sorted(read.train + read.test)
    if keep_all:
        assert read.labels == recording.labels
    start = np.concatenate([[0], np.cumsum(sizes)])
    for label in read.labels:
        kept = read.position[read.trajectory == label, 0]
        assert np.all(np.diff(kept) == 1)
        before, after = kept[0] - start[label], start[label + 1] - 1 - kept[-1]
        assert 0 <= after - before <= 1
        if not keep_all:
            role = recording.test if label in recording.test else recording.train
            usual = np.mean(np.minimum([sizes[k] for k in role], SHORTEST * RATE))
            assert len(kept) >= min(sizes[label], usual, 0.2 * most) - 2
    assert np.array_equal(read.torque, -read.position)
    assert np.array_equal(read.temperature, read.time)


def test_test_and_training_give_each_other_the_room_that_they_do_not_need():
    read, _ = shortened(recording_of([30_000, 30_000, 1000], test=(2,)), most=20_000)
    assert [int(np.sum(read.trajectory == k)) for k in range(3)] == [9500, 9500, 1000]
    read, _ = shortened(recording_of([1000, 1000, 60_000], test=(2,)), most=20_000)
    assert [int(np.sum(read.trajectory == k)) for k in range(3)] == [1000, 1000, 18_000]


def test_many_trajectories_are_left_out_before_they_become_short():
    read, told = shortened(recording_of([3000] * 100), most=20_000)
    # 20 s each: eight of the eighty to learn from, and two of the others.
    assert len(read.train) == 8
    assert read.train[0] == 0
    assert read.train[-1] == 79
    assert len(read.test) == 2
    words = "of 3000 s of motion 200 s are read, which is as much as a search takes in"
    assert told == [f"{words}: 10 of 100 trajectories, of all of them the middle"]


def test_an_hour_of_one_recording_is_read_in_five_pieces_of_it():
    recording = split(
        Recording(
            time=np.arange(360_000) / RATE,
            trajectory=np.zeros(360_000, dtype=int),
            position=np.zeros((360_000, 2)),
            torque=np.zeros((360_000, 2)),
        )
    )
    read, told = shortened(recording)
    assert [int(np.sum(read.trajectory == k)) for k in read.labels] == [9600] * 5
    assert read.time[read.trajectory == 4].min() > 3000.0
    assert "3600 s" in told[0]


@pytest.mark.parametrize("step", [0.0, np.nan])
def test_a_clock_that_stands_still_is_left_to_the_checks(step):
    recording = recording_of([3000, 3000])
    stopped = replace(recording, time=np.full(6000, step))
    assert shortened(stopped, most=1000) == (stopped, [])
