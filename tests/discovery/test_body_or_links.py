"""A body at the flange, or links that are not what the robot file says."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings
from jointwear.discovery.acceptance import refusals
from jointwear.discovery.candidates import build_dictionary, raw_blocks
from jointwear.discovery.linear import Term
from jointwear.discovery.outcome import Named
from jointwear.discovery.problem import build_problem
from jointwear.discovery.saturated import estimate_noise
from jointwear.discovery.whitening import whiten
from jointwear.effects import get_effect
from jointwear.measurement.recording import split
from jointwear.robots.robot import load_robot

OVER_LINKS = "nats over links that are known less"


@pytest.fixture(scope="module")
def bare():
    robot = load_robot("config/robots/puma560.yaml")
    recording = split(make_case(robot, 23, lambda q, v, *_: np.zeros_like(q)))
    problem = build_problem(recording, robot, Settings())
    return problem, estimate_noise(problem)


def gates(bare, torque):
    """Return the gates that a load misses on a log in which `torque` (N_train, n) [N m] is not the model's."""
    problem, whiteners = bare
    discrepancy = problem.discrepancy.copy()
    discrepancy[problem.train] += torque
    white = whiten(replace(problem, discrepancy=discrepancy), whiteners)
    candidate, blocks, std = next(x for x in build_dictionary(white).whole if x[0].effect == "payload")
    trial = Named(candidate, Term("payload", blocks, std, raw_blocks(white, candidate)), None, 1000.0)
    return [r.gate for r in refusals(white, [], trial)]


def of_body(problem, mass):
    columns = get_effect("payload").columns(problem.train_state, 0, None, {})
    return columns[..., 0] * mass + columns[..., 3] * 0.08 * mass


def test_a_body_that_the_last_link_would_have_to_be_several_times_of_is_one(bare):
    assert gates(bare, of_body(bare[0], 0.6)) == []


@pytest.mark.parametrize("seed", range(3))
def test_a_table_of_links_that_are_off_is_no_body(bare, seed):
    problem = bare[0]
    off = 4.0 * np.random.default_rng(seed).standard_normal(problem.factor.shape[1])
    assert OVER_LINKS in gates(bare, problem.inertial[problem.train] @ off)


def test_nothing_is_no_body(bare):
    assert OVER_LINKS in gates(bare, np.zeros_like(bare[0].discrepancy[bare[0].train]))
