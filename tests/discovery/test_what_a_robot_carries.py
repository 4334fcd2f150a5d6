"""A body that the robot carries: part of the load of its axes, and as large as it is found to be."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings
from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import build_dictionary, raw_blocks
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search.carried import carrying
from jointwear.measurement.recording import split
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import wind_up_regressor
from jointwear.robots.robot import Link, load_robot


def robots(mass):
    robot = load_robot("config/robots/puma560.yaml")
    lever = np.array([0.02, -0.03, 0.25])
    about = mass * np.diag([0.03, 0.035, 0.02])
    return robot, replace(robot, payload=Link(mass, lever, about))


def whitened_case(mass):
    robot, loaded = robots(mass)
    problem = build_problem(split(make_case(loaded, 31)), robot, Settings())
    return whiten(problem, estimate_noise(problem))


def outcome_of(white, dictionary):
    candidate, blocks, std = next(x for x in dictionary.whole if x[0].effect == "payload")
    term = Term("payload", blocks, std, raw_blocks(white, candidate))
    fit = white.fit([term])
    named = [Named(candidate, term, None, 1000.0)]
    return Outcome(white.problem, white, fit, dictionary, named=named), fit.theta[fit.slices[-1]]


@pytest.fixture(scope="module")
def heavy():
    return whitened_case(12.0)


@pytest.mark.long
def test_a_heavy_body_is_not_drawn_to_a_usual_one(heavy):
    outcome, first = outcome_of(heavy, build_dictionary(heavy))
    loaded = carrying(outcome)
    again = whiten(loaded, estimate_noise(loaded))
    _, second = outcome_of(again, build_dictionary(again))
    inertia = 12.0 * (0.03 + 0.03**2 + 0.25**2)
    assert second[4] == pytest.approx(inertia, rel=0.05)
    assert abs(second[4] - inertia) < 0.5 * abs(first[4] - inertia)
    assert second[0] == pytest.approx(12.0, rel=0.05)


def test_a_body_is_part_of_the_load(heavy):
    outcome, _ = outcome_of(heavy, build_dictionary(heavy))
    loaded = carrying(outcome)
    measured = heavy.problem.measured.torque
    usable = heavy.problem.measured.usable[:, 1]

    def miss(problem):
        return np.sqrt(np.mean((measured - problem.state.torque)[usable, 1] ** 2))

    assert miss(loaded) < 0.05 * miss(heavy.problem)
    assert np.array_equal(loaded.discrepancy, heavy.problem.discrepancy)
    shift = loaded.state.torque - heavy.problem.state.torque
    assert np.allclose(loaded.state.load - heavy.problem.state.load, shift)


def test_a_gear_twists_by_the_inertia_and_the_weight_of_the_body_too(heavy):
    """The stiffness of a gear of 4,940 N m/rad behind 1.2 kg that were found was told without them."""
    outcome, _ = outcome_of(heavy, build_dictionary(heavy))
    state = carrying(outcome).state
    bare, true = (
        wind_up_regressor(Dynamics(robot), state.position, state.velocity, state.acceleration)(1)
        for robot in robots(12.0)
    )
    for found, without, with_body in zip(state.wind_up_regressor(1), bare, true, strict=True):
        assert np.abs(found - with_body).max() < 0.1 * np.abs(without - with_body).max()


def test_a_light_body_that_explains_all_changes_nothing():
    white = whitened_case(0.4)
    outcome, _ = outcome_of(white, build_dictionary(white))
    assert carrying(outcome) is None
