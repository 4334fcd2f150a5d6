"""A few positions that are missing must not make accelerations that nobody measured."""

import numpy as np
import pytest

from jointwear.measurement.formats.chunk import Chunk
from jointwear.monitor.reading.derivation import derive_motion

RATE, N = 50.0, 3


def chunk(with_velocity: bool, lost: np.ndarray, stamps: float = 0.0) -> Chunk:
    time = np.arange(3000) / RATE
    phase = 2 * np.pi * 0.4 * time[:, None] + np.arange(N)
    position, velocity = np.sin(phase), 2 * np.pi * 0.4 * np.cos(phase)
    time = np.round(time / stamps) * stamps if stamps else time
    torque = np.ones_like(position)
    if with_velocity:
        return Chunk(time, position, torque, np.where(lost, np.nan, velocity), None, None)
    return Chunk(time, np.where(lost, np.nan, position), torque, None, None, None)


@pytest.mark.parametrize("with_velocity", [False, True])
@pytest.mark.parametrize("stamps", [0.0, 0.005])
def test_single_holes_leave_the_acceleration_as_it_is(with_velocity, stamps):
    lost = np.random.default_rng(3).random((3000, N)) < 0.01
    lost[:30] = lost[-30:] = False
    none = np.zeros_like(lost)
    stretch, cutoff = np.zeros(3000, int), np.full(N, 10.0)
    whole, holed = (derive_motion(chunk(with_velocity, x, stamps), stretch, cutoff) for x in (none, lost))
    used = holed.usable & whole.usable
    # Nearly all of the samples stay, also those that were missing.
    assert used.mean() > 0.9
    assert (used & lost).sum() > 40
    peak = np.abs(whole.acceleration).max()
    assert np.abs(holed.acceleration - whole.acceleration)[used].max() < 0.01 * peak
    assert np.abs(holed.velocity - whole.velocity)[used].max() < 0.01 * np.abs(whole.velocity).max()


def test_a_long_hole_is_not_used_and_spoils_nothing_beside_it():
    lost = np.zeros((3000, N), bool)
    lost[1000:1040, 1], lost[1500, 1] = True, True
    stretch, cutoff = np.zeros(3000, int), np.full(N, 10.0)
    whole = derive_motion(chunk(False, np.zeros_like(lost)), stretch, cutoff)
    holed = derive_motion(chunk(False, lost), stretch, cutoff)
    assert not holed.usable[1000:1040].any()
    assert holed.usable[1500].all()
    beside = slice(1450, 1550)
    wrong = np.abs(holed.acceleration - whole.acceleration)[beside].max()
    assert wrong < 0.01 * np.abs(whole.acceleration).max()
