"""What a robot file says of a bent spring where no sample lies between those that were seen."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery.estimates.forms import Form, changed_in_holes
from jointwear.discovery.estimates.largest_torque import Fitted
from jointwear.discovery.model.augment import entries_of
from jointwear.discovery.problem.candidates import Candidate
from jointwear.effects import get_effect
from jointwear.effects.holes import stretches_of, weakest_in_holes
from jointwear.effects.tables import hats, knots_of

LAW = get_effect("joint_spring").bend.law
TRAVEL = {"centre": 0.0, "low": -2.0, "high": 2.0}


def spring(stiffness=0.0, quadratic=0.0, cubic=0.0, preload=0.0, table=((-6.0, 6.0), (0.0, 0.0))):
    powers = {"stiffness": stiffness, "quadratic": quadratic, "cubic": cubic, "preload": preload}
    return {**TRAVEL, **powers, "correction": {"knots": np.array(table[0]), "values": np.array(table[1])}}


def torque(parameters, q):
    table = parameters["correction"]
    return LAW(parameters, np.asarray(q)) + np.interp(q, table["knots"], table["values"])


def test_a_hole_is_wider_than_the_table_resolves():
    seen = np.concatenate([np.linspace(-2.0, -1.0, 50), np.linspace(0.5, 2.0, 50)])
    knots = np.linspace(-2.0, 2.0, 6)
    assert stretches_of(seen, knots) == ((-2.0, -1.0), (0.5, 2.0))
    assert stretches_of(np.linspace(-2.0, 2.0, 50), knots) == ((-2.0, 2.0),)
    assert len(stretches_of(seen, np.array([-2.0, 2.0]))) == 1


def test_a_wall_that_was_told_as_a_spring_pulls_at_nothing_in_between():
    """The wall is seen on one side, nothing on the other; the fit through both has no reason to be nothing between."""
    q = np.concatenate([np.linspace(-2.0, -1.5, 300), np.linspace(0.5, 2.0, 300)])
    true = -8.0 * np.maximum(-1.6 - q, 0.0)
    knots = knots_of(q, 6)
    columns = np.concatenate([np.stack([q, q**2, q**3, np.ones(len(q))], axis=1), hats(q, knots)], axis=1)
    c = np.linalg.solve(columns.T @ columns + 1e-3 * np.eye(10), columns.T @ true)
    fitted = spring(*c[:4], table=([-6.0, *knots, 6.0], [c[4], *c[4:], c[-1]]))
    written = weakest_in_holes(fitted, LAW, stretches_of(q, knots))
    between = np.linspace(-1.2, 0.4, 40)
    made_up = np.abs(torque(fitted, between)).max()
    assert made_up > 0.5
    assert np.abs(torque(written, between)).max() < 0.25 * made_up
    assert torque(written, q) == pytest.approx(torque(fitted, q), abs=1e-9)


def test_a_straight_spring_goes_through_a_hole_as_it_is():
    fitted = spring(stiffness=1.5, preload=4.0)
    q = np.linspace(-2.0, 2.0, 81)
    assert torque(weakest_in_holes(fitted, LAW, ((-2.0, -1.0), (0.5, 2.0))), q) == pytest.approx(torque(fitted, q))


@given(
    st.lists(st.floats(-2.0, 2.0), min_size=4, max_size=4),
    st.lists(st.floats(-3.0, 3.0), min_size=5, max_size=5),
    st.floats(-1.4, -0.6),
    st.floats(0.6, 1.4),
)
def test_in_no_hole_is_more_torque_than_was_fitted_and_none_changes_outside(powers, values, low, high):
    fitted = spring(*powers, table=(np.linspace(-6.0, 6.0, 5), values))
    written = weakest_in_holes(fitted, LAW, ((-2.0, low), (high, 2.0)))
    knots = written["correction"]["knots"]
    assert np.all(np.diff(knots) > 0.0)
    inside = knots[(knots > low) & (knots < high)]
    assert np.all(np.abs(torque(written, inside)) <= np.abs(torque(fitted, inside)) + 1e-9)
    outside = np.concatenate([np.linspace(-5.0, low, 30), np.linspace(high, 5.0, 30)])
    assert torque(written, outside) == pytest.approx(torque(fitted, outside), abs=1e-9)


def test_the_entry_of_a_robot_file_is_weak_in_holes_that_training_leaves():
    knots, values = np.linspace(-2.0, 2.0, 6), np.array([3.0, 0.0, -2.0, -2.0, 0.0, 0.0])
    parameters = {k: v for k, v in spring().items() if k != "correction"}
    state = SimpleNamespace(part=lambda _: SimpleNamespace(position=np.zeros((2, 1))))
    candidate, coefficients = Candidate("joint_spring", 0, None, TRAVEL), np.concatenate([np.zeros(4), values])

    def correction(seen):
        form = Form(candidate, knots, seen)
        estimate = SimpleNamespace(
            named=SimpleNamespace(candidate=candidate), parameters=parameters, form=form, coefficients=coefficients
        )
        (entry,) = entries_of(estimate, state)
        table = entry["parameters"]["correction"]
        return np.interp([-1.8, 0.0, 1.8], table["knots"], table["values"])

    assert correction(((-2.0, 2.0),)) == pytest.approx([2.25, -2.0, 0.0])
    # The sides say nothing of -2 N m between them.
    assert correction(((-2.0, -1.2), (1.2, 2.0))) == pytest.approx([2.25, 0.0, 0.0], abs=1e-9)


def test_the_largest_torque_of_a_verdict_is_that_of_the_file_in_a_hole():
    knots, values = np.linspace(-2.0, 2.0, 6), np.array([3.0, 0.0, -2.0, -2.0, 0.0, 0.0])
    parameters = {k: v for k, v in spring().items() if k != "correction"}
    at = np.array([[-1.8], [0.0], [1.8]])
    state = SimpleNamespace(position=at, velocity=np.ones((3, 1)))
    candidate = Candidate("joint_spring", 0, None, TRAVEL)
    more = changed_in_holes(Form(candidate, knots, ((-2.0, -1.2), (1.2, 2.0))), parameters, values, state)
    assert more == pytest.approx([0.0, 2.0, 0.0], abs=1e-9)
    whole = Form(candidate, knots, ((-2.0, 2.0),))
    assert changed_in_holes(whole, parameters, values, state) == pytest.approx(np.zeros(3))
    fitted = Fitted(candidate, Form(candidate, knots, ((-2.0, -1.2), (1.2, 2.0))), *_numbers(values, parameters))
    assert fitted.torque(state)[1] == pytest.approx(0.0, abs=1e-9)


def _numbers(values, parameters):
    coefficients = np.concatenate([np.zeros(4), values])
    return coefficients, np.eye(10), 4, parameters, {}, {}, 0.0
