"""A log is read at its own rate, whatever that of the first one: the same motion has the same friction and lag."""

import numpy as np
import pytest
from monitor_logs import LENGTH, Log, columns, layout, model, write_parquet

from jointwear.measurement.flags import Flag
from jointwear.monitor.reading.logs import log_statistics
from jointwear.monitor.reading.survey import survey_log
from jointwear.robots.trajectory import Task

#: How late [s] the torques of all logs are: a usual filter of a controller.
LATE = 0.012
#: Part of the friction of the robot file by which two estimates of it may differ: their noise makes up to 0.7 %.
AGREE = 0.01
#: The moves: one to two seconds each, between which the arm hardly rests.
_RNG = np.random.default_rng(5)
MOVES = Task("quick", _RNG.uniform(-0.8, 0.8, (8, 6)), _RNG.uniform(1.0, 2.0, 8))


def evenly(rate, seconds=60.0):
    return np.arange(round(seconds * rate)) / rate


def made(time, late=LATE, seed=2):
    """A log of these moves at any times [s], its torques late by a time [s], with white noise on them."""
    motion, before = MOVES.motion(time), MOVES.motion(time - late)
    torque = model()(before.position, before.velocity, before.acceleration).total
    torque = torque + 0.01 * np.std(torque, axis=0) * np.random.default_rng(seed).standard_normal(torque.shape)
    return Log(time, motion.position, motion.velocity, motion.acceleration, torque)


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """A function that reads logs of given times, with the survey of a first log of a rate."""
    folder, surveys = tmp_path_factory.mktemp("rates"), {}

    def read(time, first=100, late=LATE, roles=("position", "torque")):
        if (first, roles) not in surveys:
            path = write_parquet(folder / f"{first}_{len(roles)}.parquet", columns(made(evenly(first), seed=1), *roles))
            surveys[first, roles] = survey_log(str(path), layout(), model(), LENGTH)
        path = write_parquet(folder / "log.parquet", columns(made(time, late), *roles))
        return log_statistics(str(path), layout(), model(), surveys[first, roles], LENGTH)

    return read


@pytest.fixture(scope="module")
def usual(known):
    return known(evenly(100))


def friction_of(found):
    """Viscous and Coulomb friction (2, n) beside the model's, in parts of that of the robot file."""
    s, robot = found.statistics, model().robot
    gram, moment = s.gram.sum(axis=0), s.moment.sum(axis=0)
    fit = np.array([np.linalg.lstsq(g, m, rcond=1e-9)[0] for g, m in zip(gram, moment, strict=True)])
    return np.stack([fit[:, 2] / robot.viscous, fit[:, :2].mean(axis=1) / robot.coulomb_positive])


def assert_read_alike(found, usual, later=False):
    assert found.refused == ()
    assert (found.statistics.flags & int(Flag.LATER) != 0).any() == later
    assert friction_of(found) == pytest.approx(friction_of(usual), abs=AGREE)


@pytest.mark.parametrize("rate", [50, 125, 200, 500])
def test_the_friction_of_the_same_motion_is_the_same_at_any_rate(known, usual, rate):
    assert_read_alike(known(evenly(rate)), usual)


def test_samples_that_are_missing_do_not_change_the_rate(known, usual):
    time = evenly(200)
    kept = np.random.default_rng(4).random(len(time)) > 0.1
    kept[2000:2100] = kept[7000:8000] = False
    assert_read_alike(known(time[kept]), usual)


def test_a_log_that_goes_on_at_another_rate_after_a_pause_is_read_at_either(known, usual):
    slow, fast = evenly(100, 30.0), evenly(500)
    assert_read_alike(known(np.concatenate([slow, fast[fast >= 31.0]])), usual)


@pytest.mark.parametrize("rate", [50, 200, 500])
def test_a_torque_that_turns_later_is_read_at_its_time_at_any_rate(known, usual, rate):
    assert_read_alike(known(evenly(rate), late=LATE + 0.015), usual, later=True)


def test_what_a_slow_first_log_cannot_show_is_gathered_of_others(known):
    all_roles = ("position", "velocity", "acceleration", "torque")
    own, found, slow = (known(evenly(r), f, roles=all_roles).statistics for r, f in ((100, 100), (100, 5), (5, 100)))
    # The dead bands are those of each first log.
    for name in ("near_count", "far_count"):
        assert getattr(found, name) == pytest.approx(getattr(own, name), rel=0.05)
    assert own.turned_shown.any()
    assert found.turned_shown == pytest.approx(own.turned_shown, rel=0.1)
    assert slow.count.any()
    assert not slow.near_count.any()
    assert not slow.turned_shown.any()
