"""Steps of acceleration between two samples: what is off there follows acceleration, and is no structure."""

from dataclasses import replace

import numpy as np
import pytest
from discovery_cases import make_case

from jointwear.discovery import Settings, discover
from jointwear.discovery.problem.reversals import resolved_motion
from jointwear.discovery.problem.unresolved_steps import at_unresolved_steps
from jointwear.discovery.search.leftovers import lasting, unexplained

AXIS = 1


@pytest.fixture(scope="module")
def outcome(robot):
    """What is found in a log in which nothing is hidden."""
    return discover(make_case(robot, 29, lambda q, v, *_: np.zeros_like(q)), robot, Settings()).final.outcome


def with_corners(outcome, unresolved):
    """The outcome with corners of speed where it accelerates most: a filter rounds them, and the torque is `off`."""
    white = outcome.white
    problem, rows = white.problem, white.whiteners[AXIS].rows
    rate = problem.measured.rate
    measured = replace(
        problem.measured,
        fitted=False,
        cutoff=np.full(problem.robot.joints, 0.45 * rate),
        reach=np.full(problem.robot.joints, (0.3 if unresolved else 0.05) * rate),
    )
    acceleration = problem.train_state.acceleration[:, AXIS]
    corners = np.sort(rows[np.argsort(acceleration[rows])[-60::2]])
    smear = np.zeros_like(problem.smear)
    trained = np.flatnonzero(problem.train)
    smear[trained[corners], AXIS] = 100.0 * white.whiteners[AXIS].marginal
    problem = replace(problem, measured=measured, smear=smear)
    targets = [y.copy() for y in white.targets]
    targets[AXIS][np.searchsorted(rows, corners)] += 8.0
    return replace(outcome, problem=problem, white=replace(white, problem=problem, targets=targets)), corners


@pytest.mark.long
@pytest.mark.parametrize("unresolved", [True, False])
def test_what_is_off_at_corners_that_are_not_resolved_is_no_structure(outcome, unresolved):
    before = {u.axis for u in unexplained(outcome)[0]}
    cornered, _ = with_corners(outcome, unresolved)
    assert resolved_motion(cornered.problem.measured) != unresolved
    cornered.unexplained = unexplained(cornered)[0]
    assert AXIS not in before
    assert (AXIS, "acceleration") in {(u.axis, u.argument) for u in cornered.unexplained}
    assert (AXIS in {u.axis for u in lasting(cornered)}) != unresolved


def test_samples_beside_a_corner_are_left_out_as_far_as_the_filter_reaches(outcome):
    cornered, corners = with_corners(outcome, unresolved=True)
    rows = cornered.white.whiteners[AXIS].rows
    found = set(rows[at_unresolved_steps(cornered.white, AXIS)])
    # Half a period of 0.45 of the rate is two samples.
    assert {c + k for c in corners for k in (-2, -1, 0, 1, 2)} & set(rows) <= found
    assert len(found) < 0.5 * len(rows)
    assert not at_unresolved_steps(cornered.white, AXIS + 1).any()


def test_resolved_motion_has_no_such_steps(outcome):
    cornered, _ = with_corners(outcome, unresolved=False)
    assert not at_unresolved_steps(cornered.white, AXIS).any()


def test_where_most_samples_are_at_corners_none_is_left_out(outcome):
    cornered, _ = with_corners(outcome, unresolved=True)
    problem = cornered.problem
    smear = np.random.default_rng(3).normal(size=problem.smear.shape)
    problem = replace(problem, smear=100.0 * cornered.white.whiteners[AXIS].marginal * smear)
    assert not at_unresolved_steps(replace(cornered.white, problem=problem), AXIS).any()
