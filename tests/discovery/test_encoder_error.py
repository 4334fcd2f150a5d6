"""A wave of torque that grows with the square of the speed is no cogging: an encoder makes it."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search.encoder_wave import encoder_wave
from jointwear.discovery.search.standing_alone import stand_alone

AXIS = 1


def _outcome(white, effect, torque, order=0.5):
    """Return an outcome in which a wave has a name, and the joint lacks a torque (N_train,) [N m]."""
    one = Candidate(effect, AXIS, None, {"order": order, "held": 1.0})
    columns = raw_columns(white, one)
    term = Term(effect, {AXIS: white.columns(AXIS, columns)}, np.full(2, 20.0), {AXIS: white.raw(AXIS, columns)})
    extra = white.columns(AXIS, torque[:, None])[:, 0]
    asked = replace(white, targets=[y + extra if a == AXIS else y for a, y in enumerate(white.targets)])
    return Outcome(asked.problem, asked, asked.fit([term]), None, named=[Named(one, term, None, 99.0)])


def _wave(white, order=0.5):
    state = white.problem.train_state
    return 8.0 * np.sin(order * state.drive.gear_ratio[AXIS] * state.position[:, AXIS] + 0.4)


@pytest.mark.parametrize("power", [0, 2])
@pytest.mark.parametrize("effect", ["cogging_torque", "torque_constant_ripple"])
def test_what_an_encoder_makes_of_its_controller_has_no_name_of_a_motor(white, effect, power):
    """An encoder that interpolates badly, 64 times in a turn of its joint, was named a cogging torque."""
    speed = white.problem.train_state.velocity[:, AXIS]
    load = white.problem.train_state.torque[:, AXIS] if (effect, power) == ("torque_constant_ripple", 0) else 1.0
    size = 1.0 if power else load / np.sqrt(np.mean(np.square(load)))
    outcome = _outcome(white, effect, size * _wave(white) * np.abs(speed) ** power / np.mean(np.abs(speed) ** power))
    ahead = encoder_wave(outcome, outcome.named[0])
    assert (ahead is not None) == (power == 2)
    if power:
        stand_alone(outcome)
        assert not outcome.named
        assert "square of the speed" in outcome.suspects[0][1]


def test_cogging_beside_the_wave_of_an_encoder_keeps_its_name(white):
    speed = white.problem.train_state.velocity[:, AXIS]
    torque = _wave(white) * (1.0 + 0.3 * (speed / np.sqrt(np.mean(speed**2))) ** 2)
    outcome = _outcome(white, "cogging_torque", torque)
    assert encoder_wave(outcome, outcome.named[0]) is None


def test_effects_that_are_no_waves_are_not_asked(white):
    spring = Candidate("joint_spring", AXIS, None, {"centre": 0.0, "low": -9.0, "high": 9.0})
    assert encoder_wave(Outcome(white.problem, white, white.fit(), None), Named(spring, None, None, 99.0)) is None
