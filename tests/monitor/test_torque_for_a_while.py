"""A torque that was not measured for a while, zero or another value, is left out and told; no limit of a drive is."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import LENGTH, columns, flagged, make_log, read, write_parquet

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.read_findings import reading_findings
from jointwear.monitor.reading.logs_of_windows import LogsOfWindows
from jointwear.monitor.reading.standing_torque import mostly, silent


def kept(log, seconds, value, axes=slice(None)):
    """The log with torques that keep one value for a while in each window, None the one that they had."""
    within = np.mod(log.time, LENGTH)
    begin = np.flatnonzero(np.diff((within >= 3.0).astype(int)) > 0) + 1
    torque = log.torque.copy()
    for row in begin:
        rows = slice(row, row + round(seconds / np.median(np.diff(log.time))))
        torque[rows, axes] = log.torque[row, axes] if value is None else value
    return replace(log, torque=torque)


@pytest.mark.parametrize(("seconds", "value", "axes"), [(2.0, 0.0, slice(None)), (2.0, None, 1), (0.4, 0.0, [1, 2])])
def test_what_was_not_measured_is_left_out_in_words(tmp_path, good, seconds, value, axes):
    log = make_log(48.0, seed=7)
    usual = read(write_parquet(tmp_path / "usual.parquet", columns(log)), good).statistics
    assert not flagged(read(tmp_path / "usual.parquet", good), Flag.SILENT)
    found = read(write_parquet(tmp_path / "kept.parquet", columns(kept(log, seconds, value, axes))), good)
    own = np.zeros(6, bool)
    own[axes] = True
    own[5] = False  # which does not move
    s = found.statistics
    assert found.refused == ()
    assert ((s.flags & int(Flag.SILENT) != 0).all(axis=0) == own).all()
    assert not (s.flags & int(Flag.SATURATED | Flag.CONTRADICTED | Flag.TORQUE_FROZEN)).any()
    assert (s.count[:, own] < usual.count[:, own]).all()
    noise, before = (np.sqrt(x.noise_variance[:, :5]) for x in (s, usual))
    assert noise == pytest.approx(before, rel=0.4)
    told = [f for f in reading_findings(s) if f["kind"] in ("silent", "saturated")]
    assert [f["kind"] for f in told] == ["silent"]
    assert "keeps one value for a while in motion, as one that was not measured" in told[0]["words"]


def test_a_coarse_torque_and_one_that_never_changes_are_others():
    time = np.arange(0, 40, 0.02)
    position = np.stack([np.sin(time), np.cos(time)], axis=1)
    moves, stretch = np.ones(position.shape, bool), np.zeros(len(time), int)
    torque = np.stack([np.round(1.4 * np.sin(time)), np.full(len(time), 3.0)], axis=1)
    assert not silent(torque, position, moves, stretch, 0.02).any()
    slow = np.round(40 * np.sin(0.2 * time) + np.cos(9 * time))[:, None] + 0 * position
    assert not silent(slow, position, moves, stretch, 0.02).any()
    clipped = np.minimum(5.0 * np.cos(time), 4.0)[:, None] + 0 * position
    assert not silent(clipped, position, moves, stretch, 0.02).any()
    clipped[500:700] = 0.0
    assert np.flatnonzero(silent(clipped, position, moves, stretch, 0.02)[:, 0]).tolist() == list(range(500, 700))
    # A minute lies between the samples of some logs.
    assert not silent(clipped, position, moves, stretch, 60.0).any()


def test_a_window_in_which_most_of_it_is_missing_is_none():
    found = np.array([[True], [True], [False], [True], [False], [False]])
    whole = mostly(found, np.ones((6, 1), bool), np.arange(6.0), 3.0)
    assert whole[:, 0].tolist() == [True, True, True, False, False, False]


def test_half_a_shift_of_one_torque_is_told_with_its_log_and_is_no_rest(tmp_path, good):
    """It was called at rest, and nothing else was said: it did not fill the shift."""
    log = make_log(96.0, seed=7)
    half = len(log.time) // 2
    torque = np.r_[log.torque[:half], np.repeat(log.torque[half][None], len(log.time) - half, axis=0)]
    path = write_parquet(tmp_path / "day.parquet", columns(replace(log, torque=torque)))
    s = read(path, good).statistics
    late = s.start >= s.start[0] + 48.0
    assert (s.flags[late, :5] & int(Flag.TORQUE_FROZEN) != 0).all()
    assert not (s.flags[:, :5] & int(Flag.AT_REST)).any()
    assert not (s.flags[~late] & int(Flag.TORQUE_FROZEN)).any()
    logs = LogsOfWindows(("day.parquet",), np.zeros(s.windows, int), np.zeros(s.windows, bool), s.flags)
    one_shift, first = np.zeros(s.windows, int), np.arange(s.windows) < 2
    (told,) = (f for f in reading_findings(s, first, one_shift, logs=logs) if f["kind"] == "frozen")
    assert (told["time"], told["end"], told["axes"]) == (s.start[late][0], s.end[-1], [1, 2, 3, 4, 5])
    assert "keeps one value in motion" in told["words"]
    assert "day.parquet" in told["words"]
    # An axis of coarse steps, which kept one value for hours before, is told of a whole shift alone.
    coarse = s.flags.copy()
    coarse[0, 3] |= int(Flag.TORQUE_FROZEN)
    told = [f for f in reading_findings(replace(s, flags=coarse), first, one_shift, logs=logs) if f["kind"] == "frozen"]
    assert [f["axes"] for f in told] == [[1, 2, 3, 5]]
