"""Logs whose samples are not evenly spaced: what is made of their stamps."""

import numpy as np
import pytest

from jointwear.measurement.derived.even_steps import evenly, pieces_of
from jointwear.measurement.derived.motion import measure
from jointwear.measurement.recording import Recording, elapsed_time

ROUND = 2e-5
RATE = 100.0


def moved(time):
    """Positions and accelerations (m, 2) [rad], [rad/s2] at `time` (m,)."""
    order, size = 2 * np.pi * np.array([[0.23, 0.61, 0.95], [0.31, 0.47, 0.7]]).T, np.array([[0.6, 0.2, 0.1]]).T
    phase = time[:, None, None] * order + 0.4
    return np.sum(np.sin(phase) * size, axis=1), np.sum(-(order**2) * np.sin(phase) * size, axis=1)


def recorded(time, stamps=None, label=None):
    q, a = moved(time)
    label = np.zeros(len(time), int) if label is None else label
    return Recording(time if stamps is None else stamps, label, ROUND * np.round(q / ROUND), 1.0 + q), a


def regular(seconds=30.0):
    return np.arange(0, seconds, 1 / RATE)


def worst_acceleration(recording):
    found = measure(recording)
    wrong = np.abs(found.acceleration - moved(found.time)[1])
    return max(wrong[found.usable[:, j], j].max() for j in range(2))


@pytest.fixture
def random():
    return np.random.default_rng(np.random.SeedSequence(5))


def test_an_even_log_stays_as_it_is():
    log, _ = recorded(regular())
    same, time = evenly(log, log.time)
    assert same is log
    assert time is log.time


def test_samples_that_were_dropped_are_no_jump(random):
    time = regular()
    kept = time[random.random(len(time)) > 0.005]
    log, _ = recorded(kept)
    filled, _ = evenly(log, log.time)
    assert len(filled.time) == len(time)
    assert worst_acceleration(log) < 0.3


def test_steps_that_vary_are_believed_where_the_motion_says_so(random):
    time = regular() + random.uniform(-0.15, 0.15, len(regular())) / RATE
    log, _ = recorded(time)
    assert worst_acceleration(log) < 0.3


def test_stamps_that_are_late_are_not_believed(random):
    time = regular()
    log, _ = recorded(time, time + random.uniform(0, 0.3, len(time)) / RATE)
    taken, _ = evenly(log, log.time)
    assert np.array_equal(taken.position, log.position)


@pytest.mark.parametrize("step", [0.002, 0.0025, 0.004, 0.004032, 0.012])
def test_stamps_in_whole_milliseconds_cost_no_acceleration(random, step):
    """Samples that begin between two milliseconds: the clock is one off in some of them."""
    time = step * np.arange(5000)
    speed = np.interp(np.mod(time, 4.0), [0, 0.2, 1.0, 1.2, 2.0, 2.2, 3.0, 3.2], [0, 2, 2, 0, 0, -2, -2, 0])
    position = np.cumsum(speed)[:, None] * step
    stamps = np.round(1e3 * (time + 0.0005) + random.normal(0, 0.01, len(time))) / 1e3
    assert (np.abs(np.diff(stamps) - step) > 4e-4).mean() > 0.03
    exact, whole = (
        measure(Recording(t, np.zeros(len(t), int), ROUND * np.round(position / ROUND), 1.0 + position))
        for t in (time, stamps)
    )
    assert np.abs(whole.acceleration - exact.acceleration).max() < 0.1
    assert np.abs(np.diff(whole.time, 2)).max() < 1e-9


@pytest.mark.parametrize("rate", [400, 640])
def test_a_coarse_clock_and_dropped_samples_together(random, rate):
    """A step of two samples is of four to six milliseconds at 400 Hz, one of a late stamp is of three."""
    time = np.arange(5000) / rate
    time = time[random.random(len(time)) >= 0.02]
    stamps = np.floor(1e3 * (time + random.normal(0, 0.02 / rate, len(time)))) / 1e3
    exact, whole = (worst_of(time, given) for given in (time, stamps))
    assert whole < 2.0 * exact


def worst_of(time, stamps):
    """Largest error of an acceleration [rad/s2]; half a millisecond is the mean lateness of whole ones."""
    found = measure(
        Recording(
            stamps, np.zeros(len(time), int), ROUND * np.round(moved(time)[0] / ROUND), 1.0 + time[:, None] * [1, 1]
        )
    )
    late = np.array([moved(found.time + shift)[1] for shift in np.linspace(0.0, 1e-3, 11)])
    wrong = np.abs(late - found.acceleration)[:, found.usable.all(axis=1)]
    return wrong.max(axis=(1, 2)).min()


def test_a_clock_that_runs_another_rate_for_a_while_keeps_its_stamps():
    stamps = np.cumsum(np.where(np.arange(3000) < 1500, 1.0, 1.2) / RATE)
    log, _ = recorded(regular(), stamps)
    _, time = evenly(log, log.time)
    assert np.array_equal(time, stamps)


def test_late_stamps_and_dropped_samples_together(random):
    time = regular()
    keep = random.random(len(time)) > 0.005
    log, _ = recorded(time[keep], (time + random.uniform(0, 0.3, len(time)) / RATE)[keep])
    filled, grid = evenly(log, log.time)
    assert len(filled.time) == len(time)
    assert np.abs(np.diff(grid) * RATE - 1).max() < 1e-3


def test_a_long_gap_ends_a_piece():
    time = np.concatenate([regular(20.0), 300.0 + regular(20.0)])
    log, _ = recorded(time)
    assert len(pieces_of(time, log.trajectory)) == 2
    same, _ = evenly(log, elapsed_time(log.time, log.trajectory))
    assert same is log
    assert worst_acceleration(log) < 0.3


@pytest.mark.parametrize("lost", [3, 4, 5])
@pytest.mark.parametrize("digits", [5, 12])
def test_a_gap_of_five_steps_is_filled_or_ends_a_piece(random, lost, digits):
    """Stamps that vary put one gap above five steps and another below: what is one in between is a jump."""
    time = regular()
    keep = np.ones(len(time), bool)
    for start in (600, 1190, 1600, 2000):
        keep[start : start + lost] = False
    time = time[keep]
    stamps = time + random.uniform(0, 1e-3, len(time))
    log = Recording(stamps, np.zeros(len(time), int), np.round(moved(time)[0], digits), 1.0 + moved(time)[0])
    assert worst_acceleration(log) < 0.5


def test_a_value_that_is_missing_stays_missing(random):
    time = regular()[random.random(len(regular())) > 0.005]
    log, _ = recorded(time)
    log.torque[500:510, 1] = np.nan
    filled, grid = evenly(log, log.time)
    hole = (grid > time[500] - 0.001) & (grid < time[509] + 0.001)
    assert np.isnan(filled.torque[hole, 1]).all()
    assert np.isfinite(filled.torque[~hole]).all()
    assert np.isfinite(filled.position).all()
