"""What is left of a log at a high rate once it is reduced."""

from __future__ import annotations

import numpy as np
import pytest

from jointwear.measurement.motion import measure
from jointwear.measurement.recording import Recording


@pytest.mark.parametrize("rate", [500.0, 1000.0])
def test_the_step_of_friction_at_a_reversal_rings_in_no_sample_that_is_used(rate):
    time = np.arange(0.0, 20.0, 1.0 / rate)
    position = np.stack([0.8 * np.sin(3.1 * time), 0.5 * np.sin(4.3 * time + 1.0)], axis=1)
    velocity = np.stack([0.8 * 3.1 * np.cos(3.1 * time), 0.5 * 4.3 * np.cos(4.3 * time + 1.0)], axis=1)
    torque = -0.6 * position * [3.1**2, 4.3**2] + 2.0 * np.sign(velocity)
    label = np.zeros(len(time), dtype=int)
    measured = measure(Recording(time, label, position, torque))
    assert 0 < measured.rate < 0.5 * rate
    left = measured.torque - 0.6 * measured.acceleration - 2.0 * np.sign(measured.velocity)
    used = measured.usable & (measured.speed_floor < np.abs(measured.velocity))
    assert used.mean() > 0.8
    assert np.abs(left[used]).max() < 0.03
