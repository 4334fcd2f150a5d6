"""What one joint lacks is not believed on the word of a joint that is itself unexplained."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import trial_of

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.search import acceptance, taken_back
from jointwear.discovery.search.acceptance import nats_without_witnesses

TURNTABLE, SHOULDER, ELBOW, WRIST = 0, 1, 2, 5


GAIN = "torque_constant_error", {}
SPRING = "joint_spring", {"centre": 0.0, "low": -9.0, "high": 9.0}


def _gain(white, axis=ELBOW, effect=GAIN):
    identifier, nonlinear = effect
    return trial_of(white, identifier, axis, nonlinear)


def _bent(white):
    """The shoulder asks for the links that the elbow would have if its own torque were 5 % less than it is."""
    links = next(t for t in white.base if t.label == INERTIAL)
    own = _gain(white).term.blocks[ELBOW]
    wanted = np.linalg.lstsq(links.blocks[ELBOW], own[:, 0], rcond=None)[0]
    targets = list(white.targets)
    targets[SHOULDER] = targets[SHOULDER] + 0.05 * links.blocks[SHOULDER] @ wanted
    return replace(white, targets=targets)


def _outcome(white, one, unexplained):
    left = [SimpleNamespace(axis=a) for a in unexplained]
    return Outcome(white.problem, white, None, None, named=[one], unexplained=left)


@pytest.fixture(scope="module")
def bent(white):
    return _bent(white)


@pytest.fixture(scope="module")
def wrong(white):
    own = _gain(white).term.blocks[ELBOW][:, 0]
    return replace(white, targets=[y + 0.07 * own if a == ELBOW else y for a, y in enumerate(white.targets)])


def test_links_that_one_axis_bends_feign_a_gain_of_another(bent):
    half = 0.5 * bent.problem.settings.accept
    assert nats_without_witnesses(bent, [], _gain(bent), ()) > half
    assert nats_without_witnesses(bent, [], _gain(bent), {SHOULDER}) < half


@pytest.mark.parametrize(
    ("of_data", "axes", "stays"), [("bent", {SHOULDER}, False), ("bent", {WRIST}, True), ("wrong", {WRIST}, True)]
)
def test_such_a_gain_is_taken_back_where_that_axis_stays_unexplained(of_data, axes, stays, request, monkeypatch):
    white = request.getfixturevalue(of_data)
    settled = []
    monkeypatch.setattr(taken_back, "settle", settled.append)
    outcome = _outcome(white, _gain(white), axes)
    taken_back.believe_no_bent_links(outcome)
    assert bool(outcome.named) == stays
    assert len(settled) == len(outcome.refusals) == (not stays)


def test_a_spring_that_makes_up_for_links_that_are_bent_is_taken_back_too(bent, monkeypatch):
    """Friction of a turntable by the moment on it had bent the links, and a spring of 19 nats behind it got a name."""
    monkeypatch.setattr(taken_back, "settle", lambda outcome: None)
    spring = _gain(bent, effect=SPRING)
    assert nats_without_witnesses(bent, [], spring, ()) > 0.5 * bent.problem.settings.accept
    outcome = _outcome(bent, spring, {SHOULDER})
    taken_back.believe_no_bent_links(outcome)
    assert not outcome.named


def test_its_own_axis_is_asked_all_the_same(bent):
    outcome = _outcome(bent, _gain(bent), {ELBOW})
    taken_back.believe_no_bent_links(outcome)
    assert outcome.named


@pytest.mark.parametrize(
    ("unexplained", "stays"),
    [({SHOULDER}, True), ({4, WRIST}, True), ({3, 4, WRIST}, False), ({TURNTABLE, 4, WRIST}, True)],
)
def test_a_gain_is_more_than_heavier_links_where_half_of_the_others_stay_unexplained(
    white, unexplained, stays, monkeypatch
):
    """A link of another length changes many joints; the first, which no gravity loads, then looks like a gain."""
    monkeypatch.setattr(taken_back, "settle", lambda outcome: None)
    own = _gain(white, TURNTABLE).term.blocks[TURNTABLE][:, 0]
    off = replace(white, targets=[y + 0.07 * own if a == TURNTABLE else y for a, y in enumerate(white.targets)])
    outcome = _outcome(off, _gain(off, TURNTABLE), unexplained)
    taken_back.believe_no_bent_links(outcome)
    assert bool(outcome.named) == stays


def test_a_spring_of_one_axis_keeps_its_name_where_half_of_the_others_stay_unexplained(white, monkeypatch):
    """Heavier links are no spring: what is asked of a factor of all torque is not asked of it."""
    monkeypatch.setattr(taken_back, "settle", lambda outcome: None)
    own = _gain(white, effect=SPRING).term.blocks[ELBOW][:, 0]
    off = replace(white, targets=[y + 40.0 * own if a == ELBOW else y for a, y in enumerate(white.targets)])
    outcome = _outcome(off, _gain(off, effect=SPRING), {TURNTABLE, SHOULDER, WRIST})
    taken_back.believe_no_bent_links(outcome)
    assert outcome.named


def test_what_another_axis_lacks_and_has_in_the_model_makes_no_effect_cancel(bent):
    """It bends the links as long as it has no name; beside its name the discrepancy of this axis is asked alone."""
    gain = _gain(bent)
    nothing = replace(bent, targets=[0.0 * y for y in bent.targets])
    shoulder = bent.targets[SHOULDER][:, None]
    term = Term("of the shoulder", {SHOULDER: shoulder}, np.array([10.0]), {})
    own = Term("of the elbow", {ELBOW: gain.term.blocks[ELBOW]}, np.array([10.0]), {})
    assert acceptance._cancels(bent, [], gain) > 2.0 > acceptance._cancels(bent, [term], gain)
    # What it would cancel may be a term of its own axis: that does not stand beside it.
    assert acceptance._cancels(bent, [own], gain) == acceptance._cancels(bent, [], gain)
    assert acceptance._cancels(nothing, [], gain) < 2.0


@pytest.mark.parametrize(("off", "stays"), [(0.1, True), (0.6, False)])
def test_a_gain_of_a_load_that_links_correct_by_a_large_share_is_not_believed(wrong, off, stays, monkeypatch):
    """How much a torque is off is known no better than the load."""
    settled = []
    monkeypatch.setattr(taken_back, "settle", settled.append)
    one = _gain(wrong)
    links = next(t for t in wrong.base if t.label == INERTIAL)
    fit = wrong.fit([one.term])
    # Links that are all too light by the same share.
    load = wrong.problem.inertial[wrong.problem.train] @ wrong.directions_of(links)
    far = np.linalg.lstsq(load[:, ELBOW], off * wrong.problem.train_state.load[:, ELBOW], rcond=None)[0]
    fit.theta[fit.where(INERTIAL)] = far
    outcome = replace(_outcome(wrong, one, ()), fit=fit)
    taken_back.believe_no_unknown_loads(outcome)
    assert bool(outcome.named) == stays
    assert len(settled) == len(outcome.refusals) == (not stays)
    assert all(r.reached < r.needed for r in outcome.refusals)
