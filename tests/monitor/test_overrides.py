"""Speeds that the baseline lacks are told by the path, whichever samples near stops are left out."""

from dataclasses import replace

import numpy as np
from monitor_windows import PER_WINDOW, residuals, statistics_of

from jointwear.measurement.flags import Flag
from jointwear.monitor.normal.conditions import operating_features
from jointwear.monitor.normal.override import override_findings, path_speed, unseen_speed
from jointwear.monitor.normal.payload import GravityTorque
from jointwear.monitor.normal.programs import among_programs
from jointwear.monitor.reading.at_rest import without_noise_at_rest

WINDOWS, BASELINE = 40, np.arange(40) < 20
LATE = slice(30, None)


def month():
    return statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), 3))


def speed(statistics):
    return path_speed(operating_features(statistics, np.ones(3), GravityTorque(0.0, 0.0))[0])


def told(statistics):
    judged = np.arange(WINDOWS) >= 35
    return override_findings(statistics, speed(statistics), None, BASELINE, judged)


def at(statistics, factor):
    """Late windows at so many times the usual speed."""
    statistics.gram[LATE, :, 2] *= factor
    statistics.gram[LATE, :, :, 2] *= factor
    return statistics


def test_an_override_is_told_with_its_factor():
    (found,) = told(at(month(), 0.8))
    assert (found["time"], found["kind"]) == (30 * 3600.0, "override")
    assert "10 h at 0.8 times its usual speed" in found["words"]
    assert "5 h of them judged" in found["words"]


def test_the_program_that_ran_at_another_speed_is_named_where_others_did_not():
    statistics = at(month(), 0.8)
    late = np.zeros(WINDOWS, dtype=bool)
    late[LATE] = True
    program = np.where(late, '{"weld": 9}', '{"pick": 9}').astype(object)
    for labels, begins in (
        (program, "In program 'weld' the robot ran 10 h at"),
        (np.full(WINDOWS, '{"weld": 9}', dtype=object), "The robot ran 10 h at"),
        (np.full(WINDOWS, "", dtype=object), "The robot ran 10 h at"),
    ):
        (found,) = told(replace(statistics, labels=labels))
        assert found["words"].startswith(begins)


def test_a_program_without_a_name_is_one_of_so_many():
    rows, nameless = np.arange(5, 8), np.full(12, "", dtype=object)
    assert among_programs(nameless, np.repeat([0, 1, 2], 4), rows) == "in 1 of its 3 programs"
    assert among_programs(nameless, np.zeros(12, dtype=int), rows) == ""
    assert among_programs(nameless, None, rows) == ""


def test_slower_and_faster_hours_are_told_apart():
    """0.65 to 1.6 times its usual speed held the usual one."""
    statistics = at(month(), 0.65)
    faster = np.arange(WINDOWS)[LATE][6:]
    statistics.gram[faster, :, 2] *= 1.6 / 0.65
    statistics.gram[faster, :, :, 2] *= 1.6 / 0.65
    (found,) = told(statistics)
    assert "ran 6 h at 0.65 times its usual speed and 4 h at 1.6 times its usual speed, which" in found["words"]


def test_slow_samples_near_stops_are_no_other_speed():
    """A seventh more samples, at a twentieth of the speed: the mean over time falls by 12 %."""
    s = month()
    more, slow = PER_WINDOW // 7, 0.05 * 0.6
    s.count[LATE] += more
    s.gram[LATE, :, 0, 2] += slow * more / 2
    s.gram[LATE, :, 1, 2] += slow * more / 2
    s.gram[LATE, :, 2, 2] += slow**2 * more
    over_time = operating_features(s, np.ones(3), GravityTorque(0.0, 0.0))[0][..., 0]
    assert override_findings(s, over_time, None, BASELINE, np.zeros(WINDOWS, dtype=bool))
    assert told(s) == []


def test_another_part_of_the_cycle_is_no_other_speed():
    """Logs of 24 s of a cycle of 35 s: some axes faster by a tenth, others slower by a quarter, all of one program."""
    s = month()
    value = speed(s)
    value[LATE] += np.array([-0.1, -0.25, 0.1])
    assert (unseen_speed(value, None, BASELINE)[LATE] < 0).all()
    judged = np.ones(WINDOWS, dtype=bool)
    assert override_findings(s, value, None, BASELINE, judged) == []
    # Beside an override axes differ by less than it takes all of them along.
    value[LATE] += np.array([-0.25, -0.2, -0.5])
    (found,) = override_findings(s, value, None, BASELINE, judged)
    assert "10 h at 0.67 times" in found["words"]


def test_one_axis_that_moves_alone_tells_no_speed_of_all():
    value = np.zeros((WINDOWS, 3))
    value[LATE] = -3.0, np.nan, np.nan
    assert not unseen_speed(value, None, BASELINE).any()
    value[LATE, 1] = -3.0
    assert (unseen_speed(value, None, BASELINE)[LATE] < 0).all()
    value[5] = -6.0, np.nan, np.nan  # such a window of the baseline does not widen its range
    assert (unseen_speed(value, None, BASELINE)[LATE] < 0).all()


def test_noise_beyond_the_dead_band_is_no_motion():
    s = month()
    s.travel[:], s.samples[:] = 5.0, 2 * PER_WINDOW
    s.travel[LATE], s.count[LATE] = 0.002, [0, 0, 3]
    still = without_noise_at_rest(s)
    assert (still.count[LATE] == 0).all()
    assert not still.gram[LATE, 2].any()
    assert (still.flags[LATE, 2] == int(Flag.AT_REST)).all()
    np.testing.assert_array_equal(still.gram[:30], s.gram[:30])
    assert s.count[-1, 2] == 3
    assert without_noise_at_rest(still) is still


def test_few_samples_along_a_path_and_many_without_one_are_motion():
    s = month()
    few = replace(s, samples=s.samples * 100, travel=np.full((WINDOWS, 3), 0.5))
    assert without_noise_at_rest(few) is few
    assert without_noise_at_rest(s) is s  # travel is not known: samples far apart
