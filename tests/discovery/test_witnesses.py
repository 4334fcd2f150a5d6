"""What one joint lacks is not believed on the word of a joint that is itself unexplained."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import trial_of

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.whitening import INERTIAL
from jointwear.discovery.search import taken_back
from jointwear.discovery.search.acceptance import nats_without_witnesses

SHOULDER, ELBOW, WRIST = 1, 2, 5


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
