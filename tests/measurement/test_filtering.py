"""The low-pass filter with zero phase."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from jointwear.measurement.filtering import low_pass, zero_phase_gain


@pytest.mark.parametrize("shape", [(500,), (24,), (500, 3), (40, 2, 3)])
def test_filter_is_that_of_scipy_to_the_bit(shape):
    values = np.random.default_rng(1).standard_normal(shape).cumsum(axis=0)
    sections = butter(4, 7.0, fs=100.0, output="sos")
    wanted = sosfiltfilt(sections, values, axis=0, padlen=min(len(values) - 1, int(3 * 100.0 / 7.0)))
    np.testing.assert_array_equal(low_pass(values, 7.0, 100.0), wanted)


def test_gain_is_that_of_the_filter():
    time = np.arange(4000) / 100.0
    inside = slice(1000, 3000)
    for frequency in (3.0, 7.0, 12.0):
        wave = np.sin(2 * np.pi * frequency * time)
        passed = low_pass(wave, 7.0, 100.0)[inside]
        share = float(passed @ wave[inside]) / float(wave[inside] @ wave[inside])
        assert share == pytest.approx(float(zero_phase_gain(np.array(frequency), 7.0, 100.0)), abs=1e-3)
