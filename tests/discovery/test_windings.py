"""A gear that stiffens has not the name of one that does not, nor has what its wind-up does further out."""

import numpy as np
import pytest
from test_rocking import outcome_of

from jointwear.discovery.estimates.outcome import Named, Unexplained
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.search.windings import stiffens, wind_up_of, wound_up_further_in
from jointwear.effects.swing import torque_of, wind_up

AXIS, INERTIA, STIFFNESS, DAMPING = 1, 3.0, 4000.0, 0.05
NONLINEAR = {"inertia_over_stiffness": INERTIA / STIFFNESS, "inertia": INERTIA, "side": 1, "damping": DAMPING}


def lag(white, change):
    """Return the torques (m, n) of a link behind a gear whose stiffness changes with the square of its load."""
    state = white.problem.train_state
    slopes = by_acceleration, _, by_angle = state.wind_up_regressor(AXIS)
    load, inertia = state.load[:, AXIS], by_acceleration[:, AXIS]
    more = change * STIFFNESS * (load**2 / np.mean(load**2) - 1.0)
    drag = 2 * DAMPING * np.sqrt(STIFFNESS * INERTIA)
    return -torque_of(wind_up(state, load, inertia, STIFFNESS, drag, by_angle[:, AXIS] + more), slopes, AXIS)


def named(white, candidate, torques):
    """Return an effect on all joints that its torques (m, n) move, with the strength that the tests need."""
    blocks = {a: white.columns(a, torques[:, [a]]) for a in white.problem.judged if np.any(torques[:, a])}
    raw = {a: white.raw(a, torques[:, [a]]) for a in blocks}
    return Named(candidate, Term("one", blocks, np.ones(1), raw), None, 100.0)


@pytest.mark.parametrize("change", [0.0, 0.3])
def test_a_stiffness_that_changes_with_the_load_shows(white, change):
    outcome = outcome_of(white, lag(white, change))
    one = named(white, Candidate("joint_flexibility", AXIS, None, NONLINEAR), lag(white, 0.0))
    outcome.named, outcome.fit = [one], outcome.white.fit(one.terms)
    found = stiffens(outcome, one)
    assert found is None if not change else found == pytest.approx(change, abs=0.15)


def test_a_spring_that_the_wind_up_of_a_joint_further_in_stands_for_is_told(white):
    torques = np.zeros_like(white.problem.train_state.position)
    torques[:, 2] = lag(white, 0.0)[:, 2]
    own = np.zeros_like(torques)
    own[:, 2] = 20.0 * np.sin(3 * white.problem.train_state.position[:, 2])
    spring = Candidate("joint_spring", 2, None, {"centre": 0.0, "low": -9.0, "high": 9.0})
    for torque, inner in ((torques, AXIS), (own, None)):
        outcome = outcome_of(white, torque)
        outcome.unexplained = [Unexplained(AXIS, "position", "rad", 0.0, 1.0, 1e-12, 50.0)]
        one = named(white, spring, torque)
        outcome.named, outcome.fit = [one], outcome.white.fit(one.terms)
        assert wound_up_further_in(outcome, one) == inner
        outcome.unexplained = []
        assert wound_up_further_in(outcome, one) is None


def test_the_wind_up_of_an_upright_joint_moves_no_gravity(white):
    """Of a heavy arm what is zero, but for rounding, had a prior without an end: no verdict came of it."""
    outcome = outcome_of(white, np.zeros_like(white.problem.train_state.position))
    columns = [wind_up_of(outcome, inner, 2).raw[2].shape[1] for inner in (0, AXIS)]
    assert columns == [1, 2]
