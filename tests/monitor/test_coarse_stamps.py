"""Even samples under stamps of a coarse clock, uneven samples under right stamps, and samples that were dropped."""

import numpy as np
import pytest

from jointwear.measurement.derived.even_steps import step_of, steps_in, usual_step
from jointwear.measurement.formats.chunk import Chunk
from jointwear.monitor.reading.derivation import derive_motion

SPEED, SIZE = 2 * np.pi * np.array([0.5, 0.9]), np.array([0.8, 0.5])


def error_of(time, stamps):
    """RMS error (2,) of the derived accelerations [rad/s2]: positions of 16 bits at `time`, logged with `stamps`."""
    step = 2 * np.pi / 2**16
    position = step * np.round(SIZE * np.sin(SPEED * time[:, None]) / step)
    chunk = Chunk(time=stamps, position=position, torque=np.zeros_like(position))
    motion = derive_motion(chunk, np.zeros(len(time), dtype=int), np.array([8.0, 8.0]))
    true = -(SPEED**2) * SIZE * np.sin(SPEED * time[:, None])
    return np.sqrt(np.mean((motion.acceleration - true)[motion.usable[:, 0]] ** 2, axis=0))


@pytest.mark.parametrize("rate", [120, 248, 300, 400, 500, 640])
@pytest.mark.parametrize("dropped", [0.0, 0.02])
def test_stamps_in_whole_milliseconds_cost_nothing(rate, dropped):
    time = np.arange(20 * rate) / rate
    time = time[np.random.default_rng(1).random(len(time)) >= dropped]
    exact = error_of(time, time)
    assert np.all(error_of(time, np.floor(1000 * time) / 1000) < 1.3 * exact)


@pytest.mark.parametrize("rate", [120, 300])
def test_right_stamps_of_uneven_samples_hold(rate):
    time = np.arange(20 * rate) / rate
    uneven = time + np.random.default_rng(2).uniform(-0.3, 0.3, len(time)) / rate
    assert np.all(error_of(uneven, uneven) < 2.0 * error_of(time, time))


def test_the_usual_step_is_the_mean_of_those_that_are_alike():
    stamps = np.floor(1000 * np.arange(300) / 300) / 1000
    assert usual_step(np.diff(stamps)) == pytest.approx(1 / 300, rel=5e-3)
    # A pause, and samples that were written in a burst after it.
    steps = np.array([0.004] * 20 + [0.06] + [0.0001] * 14 + [0.004] * 20)
    assert usual_step(steps) == pytest.approx(0.004)
    assert usual_step(np.zeros(0)) == 0.0
    assert usual_step(np.full(5, 0.01)) == pytest.approx(0.01)


def test_the_step_of_a_log_is_that_between_samples_of_one_stretch():
    time, stretch = np.array([0.0, 0.01, 0.02, 7.0, 7.01, 90.0]), np.array([0, 0, 0, 1, 1, 2])
    assert step_of(time, stretch) == pytest.approx(0.01)
    assert step_of(time[[0, 3, 5]], np.arange(3)) == np.inf


@pytest.mark.parametrize(("seconds", "rate", "held"), [(0.1, 125, 12), (0.1, 100, 10), (0.04, 62.5, 2), (0.3, 125, 37)])
def test_the_round_off_of_stamps_does_not_decide_how_many_steps_a_time_holds(seconds, rate, held):
    assert [steps_in(seconds, off / rate) for off in (1 - 1e-6, 1, 1 + 1e-6)] == 3 * [held]
    assert steps_in(seconds, np.inf) == 0
