"""The low-pass filter with zero phase."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from jointwear.measurement.derived.filtering import FORGOTTEN, limit, low_pass, zero_phase_gain
from jointwear.measurement.derived.motion import TRANSIENT


@pytest.mark.parametrize("shape", [(500,), (24,), (500, 3), (40, 2, 3)])
@pytest.mark.parametrize("cutoff", [2.0, 7.0, 20.0, 44.0])
def test_filter_is_that_of_scipy_to_the_bit(shape, cutoff):
    values = np.random.default_rng(1).standard_normal(shape).cumsum(axis=0)
    sections = butter(4, cutoff, fs=100.0, output="sos")
    # Continued for as long as its slowest poles ring.
    slowest = np.abs(butter(4, cutoff, fs=100.0, output="zpk")[1]).max()
    pad = min(len(values) - 1, int(np.ceil(np.log(FORGOTTEN) / np.log(slowest))))
    wanted = sosfiltfilt(sections, values, axis=0, padlen=pad)
    np.testing.assert_array_equal(low_pass(values, cutoff, 100.0), wanted)


@pytest.mark.parametrize("cutoff", [10.0, 20.0, 31.0, 38.0, 44.0])
def test_a_joint_that_moves_at_the_end_of_its_record_keeps_its_acceleration(cutoff):
    time = np.arange(0, 12, 0.01)
    position = 1 + 0.45 * (time - 11) + 0.28 * (time - 11) ** 2 + 0.1 * np.sin(time)
    for sign in (1, -1):
        smooth = low_pass(position[::sign], cutoff, 100.0, motion=True)
        error = np.diff(smooth, 2) * 1e4 - np.diff(position[::sign], 2) * 1e4
        # The samples beyond the edge that :func:`measure` leaves out.
        edge = int(np.ceil(TRANSIENT / cutoff * 100.0))
        assert np.abs(error[edge:-edge]).max() < 0.003 * np.abs(np.diff(position, 2) * 1e4).max()


def test_gain_is_that_of_the_filter():
    time = np.arange(4000) / 100.0
    inside = slice(1000, 3000)
    for frequency in (3.0, 7.0, 12.0):
        wave = np.sin(2 * np.pi * frequency * time)
        passed = low_pass(wave, 7.0, 100.0)[inside]
        share = float(passed @ wave[inside]) / float(wave[inside] @ wave[inside])
        assert share == pytest.approx(float(zero_phase_gain(np.array(frequency), 7.0, 100.0)), abs=1e-3)


def test_gains_of_several_cut_offs_are_those_of_each():
    frequency, cutoffs = np.linspace(0.5, 50.0, 100), np.array([2.0, 7.0, 44.0, 60.0])
    together = zero_phase_gain(frequency, cutoffs[:, None], 100.0)
    np.testing.assert_array_equal(together, [zero_phase_gain(frequency, cutoff, 100.0) for cutoff in cutoffs])


@pytest.mark.parametrize("lengths", [(60, 60), (60, 31, 80)])
def test_records_are_filtered_each_for_itself(lengths):
    record = np.repeat(np.arange(len(lengths)), lengths)
    columns = np.random.default_rng(2).standard_normal((len(record), 2)).cumsum(axis=0)
    wanted = np.concatenate([low_pass(columns[record == one], 7.0, 100.0) for one in range(len(lengths))])
    np.testing.assert_array_equal(limit(columns, record, 7.0, 100.0), wanted)
    assert limit(columns, record, np.inf, 100.0) is columns
