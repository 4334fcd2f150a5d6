"""A joint that counts from another zero from one day on is told; programs, loads and files are none."""

from dataclasses import replace

import numpy as np
import pytest
from monitor_logs import RATE, Log, columns, model, read, write_parquet

from jointwear.measurement.flags import Flag
from jointwear.monitor.presentation.condition import AxisCondition
from jointwear.monitor.presentation.episodes import Episode
from jointwear.monitor.reading.windows import blank_statistics
from jointwear.monitor.reading.zeros import changed_zero, zero_finding
from jointwear.monitor.watching.records import CHANGED, DETECTORS
from jointwear.robots.trajectory import Task


def quick(seed):
    """A log of moves of one to two seconds, between which the arm hardly rests."""
    rng, time = np.random.default_rng(5), np.arange(3000) / RATE
    motion = Task("quick", rng.uniform(-0.8, 0.8, (8, 6)), rng.uniform(1.0, 2.0, 8)).motion(time)
    torque = model()(motion.position, motion.velocity, motion.acceleration).total
    torque = torque + 0.01 * np.std(torque, axis=0) * np.random.default_rng(seed).standard_normal(torque.shape)
    return Log(time, motion.position, motion.velocity, motion.acceleration, torque)


@pytest.mark.parametrize(("joint", "degrees"), [(1, 10.0), (2, -6.0)])
def test_a_log_shows_the_angle_of_a_joint(tmp_path, joint, degrees):
    log, good = quick(12), write_parquet(tmp_path / "good.parquet", columns(quick(1)))
    position = log.position.copy()
    position[:, joint] += np.radians(degrees)
    angles = []
    for name, one in (("usual", log), ("turned", replace(log, position=position))):
        s = read(write_parquet(tmp_path / f"{name}.parquet", columns(one)), good).statistics
        assert (s.turned_shown[:, joint] > 0).all()
        angles.append(np.degrees(s.turned.sum(axis=0) / np.maximum(s.turned_shown.sum(axis=0), 1e-12))[joint])
    assert angles[0] == pytest.approx(0.0, abs=0.5)
    assert angles[1] == pytest.approx(-degrees, abs=0.15 * abs(degrees))


def month(change, joint=1, programs=2, spread=0.3):
    """Twenty shifts of eight windows of three axes, programs in turn; from shift 14 on joint 2 changes [deg]."""
    rng, w = np.random.default_rng(4), 160
    found = blank_statistics(np.arange(w) * 3600.0, 3600.0, np.ones(3), True)
    found.count[:] = 100
    shift, program = np.arange(w) // 8, np.arange(w) % programs
    angle = np.radians(np.array([0.0, 7.0])[program][:, None] + spread * rng.standard_normal((w, 3)))
    angle[112:, joint] += np.radians(change)
    found.turned_shown[:] = [1e4, 2e4, 1e4]
    found.turned[:] = angle * found.turned_shown
    return found, program, shift, np.arange(w) < 80


@pytest.mark.parametrize("change", [10.0, -4.0])
def test_the_same_change_in_two_shifts_is_another_zero(change):
    statistics, program, shift, baseline = month(change)
    found = changed_zero(statistics, program, shift, baseline, [[]] * 3)
    assert found.axes == (1,)
    assert (found.begin, found.known, found.end) == (112, 128, 160)
    assert np.degrees(found.angle) == pytest.approx(change, abs=0.5)
    (told,) = zero_finding(statistics, found)
    assert told["axes"] == [2]
    assert "counts from another zero" in told["words"]
    assert "'sensor'" in told["words"]
    assert "answered" not in told


def test_logs_that_were_refused_in_part_tell_no_other_zero():
    """Torques of two joints that are exchanged for a day look like one where nothing refuses them."""
    statistics, program, shift, baseline = month(10.0)
    doubtful = (shift >= 14) & (shift <= 18)
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3, doubtful) is None


def test_windows_that_scatter_make_no_other_zero_of_a_shift():
    """A part that is found in some windows turns their angles by 11 degrees: in two shifts in half and in most."""
    statistics, program, shift, baseline = month(0.0)
    windows = np.arange(160) % 8
    found = np.random.default_rng(7).permuted(windows.reshape(20, 8), axis=1).ravel() < 2
    found = np.where(shift == 14, windows < 4, np.where(shift == 15, windows < 6, found))
    statistics.turned[:] += np.radians(11.0) * statistics.turned_shown * found[:, None]
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3) is None


@pytest.mark.parametrize(("share", "told"), [(0.0, True), (0.2, False)])
def test_a_part_that_windows_of_the_baseline_show_as_well_is_no_other_zero(share, told):
    """It turns the angles of a fifth of the windows of the baseline, and of all windows of four shifts later."""
    statistics, program, shift, baseline = month(0.0)
    windows = np.tile(np.arange(5) < 5 * share, 16)
    carried = np.concatenate([windows, np.isin(shift[80:], [14, 15, 16, 17])])
    statistics.turned[carried, 1] += np.radians(9.0) * statistics.turned_shown[carried, 1]
    assert (changed_zero(statistics, program, shift, baseline, [[]] * 3) is not None) == told


def test_what_comes_and_goes_may_be_a_part_and_is_told_as_either():
    """A zero stays until somebody mends it; a part that came and went before is no zero when it comes again."""
    statistics, program, shift, baseline = month(0.0)

    def turned(shifts):
        found = blank_statistics(statistics.start, 3600.0, np.ones(3), True)
        found.count[:], found.turned_shown[:] = statistics.count, statistics.turned_shown
        found.turned[:] = statistics.turned
        found.turned[np.isin(shift, shifts), 1] += np.radians(9.0) * found.turned_shown[0, 1]
        return found, changed_zero(found, program, shift, baseline, [[]] * 3)

    windows, found = turned([14, 15, 16, 17])
    assert (found.begin, found.gone) == (112, 144)
    (told,) = zero_finding(windows, found)
    assert (told["time"], told["end"], told["answered"]) == (112 * 3600.0, 144 * 3600.0, True)
    assert "or a part that the robot carried" in told["words"]
    assert turned([14, 15, 16, 17, 18])[1].gone is None
    assert turned([11, 16, 17, 18, 19])[1] is None
    assert turned([11, 13, 14, 15, 16, 17, 18, 19])[1].axes == (1,)


def test_a_change_beyond_such_a_part_is_another_zero():
    statistics, program, shift, baseline = month(14.0)
    carried = baseline & (np.arange(160) % 5 == 0)
    statistics.turned[carried, 1] += np.radians(9.0) * statistics.turned_shown[carried, 1]
    found = changed_zero(statistics, program, shift, baseline, [[]] * 3)
    assert (found.axes, found.begin) == ((1,), 112)


def test_a_part_that_a_program_lacked_is_no_other_zero():
    """It turns the angles of its program alone: beside another program in each shift, or in shifts of its own."""
    statistics, program, shift, baseline = month(0.0)
    late = (np.arange(160) >= 112) & (program == 1)
    statistics.turned[late, 1] += np.radians(12.0) * statistics.turned_shown[late, 1]
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3) is None
    for change, told in ((0.0, False), (5.0, True)):
        statistics, _, shift, baseline = month(0.0)
        program = np.isin(shift, [1, 4, 6, 9, 12, 14, 16, 17]).astype(int)
        statistics.turned[:] = np.radians(0.1 * np.random.default_rng(8).standard_normal((160, 3)))
        # The usual angle of a program is that of the baseline: a part comes with the second one, or the zero moves.
        for rows, angle in ((shift >= 14, change), ((shift >= 14) & (program == 1), 0.0 if told else 5.0)):
            statistics.turned[rows, 1] += np.radians(angle)
        statistics.turned[:] *= statistics.turned_shown
        assert (changed_zero(statistics, program, shift, baseline, [[]] * 3) is not None) == told


@pytest.mark.parametrize(("turned", "first"), [(90.0, "first settle from which zero"), (200.0, "check the gear")])
def test_alarms_that_follow_send_nobody_to_the_gear(turned, first):
    alarm = {"time": 100.0, "change": 9.0}
    episode = Episode(3, "coulomb friction", DETECTORS[0], (alarm,), None)
    condition = AxisCondition(3, "elbow", CHANGED, 9.0, 3.0, 20.0, None, (episode,), (), turned=turned)
    assert condition.check.startswith(first)


def test_a_torque_that_is_cut_off_makes_no_other_zero():
    statistics, program, shift, baseline = month(-4.4)
    statistics.flags[112:, 2] |= int(Flag.SATURATED)
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3) is None


def test_an_event_answers_it():
    statistics, program, shift, baseline = month(10.0)
    found = changed_zero(statistics, program, shift, baseline, [[136], [136], [136]])
    assert (found.known, found.end) == (128, 136)
    assert zero_finding(statistics, found)[0]["answered"]
    assert changed_zero(statistics, program, shift, baseline, [[112], [112], [112]]) is None


@pytest.mark.parametrize(("change", "spread"), [(0.0, 0.3), (2.0, 0.3), (5.0, 6.0)])
def test_programs_small_changes_and_what_scatters_as_much_are_none(change, spread):
    statistics, program, shift, baseline = month(change, spread=spread)
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3) is None


def test_what_was_not_asked_tells_nothing():
    statistics, program, shift, baseline = month(10.0)
    statistics.turned_shown[:] = 0.0
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3) is None


def test_a_joint_that_hardly_carries_anything_tells_nothing():
    statistics, program, shift, baseline = month(10.0, joint=2)
    statistics.turned_shown[:, 2] = 1e-12
    assert changed_zero(statistics, program, shift, baseline, [[]] * 3) is None
