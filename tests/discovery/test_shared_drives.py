"""Samples in which a drive that two joints share sticks."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import COARSE_RATE as RATE
from discovery_cases import make_case

from jointwear.discovery import assumed
from jointwear.discovery.estimates.refine import simplest
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.shared_drives import sticking
from jointwear.discovery.search.searches import search, whitened
from jointwear.discovery.settings import Settings
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot

SIGMAS = Settings().noise_sigmas


def two_joints(rng):
    """Velocity, acceleration, usable samples and inertial torque of two joints that swing at speeds of their own."""
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(2.0 * time), np.cos(3.1 * time)], axis=1)
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    return velocity, acceleration, np.ones((4000, 2), dtype=bool), rng.standard_normal((4000, 2, 2))


def test_samples_of_a_shared_drive_that_sticks_are_left_out():
    rng = np.random.default_rng(3)
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(w * time + k) for k, w in enumerate((2.0, 3.1, 4.3))], axis=1)
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    usable, inertial = np.abs(velocity) > 0.02, rng.standard_normal((4000, 3, 2))
    speed = velocity[:, 1] + velocity[:, 2]
    slow = np.abs(speed) < assumed.STICKS
    # A shared drive on joints 2 and 3, of any friction where it sticks.
    level = np.where(slow, rng.uniform(-1, 1, 4000), np.sign(speed))
    missing = 0.02 * rng.standard_normal((4000, 3)) + 0.8 * level[:, None] * np.array([0, 1, 1])
    stuck = sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)
    assert not stuck[:, 0].any()
    np.testing.assert_array_equal(stuck[:, 1:], np.stack([slow, slow], axis=1))
    missing[:, 1] = 0.02 * rng.standard_normal(4000)
    assert not sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)[:, 1].any()


def test_a_shared_drive_is_known_by_the_few_of_its_slow_samples_at_which_it_sticks():
    """Where a wrist moves its two joints against each other its drive is slow for long, and sticks here and there."""
    rng = np.random.default_rng(6)
    velocity, acceleration, usable, inertial = two_joints(rng)
    speed = velocity.sum(axis=1)
    slow = np.abs(speed) < assumed.STICKS
    level = np.sign(speed)
    sticks = slow & (rng.uniform(size=4000) < 0.2)
    level[sticks] = rng.uniform(-1, 1, sticks.sum())
    missing = 0.1 * rng.standard_normal((4000, 2)) + 0.8 * level[:, None]
    stuck = sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)
    np.testing.assert_array_equal(stuck, np.stack([slow, slow], axis=1))
    resolved = 0.1 * rng.standard_normal((4000, 2)) + 0.8 * np.sign(speed)[:, None]
    assert not sticking(usable, velocity, acceleration, resolved, inertial, SIGMAS).any()


def test_a_shared_drive_that_sticks_for_a_third_of_the_time_is_no_program():
    """Friction of a shared drive holds two joints together for whole stretches; a program that does leaves no trace."""
    rng = np.random.default_rng(4)
    time = np.arange(4000) / RATE
    velocity = np.stack([np.sin(2.0 * time), np.cos(3.1 * time)], axis=1)
    held = np.cos(0.7 * time) > 0.4
    velocity[held, 1] = -velocity[held, 0]
    acceleration = np.gradient(velocity, 1 / RATE, axis=0)
    usable, inertial = np.ones((4000, 2), dtype=bool), rng.standard_normal((4000, 2, 2))
    speed = velocity.sum(axis=1)
    slow = np.abs(speed) < assumed.STICKS
    assert 0.3 < slow.mean() < 0.5
    noise = 0.02 * rng.standard_normal((4000, 2))
    friction = 0.8 * np.where(slow, rng.uniform(-1, 1, 4000), np.sign(speed))
    stuck = sticking(usable, velocity, acceleration, noise + friction[:, None], inertial, SIGMAS)
    np.testing.assert_array_equal(stuck, np.stack([slow, slow], axis=1))
    assert not sticking(usable, velocity, acceleration, noise, inertial, SIGMAS).any()


def test_samples_beside_reversals_of_a_dragging_neighbour_are_left_out():
    """A filter rounds the jump of a neighbour's friction on a joint that moves on."""
    rng = np.random.default_rng(5)
    velocity, acceleration, usable, inertial = two_joints(rng)
    slow = np.abs(velocity[:, 1]) < assumed.STICKS
    level = np.where(slow, rng.uniform(-1, 1, 4000), np.sign(velocity[:, 1]))
    missing = 0.02 * rng.standard_normal((4000, 2)) + 0.8 * level[:, None] * np.array([1, 0])
    stuck = sticking(usable, velocity, acceleration, missing, inertial, SIGMAS)
    np.testing.assert_array_equal(stuck, np.stack([slow, np.zeros(4000, dtype=bool)], axis=1))


def _with_speeds(white, velocity):
    """A problem in which the joints move at other speeds, for columns of shared drives."""
    problem = replace(white.problem)
    problem.__dict__.update(train_state=replace(white.problem.train_state, velocity=velocity))
    return replace(white, problem=problem)


def _lacking(white, nonlinear):
    """The problem with 4 N m of the friction of a drive on joint 2, and the candidate that says so."""
    candidate = Candidate("drive_coupling", 1, 2, nonlinear)
    torque = 4.0 * raw_columns(white, candidate)[:, 0]
    return replace(white, targets=[y + white.columns(a, torque) * (a == 1) for a, y in enumerate(white.targets)])


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_drive_that_may_turn_with_both_joints_does(white, sense):
    """Friction of a drive acts on a joint that turns it. Where the other joint is always faster, its sense alone says
    the same, and another one in motion to come."""
    own = white.problem.train_state.velocity[:, 1]
    velocity = white.problem.train_state.velocity.copy()
    velocity[:, 2] = np.where(np.arange(len(own)) % 700 < 350, 1.0, -1.0) * (0.2 + np.abs(own))
    faster = _with_speeds(white, velocity)
    dragged = Candidate("drive_coupling", 1, 2, {"own": 0.0, "other": sense})
    lacking = _lacking(faster, dragged.nonlinear)
    found = simplest(lacking, lacking.fit([]), dragged)
    # Against the sense of the other joint friction would drive.
    assert found.nonlinear == {"own": 1.0, "other": sense}


@pytest.mark.parametrize("own", [0.0, 1.0])
def test_a_drive_turns_with_what_the_data_say(white, own):
    candidate = Candidate("drive_coupling", 1, 2, {"own": own, "other": 1.0})
    lacking = _lacking(white, candidate.nonlinear)
    assert simplest(lacking, lacking.fit([]), candidate).nonlinear == candidate.nonlinear


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.05])
def test_inertia_alone_is_no_drive_that_two_joints_share(friction):
    """A motor that spins in the wrist is felt by the joint before it, without any friction."""
    robot = load_robot("config/robots/puma560.yaml")

    def spun(q, v, a, *_):
        full = np.zeros_like(q)
        full[:, 3] = 0.01 * np.cos(q[:, 4]) * a[:, 5] + friction * np.sign(v[:, 3] + v[:, 5])
        full[:, 5] = 0.01 * np.cos(q[:, 4]) * a[:, 3] + friction * np.sign(v[:, 3] + v[:, 5])
        return full

    found = search(whitened(build_problem(split(make_case(robot, 4, spun)), robot, Settings())))
    shared = {(n.candidate.axis, n.candidate.source) for n in found.named if n.candidate.effect == "drive_coupling"}
    assert shared == ({(3, 5), (5, 3)} if friction else set())
    gates = {r.gate for r in found.refusals if r.candidate.effect == "drive_coupling"}
    assert ("nats of its friction" in gates) == (not friction)
