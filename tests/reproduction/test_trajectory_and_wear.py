"""Quintic motion and equation (7): properties that must hold for any task and any growth."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jointwear.reproduction.wear import Wear
from jointwear.robots.trajectory import Task, quintic

angles = st.lists(st.floats(-3, 3), min_size=2, max_size=2)


@given(start=angles, stop=angles, duration=st.floats(0.5, 100))
def test_a_quintic_starts_and_stops_at_rest(start, stop, duration):
    motion = quintic(np.array(start), np.array(stop), duration, np.array([0.0, duration]))
    np.testing.assert_allclose(motion.position, [start, stop], atol=1e-12)
    assert not motion.velocity.any()
    assert not motion.acceleration.any()


@given(start=angles, stop=angles, duration=st.floats(1, 60))
def test_velocity_and_acceleration_are_the_derivatives(start, stop, duration):
    time = np.linspace(0, duration, 2001)
    motion = quintic(np.array(start), np.array(stop), duration, time)
    scale = 1 + np.abs(motion.velocity).max()
    np.testing.assert_allclose(
        np.gradient(motion.position, time, axis=0)[2:-2], motion.velocity[2:-2], atol=1e-4 * scale
    )
    scale = 1 + np.abs(motion.acceleration).max()
    np.testing.assert_allclose(
        np.gradient(motion.velocity, time, axis=0)[2:-2], motion.acceleration[2:-2], atol=1e-4 * scale
    )


def test_a_task_repeats_and_pauses():
    task = Task("t", np.array([[0.0], [1.0], [1.0]]), np.array([20.0, 10.0, 30.0]), phase=5.0)
    assert task.cycle == 60
    samples = task.samples(10.0, 12)
    np.testing.assert_allclose(samples.position[:6], samples.position[6:], atol=1e-12)
    np.testing.assert_array_equal(samples.time[:3], [5, 15, 25])
    assert samples.velocity[2, 0] == 0  # in the pause
    assert samples.position[2, 0] == 1


@given(percent=st.floats(0.1, 100), shape=st.floats(0.3, 5), hours=st.integers(10, 500))
def test_wear_grows_monotonically_to_the_exact_end(percent, shape, hours):
    growth = Wear(percent, shape, hours).growth(np.arange(hours + 1))
    assert growth[0] == 0
    assert growth[-1] == percent / 100
    assert (np.diff(growth) >= 0).all()


@given(level=st.floats(0.1, 30), percent=st.floats(0.1, 100), shape=st.floats(0.5, 4))
def test_equation_7_as_printed(level, percent, shape):
    wear = Wear(percent, shape, 120.0)
    hour = np.linspace(0, 120, 25)
    c1, c2 = wear.constants(level)
    r0 = level - c1 / 2
    printed = r0 + c1 / (1 + np.exp(-((c2 * hour) ** 4)))
    positive, negative = wear.coulomb(level, -level, hour)
    np.testing.assert_allclose(positive, printed, rtol=1e-12)
    np.testing.assert_allclose(negative, -printed, rtol=1e-12)
