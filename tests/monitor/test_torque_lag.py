"""A torque that turns later than in the first log is read at its time, up to what drives and filters do."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import LENGTH, RATE, Log, columns, layout, model, read, write_parquet

from jointwear.measurement.flags import Flag
from jointwear.measurement.refused import Refused
from jointwear.monitor.findings.read_findings import reading_findings
from jointwear.monitor.reading.survey import survey_log
from jointwear.monitor.reading.torque_lag import Lag, change_of, off_in_time, read_later
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.trajectory import Task

#: Column of the viscous friction in the regression.
VISCOUS = 2


def _log(seed=1):
    """A log of moves of one to two seconds, between which the arm hardly rests."""
    rng = np.random.default_rng(5)
    task = Task("quick", rng.uniform(-0.8, 0.8, (8, 6)), rng.uniform(1.0, 2.0, 8))
    time = np.arange(3000) / RATE
    motion = task.motion(time)
    torque = model()(motion.position, motion.velocity, motion.acceleration).total
    torque = torque + 0.01 * np.std(torque, axis=0) * np.random.default_rng(seed).standard_normal(torque.shape)
    return Log(time, motion.position, motion.velocity, motion.acceleration, torque)


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return write_parquet(tmp_path_factory.mktemp("good") / "good.parquet", columns(_log()))


def _late(log, seconds, axes=slice(None)):
    torque = log.torque.copy()
    moved = np.stack([np.interp(log.time - seconds, log.time, t) for t in log.torque.T], axis=1)
    torque[:, axes] = moved[:, axes]
    return replace(log, torque=torque)


def _filtered(log, seconds):
    share, torque = 1 - np.exp(-0.02 / seconds), log.torque.copy()
    for k in range(1, len(torque)):
        torque[k] = torque[k - 1] + share * (log.torque[k] - torque[k - 1])
    return replace(log, torque=torque)


def _viscous(found):
    s = found.statistics
    gram, moment = s.gram.sum(axis=0), s.moment.sum(axis=0)
    return np.array([np.linalg.lstsq(g, m, rcond=1e-9)[0][VISCOUS] for g, m in zip(gram, moment, strict=True)])


@pytest.mark.parametrize("change", [lambda log: _late(log, 0.02), lambda log: _filtered(log, 0.03)])
def test_a_later_torque_is_read_as_late_as_the_first_one(tmp_path, good, change):
    log = _log(seed=12)
    usual = read(write_parquet(tmp_path / "usual.parquet", columns(log)), good)
    found = read(write_parquet(tmp_path / "late.parquet", columns(change(log))), good)
    assert not (usual.statistics.flags & int(Flag.LATER)).any()
    assert (found.statistics.flags & int(Flag.LATER) != 0).all()
    assert found.refused == ()
    heavy = [0, 1, 2]
    assert _viscous(found)[heavy] == pytest.approx(_viscous(usual)[heavy], abs=0.4)
    (told,) = (f for f in reading_findings(found.statistics) if f["kind"] == "later")
    assert "another filter" in told["words"]
    assert told["axes"] == []


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.12, "120 ms late"), (0.2, "200 ms late"), (-0.44, "440 ms early"), (1.0, "1000 ms late")]
)
def test_a_torque_of_another_time_is_refused_with_its_lag(tmp_path, good, seconds, words):
    """To first order a delay of half a second is none: it was told as another robot or another load."""
    path = write_parquet(tmp_path / "late.parquet", columns(_late(_log(seed=12), seconds)))
    found = read(path, good)
    (refused,) = found.refused
    assert f"the torque of all joints is about {words} against the motion, unlike in the first log" in refused
    assert "move the rows of the torque" in refused
    assert (found.statistics.count == 0).all()


def test_a_first_log_with_a_torque_of_another_time_is_refused(tmp_path):
    path = write_parquet(tmp_path / "late.parquet", columns(_late(_log(), 0.2)))
    with pytest.raises(Refused, match="the torque of all joints is about 200 ms late against the motion; read at that"):
        survey_log(str(path), layout(), model(), LENGTH)


def test_a_change_that_is_known_to_first_order_alone_is_refused_too():
    """Of axes that the model explains badly it is all that there is."""
    first = Lag(np.zeros(6), np.full(6, 1e-4), np.zeros(6))
    assert change_of(Lag(np.full(6, 0.12), np.full(6, 1e-3), np.full(6, 2e3)), first) == pytest.approx(0.12)
    assert "more than 50 ms off in time" in str(off_in_time("day.csv"))


def test_wear_and_one_late_axis_are_no_lag(tmp_path, good):
    log = _log(seed=12)
    worn = replace(log, torque=log.torque + np.array([0, 9, 0, 0, 0, 0]) * log.velocity)
    for k, other in enumerate((worn, _late(log, 0.02, axes=1))):
        found = read(write_parquet(tmp_path / f"{k}.parquet", columns(other)), good)
        assert not (found.statistics.flags & int(Flag.LATER)).any()


def test_a_torque_that_keeps_one_value_makes_no_load_of_it_for_the_other_axes(tmp_path, good):
    log = _log(seed=12)
    motion = log.position, log.velocity, log.acceleration
    load = np.tile([3.0, 0.0, 0.0, 0.3], (len(log.time), 1))
    log = replace(log, torque=log.torque + sum(FlangeLoad(model().robot).torque(*motion, load)))
    usual = read(write_parquet(tmp_path / "usual.parquet", columns(log)), good)
    torque = log.torque.copy()
    torque[:, 2] = 12.3
    found = read(write_parquet(tmp_path / "frozen.parquet", columns(replace(log, torque=torque))), good)
    assert (found.statistics.flags[:, 2] & int(Flag.TORQUE_FROZEN) != 0).all()
    others = [0, 1, 3, 4, 5]
    friction = [0, 1, VISCOUS]
    was, now = (s.moment[:, others][..., friction] for s in (usual.statistics, found.statistics))
    # With the axis among those that show the load the largest difference is 4700.
    assert now == pytest.approx(was, abs=100)


def test_the_survey_keeps_how_late_the_first_log_is(tmp_path):
    log = _late(_log(), 0.015)
    path = write_parquet(tmp_path / "log.parquet", columns(log))
    lag = survey_log(str(path), layout(), model(), LENGTH).lag
    assert np.median(lag.late[np.isfinite(lag.error)]) == pytest.approx(0.015, abs=0.004)


def test_too_few_axes_say_nothing_of_the_lag():
    sharp = np.full(6, 1e4)
    first = Lag(np.zeros(6), np.full(6, 1e-4), sharp)
    known = np.array([1e-4, 1e-4, *4 * [np.inf]])
    assert change_of(Lag(np.full(6, 0.02), known, sharp), first) == 0.0
    assert change_of(Lag(np.full(6, 0.02), np.full(6, 1e-4), sharp), first) == pytest.approx(0.02)
    assert change_of(Lag(np.array([0.02, 0.02, 0, 0, 0, 0.02]), np.full(6, 1e-4), sharp), first) == 0.0


def test_a_lag_that_leaves_as_much_of_the_torque_is_none():
    first = Lag(np.zeros(6), np.full(6, 1e-4), np.zeros(6))
    assert change_of(Lag(np.full(6, 0.1), np.full(6, 1e-3), np.full(6, 1.0)), first) == 0.0


def test_a_program_that_moves_each_axis_by_a_time_of_its_own_is_no_lag():
    """A program that began after the first log: 0, 9, 13 and 36 ms, of which the median explains most axes better."""
    sharp, far = np.full(4, 2e4), np.array([600.0, 1.2e4, 1.7e4, 1.1e3])
    first = Lag(np.zeros(4), np.full(4, 5e-4), sharp)
    own = np.array([0.0003, 0.0093, 0.0134, 0.0362])
    assert change_of(Lag(own, np.full(4, 1e-3), far), first) == 0.0
    # A filter delays all of them alike, but for what the program does.
    alike = np.array([0.0113, 0.0093, 0.0134, 0.0362])
    assert change_of(Lag(alike, np.full(4, 1e-3), far), first) == pytest.approx(0.01235)


def test_a_program_that_was_taught_anew_is_no_lag_that_explains_one_axis_of_it():
    """A UR10 without friction in its file: 3, 4, 8, 101 and 15 ms early, 8 of which explain the last axis alone."""
    sharp = np.array([717.0, 320.0, 131.0, 44.0, 1144.0])
    first = Lag(np.array([-2.7, 3.2, 2.8, 20.3, -7.0]) / 1e3, np.full(5, 5e-4), sharp)
    own = np.array([-2.6, -4.2, -7.6, -101.0, -14.9]) / 1e3
    assert change_of(Lag(first.late + own, np.full(5, 1e-3), sharp), first) == 0.0
    # A filter takes most of what there is off them all.
    filtered = np.array([-6.6, -8.2, -11.6, -30.0, -14.9]) / 1e3
    assert change_of(Lag(first.late + filtered, np.full(5, 1e-3), sharp), first) == pytest.approx(-0.0116)


def test_torques_read_later_end_with_their_stretch():
    time, stretch = np.arange(8.0), np.repeat([0, 1], 4)
    usable = np.ones((8, 1), dtype=bool)
    usable[5] = False
    moved, kept = read_later(time[:, None] * 2, time, stretch, usable, 0.5)
    assert moved[:3, 0] == pytest.approx([1.0, 3.0, 5.0])
    assert kept[:, 0].tolist() == [True, True, True, False, False, False, True, False]
