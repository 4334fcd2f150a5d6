"""A wave of torque that grows with the square of the speed is no cogging: an encoder makes it."""

import numpy as np
import pytest
from discovery_cases import WAVING as AXIS
from discovery_cases import wave_named, wave_of

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.search.encoder_wave import encoder_wave
from jointwear.discovery.search.standing_alone import stand_alone


@pytest.mark.parametrize("power", [0, 2])
@pytest.mark.parametrize("effect", ["cogging_torque", "torque_constant_ripple"])
def test_what_an_encoder_makes_of_its_controller_has_no_name_of_a_motor(white, effect, power):
    """An encoder that interpolates badly, 64 times in a turn of its joint, was named a cogging torque."""
    speed = white.problem.train_state.velocity[:, AXIS]
    load = white.problem.train_state.torque[:, AXIS] if (effect, power) == ("torque_constant_ripple", 0) else 1.0
    size = 1.0 if power else load / np.sqrt(np.mean(np.square(load)))
    outcome = wave_named(
        white, effect, size * wave_of(white) * np.abs(speed) ** power / np.mean(np.abs(speed) ** power)
    )
    ahead = encoder_wave(outcome, outcome.named[0])
    assert (ahead is not None) == (power == 2)
    if power:
        stand_alone(outcome)
        assert not outcome.named
        assert "square of the speed" in outcome.suspects[0][1]


def test_cogging_beside_the_wave_of_an_encoder_keeps_its_name(white):
    speed = white.problem.train_state.velocity[:, AXIS]
    torque = wave_of(white) * (1.0 + 0.3 * (speed / np.sqrt(np.mean(speed**2))) ** 2)
    outcome = wave_named(white, "cogging_torque", torque)
    assert encoder_wave(outcome, outcome.named[0]) is None


def test_effects_that_are_no_waves_are_not_asked(white):
    spring = Candidate("joint_spring", AXIS, None, {"centre": 0.0, "low": -9.0, "high": 9.0})
    assert encoder_wave(Outcome(white.problem, white, white.fit(), None), Named(spring, None, None, 99.0)) is None
