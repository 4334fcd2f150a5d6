"""A hose or the wind pulls at the flange: no effect of the library is named for it, a tilted base least of all."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.linear import gain
from jointwear.discovery.problem.candidates import build_dictionary
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.search.outside_force import force_beside, force_in_words, outside_force
from jointwear.discovery.search.outside_force import force_term as term_of_force
from jointwear.discovery.search.searches import search
from jointwear.robots.inertia import gravity_regressor
from jointwear.robots.robot import Link

FORCE = np.array([9.0, -4.0, 3.0])


def white_with(bare, torque):
    """Return a log whitened on which `torque` (N, n) [N m] is added."""
    problem, whiteners = bare
    return whiten(replace(problem, discrepancy=problem.discrepancy + torque), whiteners)


def pull(problem, force):
    """Return the torque (N, n) [N m] that holds a force (3,) [N] at the flange, by virtual work."""
    loaded = replace(problem.robot, payload=Link(1.0, np.zeros(3), np.zeros((3, 3))))
    position = problem.state.position
    return (gravity_regressor(loaded, position) - gravity_regressor(problem.robot, position)) @ force


def test_a_force_at_the_flange_names_nothing_and_is_told(bare):
    swell = 1.0 + 0.2 * np.sin(0.7 * bare[0].state.time)[:, None]
    outcome = search(white_with(bare, swell * pull(bare[0], FORCE)))
    assert outcome.named == []
    assert outcome.unexplained
    # Up and down is what links that are a little off do as well.
    assert np.all(np.abs(outcome.force[:3] - FORCE) < [1.0, 1.0, 6.0])
    assert "force of 10 N at the flange, (9, -4, 3) N" in force_in_words(np.append(FORCE, 0.5))


def test_a_tilted_base_is_no_force(bare):
    problem = bare[0]
    tilt = gravity_regressor(problem.robot, problem.state.position) @ np.array([0.3, 0.2, 0.0])
    white = white_with(bare, tilt)
    assert outside_force(white, build_dictionary(white)) is None
    named = search(white).named
    assert [n.candidate.effect for n in named] == ["mounting_tilt"]
    assert force_beside(white, named) is None


@pytest.mark.long
def test_a_rope_that_turns_with_the_pose_is_no_tilt(bare):
    """It looks more like a tilted base than like a force that stays the same, but beside the tilt the force shows."""
    problem = bare[0]
    lean = gravity_regressor(problem.robot, problem.state.position) @ np.array([0.25, 0.1, 0.0])
    rope = lean + 0.1 * pull(problem, FORCE)
    white = white_with(bare, rope)
    assert outside_force(white, build_dictionary(white)) is None
    outcome = search(white)
    assert [n.candidate.effect for n in outcome.named] == []
    assert outcome.unexplained
    assert outcome.force is not None


def test_a_hose_that_is_fixed_somewhere_pulls_the_harder_the_further_off_it_is(bare):
    problem = bare[0]
    place, _ = problem.dynamics.forward_kinematics(problem.state.position)
    held = np.array([0.4, -0.3, 1.2])
    hose = np.einsum("tij,tj->ti", pull(problem, np.eye(3)), 30.0 * (held - place))
    outcome = search(white_with(bare, hose))
    assert outcome.named == []
    assert outcome.force[3] == pytest.approx(30.0, rel=0.1)
    assert "that grows by 30 N/m against the motion of the flange" in force_in_words(np.append(FORCE, 30.0))


def test_what_a_large_tilt_leaves_of_its_form_is_no_force(bare):
    """Beside a tilt of many nats a force of few stands for what links that are off make of gravity."""
    problem = bare[0]
    tilt = gravity_regressor(problem.robot, problem.state.position) @ np.array([0.3, 0.2, 0.0])
    white = white_with(bare, tilt + 0.03 * pull(problem, FORCE))
    outcome = search(white)
    assert [n.candidate.effect for n in outcome.named] == ["mounting_tilt"]
    assert outcome.force is None
    alone = white.fit([t for n in outcome.named for t in n.terms])
    term = term_of_force(white)
    nats = gain(*alone.gram(term.blocks), term.std)
    assert white.problem.settings.accept < nats < white.problem.settings.form_error * outcome.named[0].evidence


def test_nothing_is_no_force(bare):
    white = white_with(bare, np.zeros_like(bare[0].discrepancy))
    assert outside_force(white, build_dictionary(white)) is None
