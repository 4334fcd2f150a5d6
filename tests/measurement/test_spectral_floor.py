"""A joint that its controller shakes by one step of the encoder while it rests moves no faster for it."""

import numpy as np
import pytest

from jointwear.measurement.derived.motion import RESOLVED, measure
from jointwear.measurement.derived.spectral_floor import RESTING, resting
from jointwear.measurement.recording import Recording

RATE, STEP = 125.0, 2 * np.pi / 2**15
WHOLE = [slice(0, 1250)]


def _recording(shaken):
    """Two joints, three records of 20 s; in the last one joint 1 rests, between two steps of its encoder or on one."""
    time, rng = np.arange(2500) / RATE, np.random.default_rng(3)
    position = []
    for k in range(3):
        moves = np.stack([np.sin((1.1 + 0.3 * k) * time), 0.6 * np.cos((0.9 + 0.2 * k) * time)], axis=1)
        if k == 2:
            to_and_fro = np.where(rng.random(len(time)) < 0.8, np.arange(len(time)) % 2, 0)
            moves[400:2100, 0] = moves[400, 0] + STEP * (to_and_fro[400:2100] - 0.25 if shaken else 0)
            moves[2100:, 0] += moves[400, 0] - moves[2100, 0]
        position.append(STEP * np.round(moves / STEP))
    position = np.concatenate(position)
    label = np.repeat(np.arange(3), len(time))
    return Recording(np.tile(time, 3), label, position, np.zeros_like(position))


def test_steps_at_rest_leave_the_cut_off_of_the_motion():
    quiet, shaken = (measure(_recording(shaken)) for shaken in (False, True))
    assert (shaken.reach < RESOLVED * RATE).all()
    np.testing.assert_allclose(shaken.cutoff, quiet.cutoff, rtol=0.3)
    assert shaken.fitted == quiet.fitted


def test_a_rest_of_one_step_is_still_and_nothing_else_is():
    time = np.arange(1250) / RATE
    swings = STEP * np.round(4.0 * np.sin(2 * np.pi * 20.0 * time))
    rests = STEP * (np.arange(1250) % 2)
    still = resting(np.stack([swings, rests], axis=1), WHOLE)
    np.testing.assert_array_equal(still[:, 0], swings)
    np.testing.assert_allclose(still[:, 1], 0.5 * STEP)


@pytest.mark.parametrize("length", [RESTING - 1, 1250])
def test_noise_that_is_finer_than_the_log_has_no_steps(length):
    position = 1e-5 * np.random.default_rng(5).standard_normal((length, 1))
    np.testing.assert_array_equal(resting(position, [slice(0, length)]), position)
    assert (resting(np.ones((length, 1)), [slice(0, length)]) == 1.0).all()
