"""A clock at another speed and a position that stops are told; other speeds, rates and programs are not."""

import numpy as np
import pytest
from monitor_windows import motion, residuals, statistics_of

from jointwear.measurement.flags import Flag
from jointwear.monitor.findings.odd_motion import CLOCK_SPEED, EXCHANGED, STOPPED, odd_motion_findings
from jointwear.monitor.reading.accumulate import Samples, WindowSettings, window_statistics
from jointwear.monitor.reading.model import ModelTorque
from jointwear.monitor.reading.windows import merge

#: Windows, and those of a shift; the first four shifts are the baseline. Two programs take turns.
WINDOWS, SHIFT, STEP = 64, 8, 0.02
SHIFTS, PROGRAM = np.arange(WINDOWS) // SHIFT, np.arange(WINDOWS) % 2


def month(speed=1.0, step=1.0, since=48, seed=3):
    """Windows of three axes; from `since` on speed and time between samples are these times what they were."""
    s = statistics_of(residuals(WINDOWS, np.zeros((WINDOWS, 3)), seed))
    scatter = np.exp(0.03 * np.random.default_rng(seed).standard_normal(WINDOWS))
    size = scatter * np.where(PROGRAM, 1.6, 1.0) * np.where(np.arange(WINDOWS) >= since, speed, 1.0)
    # The second program moves the first axis three times as fast beside the others.
    size = size[:, None] * np.where(PROGRAM[:, None] & (np.arange(3) == 0), 3.0, 1.0)
    s.gram[:, :, 2] *= size[..., None]
    s.gram[:, :, :, 2] *= size[..., None]
    path = np.abs(motion()[..., 2]).sum(axis=0) * size * STEP
    s.travel[:] = path * np.where(np.arange(WINDOWS) >= since, step, 1.0)[:, None]
    return s


def rest(s, axes, since=48):
    for name in ("gram", "moment", "count", "travel"):
        getattr(s, name)[since:, axes] = 0
    s.flags[since:, axes] |= int(Flag.AT_REST)
    return s


def findings(s, regime=PROGRAM, events=((), (), ())):
    return odd_motion_findings(s, regime, SHIFTS, SHIFTS < 4, events)


@pytest.mark.parametrize(
    ("factor", "regime"),
    [(0.5, PROGRAM), (0.7, PROGRAM), (0.8, PROGRAM), (1.2, PROGRAM), (2.0, PROGRAM), (0.5, None), (2.0, None)],
)
def test_a_clock_at_another_speed_is_told_while_it_runs(factor, regime):
    (found,) = findings(month(speed=1 / factor, step=factor), regime)
    assert found["kind"] == CLOCK_SPEED
    assert (found["time"], found["end"]) == (48 * 3600.0, WINDOWS * 3600.0)
    told = float(found["words"].split("divide the times by ")[1].split(",")[0])
    assert told == pytest.approx(factor, rel=0.1)
    assert ("stretched by" if factor > 1 else "compressed to") in found["words"]


def swings(since, factor):
    """Windows of an arm that swings; from a window on logged seconds count `factor` of those that pass."""
    passed, parts = np.arange(500) / 10, []
    settings = WindowSettings(3600.0, np.full(3, 0.02), np.full(3, 10.0))
    for k in range(WINDOWS):
        time = 3600.0 * k + passed * (factor if k >= since else 1.0)
        position = np.sin(2 * np.pi * np.array([0.2, 0.31, 0.27]) * passed[:, None] + np.arange(3))
        velocity = np.gradient(position, time, axis=0)
        torque = 3 * np.sign(velocity) + 0.1 * np.random.default_rng(k).standard_normal(velocity.shape)
        parts.append(
            window_statistics(Samples(time, position, velocity, torque, ModelTorque(*3 * [0 * torque])), settings)
        )
    return merge(parts)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_times_that_are_divided_by_what_the_page_says_are_right(factor):
    (found,) = findings(swings(48, factor), None)
    told = float(found["words"].split("divide the times by ")[1].split(",")[0])
    assert told == pytest.approx(factor, rel=0.02)
    assert findings(swings(48, factor / told), None) == []


@pytest.mark.parametrize(("speed", "step"), [(0.5, 1.0), (1.0, 0.5), (0.5, 0.5), (0.9, 1.1), (0.7, 1.1), (1.0, 1.0)])
def test_other_speeds_and_other_rates_are_no_clock(speed, step):
    assert findings(month(speed, step)) == []


def test_a_position_that_stops_is_told():
    (found,) = findings(rest(month(), 1))
    assert (found["kind"], found["axes"], found["time"]) == (STOPPED, [2], 48 * 3600.0)
    assert "answered" not in found
    (answered,) = findings(rest(month(), 1), events=((), (50,), ()))
    assert answered["answered"]


def test_positions_that_all_stop_are_told():
    (found,) = findings(rest(month(), [0, 1, 2]))
    assert (found["kind"], found["axes"], found["time"]) == (STOPPED, [1, 2, 3], 48 * 3600.0)
    assert "all axes" in found["words"]
    # A robot that stands has torques that stand, too.
    stands = rest(month(), [0, 1, 2])
    stands.torque_histogram[48:] = 0
    stands.torque_histogram[48:, :, 20] = 80
    assert findings(stands) == []


def test_logs_that_are_refused_hold_no_stopped_positions():
    """Torques in another unit: no sample counts, so that no axis moves, and the torques are spread all the same."""
    refused = rest(month(), [0, 1, 2])
    refused.flags[48:] |= int(Flag.REFUSED)
    assert findings(refused) == []


def test_one_shift_two_axes_at_rest_or_another_program_are_no_stopped_position():
    assert findings(rest(month(since=56), 1, since=56)) == []
    assert findings(rest(month(), [0, 1])) == []
    other = rest(month(), 1)
    other.gram[48:, 0, 2] *= 2.0
    other.gram[48:, 0, :, 2] *= 2.0
    other.travel[48:, 0] *= 2.0
    assert findings(other) == []


def test_without_a_torque_nothing_tells_whether_an_axis_moved():
    lost = rest(month(), 1)
    lost.flags[48:, 1] = int(Flag.NOT_FINITE)
    assert findings(lost) == []


def exchange(s, one, other, since=48):
    """Give two joints from a window on the motion of the other one, wherever it is kept."""
    for name in ("gram", "moment", "count", "travel"):
        values = getattr(s, name)
        values[since:, [one, other]] = values[since:, [other, one]]
    return s


def with_a_slow_joint(s):
    s.gram[:, 2, 2] /= 4.0
    s.gram[:, 2, :, 2] /= 4.0
    return s


def test_two_joints_that_move_as_the_other_one_are_told():
    found = findings(exchange(with_a_slow_joint(month()), 1, 2))
    assert [(f["kind"], f["axes"], f["time"]) for f in found] == [(EXCHANGED, [2, 3], 48 * 3600.0)]
    assert "joint 3 as joint 2" in found[0]["words"]


def test_two_joints_that_move_alike_and_another_program_are_no_exchange():
    assert findings(exchange(month(), 1, 2)) == []
    slower = with_a_slow_joint(month())
    slower.gram[48:, 1, 2] *= 0.5
    slower.gram[48:, 1, :, 2] *= 0.5
    assert findings(slower) == []
