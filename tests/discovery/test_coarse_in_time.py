"""Logs of few samples a second: what the model lacks is no noise, and where it cannot be told nothing is named."""

import numpy as np
import pytest

from jointwear.discovery import Recording, discover
from jointwear.discovery.noise.noise import HIGHEST_ORDER, order_in_runs
from jointwear.discovery.posing import pose_problem
from jointwear.discovery.preflight import check_data
from jointwear.discovery.presentation.page import heading, lead
from jointwear.discovery.problem.saturated import estimate_noise, noise_level
from jointwear.discovery.settings import Settings
from jointwear.measurement.recording import split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import load_robot

FAST, NOISE, AXIS = 100.0, 0.3, 1


def recorded(every: int, stiffness: float = 55.0) -> tuple[Recording, object]:
    """Return every so many samples of records at 100 Hz of an arm with a spring on its second joint, and the arm."""
    robot = load_robot("config/robots/puma560.yaml")
    rng = np.random.default_rng(11)
    time, parts = np.arange(0, 20.0, 1 / FAST), []
    for k in range(5):
        phase = rng.uniform(0, 6, (3, 6))
        speed = 2 * np.pi * np.array([0.11, 0.29, 0.47])[:, None] * rng.uniform(0.9, 1.1, 6)
        x, size = speed * time[:, None, None] + phase, np.array([0.5, 0.25, 0.12])[:, None]
        q, v = np.sum(size * np.sin(x), axis=1), np.sum(size * speed * np.cos(x), axis=1)
        a = -np.sum(size * speed**2 * np.sin(x), axis=1)
        torque = Dynamics(robot).inverse_dynamics(q, v, a) + NOISE * rng.standard_normal(q.shape)
        torque[:, AXIS] += stiffness * q[:, AXIS]
        rows = slice(None, None, every)
        parts.append((time[rows] + 25 * k, np.full(len(time[rows]), k), q[rows], torque[rows]))
    stamp, label, q, torque = (np.concatenate(x) for x in zip(*parts, strict=True))
    return Recording(stamp, label, q, torque, name="coarse"), robot


def runs_of(length: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return samples in runs of a length that a reversal parts, and their one label."""
    usable = np.tile(np.append(np.ones(length, bool), False), count)
    return usable, np.zeros(len(usable), int)


@pytest.mark.parametrize(("length", "order"), [(50, HIGHEST_ORDER), (12, HIGHEST_ORDER), (10, 5), (8, 4), (4, 2)])
def test_the_order_leaves_half_of_the_samples_of_short_runs(length, order):
    assert order_in_runs(*runs_of(length, 100)) == order


def test_of_few_samples_in_short_runs_no_order_tells_noise_from_motion():
    assert order_in_runs(*runs_of(8, 20)) is None
    # Of few samples in long runs, as in a short record of a fast log, it is the usual one.
    assert order_in_runs(*runs_of(50, 2)) == HIGHEST_ORDER


@pytest.mark.long
@pytest.mark.parametrize("every", [8, 10, 12])
def test_what_the_model_lacks_is_no_noise_of_a_log_of_ten_samples_a_second(every):
    recording, robot = recorded(every)
    posed = pose_problem(split(recording), robot, Settings())
    problem, told = posed.problem, posed.restrictions
    assert not any("too coarse" in words for words in told)
    white = estimate_noise(problem)[AXIS]
    lacking = problem.lacking[AXIS]
    assert lacking > 10.0
    assert 0.5 * NOISE < noise_level(problem, AXIS, white) < 0.1 * lacking


@pytest.fixture(scope="module")
def coarse():
    """What is found in a log of the same motion of three samples a second."""
    return discover(*recorded(33))


def test_a_log_that_is_too_coarse_names_nothing_and_says_why(coarse):
    data = coarse.data
    assert data["verdict"] == "unknown"
    assert not data["effects"]
    assert AXIS + 1 in data["noise_untold"]
    assert data["gap"]["noise_floor"][AXIS] is None
    assert not data["to_the_noise"]
    assert any("too coarse in time" in words for words in data["restrictions"])
    assert "oo coarse in time" in heading(data)
    assert not any("closes" in words for words in lead(data))


def test_the_check_before_the_run_says_so_too():
    recording, robot = recorded(33)
    found = check_data(recording, robot)
    assert any("too coarse in time" in words for words in found.restrictions)
    assert not any(s.axis == AXIS + 1 for s in found.shown)
    assert found.joints[AXIS].noise is None
