"""A name whose form the data would have beyond the bounds of its parameters is none."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.estimates.forms import companion, form_of
from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.estimates.refine import refine
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate, term_of
from jointwear.discovery.search import taken_back
from jointwear.discovery.search.forms_beyond import nats_beyond, of_another_form

AXIS = 1


def lacking(white, curve):
    """Return the problem in which joint 2 lacks friction that is a curve of its speed."""
    problem = white.problem
    velocity = problem.state.velocity[:, AXIS]
    discrepancy = problem.discrepancy.copy()
    discrepancy[:, AXIS] += curve(np.abs(velocity)) * np.sign(velocity)
    targets = [y.copy() for y in white.targets]
    targets[AXIS] = white.columns(AXIS, discrepancy[problem.train, AXIS])
    return replace(white, problem=replace(problem, discrepancy=discrepancy), targets=targets)


def named(white, exponent):
    """Return viscous friction with an exponent as the search would name it from a start."""
    start = Candidate("nonlinear_viscous_friction", AXIS, None, {"exponent": exponent})
    candidate = refine(white, white.fit(), start)
    return Named(candidate, term_of(white, candidate), companion(white, form_of(white, candidate), 3.0), 1000.0)


def early(speed):
    """Friction that builds up with the speed, as of a clutch that slips, in place of that of the file."""
    return 8.0 * (np.tanh(speed / 0.15) - 1.0)


def test_a_curve_that_an_exponent_within_its_bounds_follows_stays(white):
    true = lacking(white, lambda speed: 4.0 * speed**2)
    one = named(true, 1.5)
    assert one.candidate.nonlinear["exponent"] == pytest.approx(2.0, rel=0.1)
    assert nats_beyond(true, true.fit(), one.candidate) == 0.0
    assert list(of_another_form(true, [one])) == []


def test_a_curve_that_would_have_another_exponent_and_bends_is_of_another_form(white):
    other = lacking(white, early)
    one = named(other, 0.5)
    assert one.candidate.nonlinear["exponent"] == 0.3
    ((found, nats),) = of_another_form(other, [one])
    assert found is one
    assert nats > 0.5 * white.problem.settings.accept
    # What does not bend, or has no form to bend, is what it is at its bound.
    assert list(of_another_form(other, [replace(one, form=None)])) == []


def test_what_has_no_nonlinear_parameter_has_no_bounds(white):
    for candidate in (Candidate(LINK_MASS, AXIS, None), Candidate("payload", None, None)):
        assert nats_beyond(white, None, candidate) == 0.0


@pytest.mark.parametrize("left", [True, False])
def test_it_is_a_suspect_where_structure_is_left_without_it(white, left, monkeypatch):
    other = lacking(white, early)
    one = named(other, 0.5)
    outcome = SimpleNamespace(problem=other.problem, white=other, named=[one], refusals=[], suspects=[], unexplained=[])

    def settle(outcome):
        outcome.unexplained = [SimpleNamespace(axis=AXIS)] if left else []

    monkeypatch.setattr(taken_back, "settle", settle)
    taken_back.believe_no_form_beyond_its_bounds(outcome)
    assert outcome.named == []
    assert all(r.reached < r.needed for r in outcome.refusals)
    assert len(outcome.refusals) == 1
    assert [n for n, _ in outcome.suspects] == ([one] if left else [])
