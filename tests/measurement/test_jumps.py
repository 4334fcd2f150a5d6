"""Positions that jump away and back, or off a value that they kept, are none of the arm; what an arm does is left
alone, and rows that do not follow each other are refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.measurement.checks.lasting_jumps import check_rows_follow
from jointwear.measurement.derived.jumps import jumps, jumps_in_words, jumps_of, without_jumps, without_jumps_of
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.formats.chunk import Chunk
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import Refused

RATE = 100.0


def moves(seconds=20.0, rate=RATE):
    time = np.arange(0, seconds, 1 / rate)
    position = np.stack([1.2 * np.sin(time), 0.8 * np.cos(1.7 * time) + 1.0, 0.02 * np.sin(2 * time)], axis=1)
    return Recording(time, np.zeros(len(time), int), position, np.zeros_like(position))


def found(recording):
    return jumps(recording.time, recording.trajectory, recording.position)


@pytest.mark.parametrize("length", [1, 2, 10, 30])
def test_a_row_of_zeros_is_lost_for_every_joint(length):
    recording = moves()
    position = recording.position.copy()
    position[500 : 500 + length] = 0.0
    away = found(replace(recording, position=position))
    assert away[500 : 500 + length].all()
    assert away.sum() == 3 * length


def test_rows_that_follow_each_other_are_told_apart():
    recording = moves()
    position = recording.position.copy()
    position[500:510], position[530:540] = 0.0, 0.0
    assert list(np.flatnonzero(found(replace(recording, position=position))[:, 0])) == [
        *range(500, 510),
        *range(530, 540),
    ]


def test_one_joint_that_jumps_is_left_out_alone():
    recording = moves()
    position = recording.position.copy()
    position[700, 1] += 0.3
    spoilt = replace(recording, position=position, velocity=np.zeros_like(position))
    mended = without_jumps(spoilt, jumps_of(spoilt))
    assert np.isnan(mended.position[700, 1])
    assert np.isnan(mended.velocity[700, 1])
    assert np.isfinite(mended.position).sum() == position.size - 1
    told = (
        "positions of joint 2 jump away and back or off a value that they kept, first at sample 701: 1 sample left out"
    )
    assert jumps_in_words(jumps_of(spoilt)) == [told]


def test_a_position_that_stays_away_is_left_alone_and_refused_with_its_sample():
    recording = moves()
    position = recording.position.copy()
    position[700:, 1] += 0.3
    spoilt = replace(recording, position=position)
    assert not found(spoilt).any()
    with pytest.raises(Refused, match=r"position of joint 2 jumps by 0.3\d* rad at sample 701 \(7 s\)"):
        check_rows_follow(spoilt)
    check_rows_follow(recording)
    # Nobody knows whether what lies beside an end would have come back.
    check_rows_follow(replace(recording, position=np.roll(position, -1250, axis=0)[: len(position) - 1250]))
    position[700:, 1] -= 0.3
    position[1950:, 1] += 0.3
    late = replace(recording, position=position)
    check_rows_follow(late)
    assert list(np.flatnonzero(found(late)[:, 1])) == list(range(1950, 2000))


@pytest.mark.parametrize("order", ["lost", "exchanged", "labelled"])
def test_rows_that_do_not_follow_each_other_are_refused_and_labels_are_believed(order):
    recording = moves()
    rows = np.arange(len(recording.time))
    rows = np.delete(rows, slice(600, 700)) if order != "exchanged" else np.r_[:600, 800:1000, 600:800, 1000:2000]
    label = recording.trajectory[: len(rows)] + (order == "labelled") * (np.arange(len(rows)) >= 600)
    spoilt = Recording(recording.time[: len(rows)], label, recording.position[rows], recording.torque[rows])
    if order == "labelled":
        check_rows_follow(spoilt)
        return
    with pytest.raises(Refused, match=r"at sample 601 .* rows were lost or put in another order") as refused:
        check_rows_follow(spoilt)
    assert "label of its own" in refused.value.suggestion


@pytest.mark.parametrize("length", [50, 300])
def test_a_position_that_stops_while_its_joint_goes_on_is_left_out_with_all_rows_but_the_first(length):
    recording = moves()
    position = recording.position.copy()
    position[600 : 600 + length, 0] = position[600, 0]
    spoilt = replace(recording, position=position)
    assert list(np.flatnonzero(found(spoilt)[:, 0])) == list(range(601, 600 + length))
    assert found(spoilt).sum() == length - 1
    check_rows_follow(spoilt)
    samples = Chunk(spoilt.time, spoilt.position, spoilt.torque)
    kept = without_jumps_of(samples, spoilt.trajectory)
    assert np.isnan(kept.position).sum() == length - 1
    assert without_jumps_of(replace(samples, position=recording.position), spoilt.trajectory).position is (
        recording.position
    )


def test_a_row_of_zeros_of_any_length_and_a_joint_that_stands_still_are_told_apart():
    recording = moves()
    position = recording.position.copy()
    position[700:1100, 1] = 0.0
    assert list(np.flatnonzero(found(replace(recording, position=position))[:, 1])) == list(range(700, 1100))
    # A joint that rests and goes on from there.
    still = np.concatenate([position[:700], np.repeat(position[699:700], 400, axis=0), position[700:701]])
    rests = Recording(np.arange(len(still)) / RATE, np.zeros(len(still), int), still, np.zeros_like(still))
    assert not found(rests)[:, 0].any()


@given(st.integers(0, 2**32 - 1), st.sampled_from([20.0, 50.0, 125.0, 500.0]), st.integers(12, 20))
def test_what_an_arm_can_do_is_left_alone(seed, rate, bits):
    random = np.random.default_rng(seed)
    time = np.arange(0, 10.0, 1 / rate)
    # Moves from stop to stop, at up to 10 rad/s and 100 rad/s2, read by an encoder.
    speed = np.zeros(len(time))
    for begin in np.arange(0.0, 10.0, 1.0):
        top, rise = random.uniform(-10, 10), random.uniform(0.1, 0.3)
        speed += top * np.clip(np.minimum(time - begin, begin + 0.8 - time) / rise, 0, 1)
    position = np.cumsum(speed)[:, None] / rate
    position = np.round(position * 2**bits / (2 * np.pi)) * (2 * np.pi) / 2**bits
    assert not jumps(time, np.zeros(len(time), int), position).any()


def test_one_row_of_zeros_does_not_hide_the_motion():
    recording = moves()
    position = recording.position.copy()
    position[500] = 0.0
    floors = [measure(r).speed_floor for r in (recording, replace(recording, position=position))]
    assert np.all(floors[1] < 2.0 * floors[0])
