"""A drive that two joints turn: one coefficient on both, where Coulomb friction of the other one could stand in."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Named
from jointwear.discovery.model.augment import entries_of
from jointwear.discovery.model.steps_back import plainer_forms
from jointwear.discovery.problem.candidates import Candidate, raw_columns, term_of
from jointwear.discovery.search.other_half import with_other_halves

#: A wrist: the joint that has the name, and the one that is always faster.
SLOW, FAST = 4, 5
#: Coulomb friction of the drive, in standard deviations of the noise.
LEVEL = 12.0


def _drive(own=1.0, sense=1.0, both=False):
    return Candidate("drive_coupling", SLOW, FAST, {"own": own, "other": sense}, both=both)


@pytest.fixture
def wrist(white):
    """The problem with a joint 5 that is slower than joint 6, with it and against it, so that the drive turns as that
    one does."""
    velocity = white.problem.train_state.velocity.copy()
    with_it = np.where(np.arange(len(velocity)) % 500 < 250, 1.0, -1.0)
    velocity[:, SLOW] = 0.5 * with_it * velocity[:, FAST]
    problem = replace(white.problem)
    problem.__dict__.update(train_state=replace(white.problem.train_state, velocity=velocity))
    return replace(white, problem=problem)


def _lacking(white, torques):
    """The problem that lacks torques {axis: (N_train,)}."""
    targets = list(white.targets)
    for axis, torque in torques.items():
        targets[axis] = targets[axis] + white.columns(axis, torque)
    return replace(white, targets=targets)


def _named(white, candidate, others=()):
    one = Named(candidate, term_of(white, candidate), None, 99.0)
    return with_other_halves(white, [one, *others])[0].candidate


def _torque(white, candidate):
    noise = max(white.whiteners[axis].marginal for axis in (SLOW, FAST))
    return LEVEL * noise * raw_columns(white, candidate)[:, 0]


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("own", [1.0, 0.0])
def test_the_other_half_has_the_same_coefficient(wrist, own, sense):
    """Coulomb friction of joint 6 was corrected in its place, and wrong wherever the drive turns against that joint."""
    true = _drive(sense=sense, both=True)
    lacking = _lacking(wrist, {half.axis: _torque(wrist, half) for half in true.halves})
    # The drive turns as the other joint does: its sense says the same alone.
    assert _named(lacking, _drive(own, sense)) == true


def test_a_half_stays_a_half_where_the_other_joint_lacks_nothing(wrist):
    half = _drive()
    assert _named(_lacking(wrist, {SLOW: _torque(wrist, half)}), half) == half


def test_a_half_stays_a_half_where_the_other_joint_lacks_another_torque(wrist):
    half = _drive()
    torques = {SLOW: _torque(wrist, half), FAST: 0.4 * _torque(wrist, half.other_half)}
    assert _named(_lacking(wrist, torques), half) == half


def test_two_names_stay_two(wrist):
    half = _drive()
    lacking = _lacking(wrist, {one.axis: _torque(wrist, one) for one in replace(half, both=True).halves})
    other = Named(half.other_half, term_of(lacking, half.other_half), None, 99.0)
    assert _named(lacking, half, [other]) == half


def test_a_robot_file_has_both_halves():
    whole = _drive(sense=-1.0, both=True)
    parameters = {"coulomb": LEVEL, "viscous": 0.0, "inertia": 0.0, "own": 1.0, "other": -1.0}
    estimate = SimpleNamespace(named=SimpleNamespace(candidate=whole), parameters=parameters, form=None)
    first, second = entries_of(estimate, None)
    assert (first["axis"], first["source_axis"]) == (second["source_axis"], second["axis"]) == (SLOW + 1, FAST + 1)
    assert first["parameters"] == second["parameters"] == parameters


def test_a_model_can_do_without_the_other_half(wrist):
    whole = _drive(both=True)
    term = term_of(wrist, whole)
    assert set(term.blocks) == {SLOW, FAST}
    ((half, alone),) = plainer_forms(wrist, whole, term)
    assert half == _drive()
    assert set(alone.blocks) == {SLOW}
