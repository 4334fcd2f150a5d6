"""A PUMA in which nothing is hidden, as discovery sees it, with fine and with coarse positions."""

import numpy as np
import pytest
from discovery_cases import coarse, make_case, wave

from jointwear.discovery import Settings, discover
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot


@pytest.fixture(scope="session")
def robot():
    """The robot itself."""
    return load_robot("config/robots/puma560.yaml")


@pytest.fixture(scope="session")
def bare(robot):
    """The problem, and the noise of its axes."""
    recording = split(make_case(robot, 23, lambda q, v, *_: np.zeros_like(q)))
    problem = build_problem(recording, robot, Settings())
    return problem, estimate_noise(problem)


@pytest.fixture(scope="session")
def white(bare):
    """The problem with the noise of its axes whitened."""
    return whiten(*bare)


@pytest.fixture(scope="session")
def rough(robot):
    """A problem, whitened, with positions so coarse that every axis needs instruments."""
    recording = split(coarse(robot, step=2 * np.pi / 2**13))
    problem = build_problem(recording, robot, Settings())
    return whiten(problem, estimate_noise(problem))


@pytest.fixture(scope="session")
def rooted(robot):
    """Friction of joint 3 that grows with the root of the speed in place of the viscous friction of the robot file."""

    def root(q, v, *_):
        full = np.zeros_like(q)
        full[:, 2] = 4.0 * np.sqrt(np.abs(v[:, 2])) * np.sign(v[:, 2]) - robot.viscous[2] * v[:, 2]
        return full

    return discover(make_case(robot, 22, root), robot, Settings())


@pytest.fixture(scope="session")
def case(robot):
    """A recording of the robot with a wave of torque over a joint."""
    return make_case(robot, 21, wave)


@pytest.fixture(scope="session")
def found(case, robot):
    """The answer on it, its trajectories in two groups."""
    groups = (("monday", (0,)), ("tuesday", (1, 2)))
    return discover(case, robot, Settings(groups=groups))
