"""A body at the flange, or links that are not what the robot file says."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.linear import Term, gain
from jointwear.discovery.problem.candidates import build_dictionary, raw_blocks
from jointwear.discovery.problem.whitening import INERTIAL, whiten
from jointwear.discovery.search.acceptance import refusals
from jointwear.discovery.search.body_or_links import nats_of_links
from jointwear.effects import get_effect
from jointwear.robots.inertia import bodies, matrix_of_six, parameters_of_body, reach_of_link
from jointwear.robots.robot import load_robot

OVER_LINKS, MASS = "nats over links that are known less", "nats of its mass"


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
    return columns @ parameters_of_body(mass, np.array([0.0, 0.0, 0.08]), 1e-3 * mass * np.eye(3))


def test_a_body_that_the_last_link_would_have_to_be_several_times_of_is_one(bare):
    assert gates(bare, of_body(bare[0], 0.6)) == []


def test_a_body_of_half_the_last_link_is_one_where_all_other_links_are_as_known_as_said(bare):
    """As 0.7 and 1.2 kg on two Pandas, whose last links weigh 1.5 kg (bench 31): links that are all known less well
    would have said it as well."""
    assert gates(bare, of_body(bare[0], 0.05)) == []


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_a_table_of_links_that_are_off_is_no_body(bare, seed):
    problem = bare[0]
    off = 4.0 * np.random.default_rng(seed).standard_normal(problem.factor.shape[1])
    assert OVER_LINKS in gates(bare, problem.inertial[problem.train] @ off)


def test_nothing_is_no_body(bare):
    assert OVER_LINKS in gates(bare, np.zeros_like(bare[0].discrepancy[bare[0].train]))


@pytest.mark.long
def test_a_last_link_whose_centre_is_off_is_no_body(bare):
    """A payload without a mass is none: with one, or off by more than the link is long, it is."""
    problem = bare[0]
    columns = get_effect("payload").columns(problem.train_state, 0, None, {})
    mass, com, inertia = bodies(problem.robot)[-1]
    reach = reach_of_link(mass, com, inertia)
    for share, expected in ((0.3, True), (3.0, False)):
        moved = parameters_of_body(mass, com + share * reach * np.eye(3)[0], inertia)
        missed = gates(bare, columns @ (moved - parameters_of_body(mass, com, inertia)))
        assert (MASS in missed) == expected
    assert MASS not in gates(bare, of_body(problem, 0.6))


def test_what_no_body_does_is_no_body(bare):
    """Inertia without mass, and of the wrong sign: what friction of a neighbour left of a wrist (world_2013)."""
    problem = bare[0]
    columns = get_effect("payload").columns(problem.train_state, 0, None, {})
    torque = columns[..., 4:] @ np.array([-0.03, 0.0, -0.02, 0.02, 0.0, -0.03])
    assert "nats that no body that may exist would have" in gates(bare, torque)


@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 999))
def test_the_nearest_body_is_one(seed):
    """Its pseudo-inertia has no negative eigenvalue, and a body that may exist stays what it is."""
    rng = np.random.default_rng(seed)
    robot, nearest = load_robot("config/robots/puma560.yaml"), get_effect("payload").nearest
    factor = rng.standard_normal((10, 10))
    precision = factor @ factor.T + 0.1 * np.eye(10)
    own = parameters_of_body(*bodies(robot)[-1])
    inertia = np.diag([1.0, 1.0, 0.5]) * rng.uniform(0.001, 0.01)
    sound = parameters_of_body(rng.uniform(0.1, 2.0), rng.uniform(-0.1, 0.1, 3), inertia)
    np.testing.assert_array_equal(nearest(robot, sound, precision), sound)
    found = nearest(robot, rng.standard_normal(10) * 0.1 + [0.5, *[0.0] * 9], precision) + own
    spread = matrix_of_six(found[4:])
    pseudo = np.block(
        [[0.5 * np.trace(spread) * np.eye(3) - spread, found[1:4, None]], [found[None, 1:4], found[None, :1]]]
    )
    assert np.linalg.eigvalsh(pseudo)[0] > -1e-9 * np.abs(pseudo).max()


@pytest.mark.parametrize(("share", "counts"), [(0.5, True), (-0.5, True), (0.7, False), (-0.7, False)])
def test_links_are_known_less_only_as_far_as_a_mass_may_be_wrong(white, share, counts):
    """A body of most of the last link is a body, however well a table of links that are all off would say it."""
    problem, links = white.problem, next(t for t in white.base if t.label == INERTIAL)
    masses = np.array([body[0] for body in bodies(problem.robot)])
    change = problem.factor[::10] @ white.directions
    theta = np.linalg.pinv(change) @ np.where(np.arange(len(masses)) == len(masses) - 1, share * masses, 0.0)
    gram = 1e9 * np.eye(len(theta))
    said, wide = (gain(gram @ theta, gram, k * links.std) for k in (1.0, problem.settings.mass_sigmas))
    assert wide > said
    assert nats_of_links(white, links.std, gram @ theta, gram) == (wide if counts else said)
