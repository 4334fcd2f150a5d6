"""A wave of torque that grows with the square of the torque is no ripple of a torque constant."""

import numpy as np
import pytest
from discovery_cases import WAVING as AXIS
from discovery_cases import wave_named, wave_of

from jointwear.discovery.search.standing_alone import stand_alone
from jointwear.discovery.search.steeper_wave import steeper_wave


def _load(white):
    torque = white.problem.train_state.torque[:, AXIS]
    return torque / np.sqrt(np.mean(torque**2))


@pytest.mark.parametrize("power", [1, 2, 3])
def test_a_wave_that_grows_faster_than_the_torque_is_no_ripple(white, power):
    """Of an inductance that changes with the angle, as of teeth that saturate, a ripple of 9 % was named beside a rest
    over the same angle."""
    load = _load(white)
    outcome = wave_named(white, "torque_constant_ripple", wave_of(white) * load * np.abs(load) ** (power - 1))
    ahead = steeper_wave(outcome, outcome.named[0])
    assert (ahead is not None) == (power > 1)
    if power > 1:
        stand_alone(outcome)
        assert not outcome.named
        assert "square of the torque" in outcome.suspects[0][1]


def test_a_ripple_beside_a_little_that_grows_faster_keeps_its_name(white):
    load = _load(white)
    outcome = wave_named(white, "torque_constant_ripple", wave_of(white) * load * (1.0 + 0.2 * np.abs(load)))
    assert steeper_wave(outcome, outcome.named[0]) is None


def test_a_cogging_torque_is_not_asked(white):
    outcome = wave_named(white, "cogging_torque", wave_of(white) * _load(white) ** 2)
    assert steeper_wave(outcome, outcome.named[0]) is None
