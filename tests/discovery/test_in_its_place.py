"""A name that only comes close to what structure over one argument explains in its place."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.whitening import White
from jointwear.discovery.search import standing_alone
from jointwear.discovery.search.in_its_place import Place, better_in_its_place, place_of
from jointwear.discovery.search.standing_alone import stand_alone


def _outcome(white, axis, candidate, torque):
    """Return an outcome in which an effect of one joint has a name, and the joint lacks a torque (N_train,) [N m]."""
    columns = raw_columns(white, candidate)
    width = columns.shape[1]
    term = Term(
        candidate.effect, {axis: white.columns(axis, columns)}, np.full(width, 20.0), {axis: white.raw(axis, columns)}
    )
    extra = white.columns(axis, torque[:, None])[:, 0]
    targets = [y + extra if a == axis else y for a, y in enumerate(white.targets)]
    asked = replace(white, targets=targets)
    return Outcome(asked.problem, asked, asked.fit([term]), None, named=[Named(candidate, term, None, 99.0)])


SPRING = Candidate("joint_spring", 2, None, {"centre": 0.0, "low": -9.0, "high": 9.0})


@pytest.mark.parametrize("between", [False, True])
def test_a_hose_between_two_joints_is_no_spring_of_one(white, between):
    position = white.problem.train_state.position
    mean = position.mean(axis=0)
    q, p = position[:, 2] - mean[2], position[:, 1] - mean[1]
    outcome = _outcome(white, 2, SPRING, 20.0 * (q * p if between else q) + 5.0 * q)
    found = better_in_its_place(outcome, outcome.named[0])
    assert (found is not None) == between
    if between:
        basis, axis, lead = found
        assert (basis.argument, axis) == ("position x position of joint 2", 2)
        assert lead > 9.0
        stand_alone(outcome)
        assert not outcome.named
        assert "position x position of joint 2" in outcome.suspects[0][1]


@pytest.mark.parametrize("share", [0.0, 0.03, 0.3])
def test_a_form_that_is_off_keeps_its_name(white, share):
    """What structure over the argument of the effect itself does better is the form."""
    q = white.problem.train_state.position[:, 2]
    outcome = _outcome(white, 2, SPRING, 40.0 * q * (1.0 + share * np.sin(3.0 * q)))
    assert better_in_its_place(outcome, outcome.named[0]) is None


def test_a_torque_signal_that_is_blind_around_zero_is_no_friction(white):
    torque = white.problem.train_state.torque[:, 1]
    outcome = _outcome(
        white, 1, Candidate("stribeck_friction", 1, None, {"speed": 0.1, "exponent": 2.0}), -np.clip(torque, -4.0, 4.0)
    )
    basis, axis, _ = better_in_its_place(outcome, outcome.named[0])
    assert (basis.argument, axis) == ("torque", 1)


@pytest.mark.parametrize("height", [0.0, 0.04])
def test_what_stands_for_all_of_a_name_leaves_nothing_to_explain_in_its_place(white, monkeypatch, height):
    """Noise of accelerations may take off a torque what a gain does: the tolerance of the name is then all price.

    What is there beside the name is something else.
    """
    p, q = white.problem.train_state.position[:, 1:3].T
    columns = raw_columns(white, SPRING)
    outcome = _outcome(white, 2, SPRING, 40.0 * (q - q.mean()) + height * np.sin(3.0 * p))
    all_of_it = Term(
        "attenuation 2", {2: white.columns(2, columns)}, np.full(columns.shape[1], 50.0), {2: white.raw(2, columns)}
    )
    monkeypatch.setattr(White, "attenuation", [all_of_it])
    assert better_in_its_place(outcome, outcome.named[0]) is None


@pytest.mark.parametrize("noise", [False, True])
def test_nothing_takes_the_place_of_a_strong_name_that_noise_may_take(white, noise, monkeypatch):
    """Structure of 16 nats was ahead of a torque constant of 412,684 that noise could have taken off the inertias."""
    q = white.problem.train_state.position[:, 2]
    outcome = _outcome(white, 2, SPRING, 40.0 * (q - q.mean()))
    (one,) = outcome.named
    # What noise takes follows the same columns, and may be any size.
    taken = Term("attenuation 2", one.term.blocks, 5.0 * one.term.std, one.term.raw)
    monkeypatch.setattr(White, "attenuation", [taken] if noise else [])
    monkeypatch.setattr(Place, "lead", lambda *_: 16.0)
    assert (place_of(outcome, one).own < white.problem.settings.accept) == noise
    assert (better_in_its_place(outcome, one) is None) == noise


@pytest.mark.parametrize(
    ("axis", "argument", "stands"), [(1, "torque", False), (1, "time", True), (2, "torque", True), (None, "", True)]
)
def test_a_torque_constant_beside_structure_over_torque_is_none(white, axis, argument, stands):
    """A reading that lost up to 22 % with the load was a constant that is 18 % off, with a probability of 0.59."""
    gain = Candidate("torque_constant_error", 1, None, {})
    outcome = _outcome(white, 1, gain, 0.1 * white.problem.train_state.torque[:, 1])
    outcome.unexplained = [] if axis is None else [Unexplained(axis, argument, "N m", 0.0, 1.0, 1e-12, 50.0)]
    told = standing_alone._of_no_constant(outcome, outcome.named[0])
    assert (told is None) == stands
    spring = _outcome(white, 1, replace(SPRING, axis=1), 40.0 * white.problem.train_state.position[:, 1])
    spring.unexplained = [Unexplained(1, "position", "rad", 0.0, 1.0, 1e-12, 50.0)]
    assert standing_alone._of_no_constant(spring, spring.named[0]) is None
