"""Histograms and KL divergence: mass, sign, and every reading."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.reproduction import readings
from jointwear.reproduction.features import build_reference, histograms, hourly_features, kl_divergence

HISTOGRAM = st.lists(st.integers(0, 20), min_size=12, max_size=12).filter(any)


def alternatives(name):
    return list(readings.ambiguities()[name].alternatives)


@given(
    p=HISTOGRAM,
    q=HISTOGRAM,
    floor=st.sampled_from(alternatives("empty_bin_floor")),
    direction=st.sampled_from(alternatives("kl_direction")),
)
def test_kl_is_not_negative_and_zero_for_equal_histograms(p, q, floor, direction):
    reading = {"empty_bin_floor": floor, "kl_direction": direction}
    p, q = np.array(p) / sum(p), np.array(q) / sum(q)
    assert kl_divergence(p, q, reading) >= 0
    assert kl_divergence(p, p, reading) == pytest.approx(0, abs=1e-12)


def test_kl_of_a_known_pair():
    reading = {"empty_bin_floor": "machine_epsilon", "kl_direction": "hour_from_reference"}
    p, q = np.array([0.5, 0.5]), np.array([0.9, 0.1])
    assert kl_divergence(p, q, reading) == pytest.approx(0.5 * np.log(0.5 / 0.9) + 0.5 * np.log(0.5 / 0.1))
    reading["kl_direction"] = "reference_from_hour"
    assert kl_divergence(p, q, reading) == pytest.approx(0.9 * np.log(0.9 / 0.5) + 0.1 * np.log(0.1 / 0.5))


@given(
    seed=st.integers(0, 1000),
    bins=st.integers(2, 40),
    sign=st.sampled_from(alternatives("torque_sign")),
    beyond=st.sampled_from(alternatives("out_of_range")),
)
def test_histograms_have_mass_one(seed, bins, sign, beyond):
    torque = np.random.default_rng(seed).normal(size=(2, 3, 60, 4))
    scale = np.abs(torque[:, :1]).max(axis=2)
    result = histograms(torque, scale, bins, {"torque_sign": sign, "out_of_range": beyond})
    assert result.shape == (2, 3, 4, bins)
    np.testing.assert_allclose(result.sum(axis=-1), 1, atol=1e-12)


def test_histogram_agrees_with_numpy():
    torque = np.random.default_rng(5).normal(size=(1, 1, 60, 1))
    scale = np.abs(torque).max(axis=2)
    ours = histograms(torque, scale, 12, {"torque_sign": "absolute", "out_of_range": "outer_bins"})
    theirs, _ = np.histogram(np.abs(torque).ravel() / scale.ravel(), bins=12, range=(0, 1))
    np.testing.assert_allclose(ours.ravel() * 60, theirs)


def test_values_beyond_the_reference_are_counted_or_dropped():
    torque = np.array([0.1, 0.5, 1.0, 1.5]).reshape(1, 1, 4, 1)
    scale = np.ones((1, 1, 1))
    kept = histograms(torque, scale, 2, {"torque_sign": "absolute", "out_of_range": "outer_bins"})
    np.testing.assert_allclose(kept.ravel(), [0.25, 0.75])
    dropped = histograms(torque, scale, 2, {"torque_sign": "absolute", "out_of_range": "dropped"})
    np.testing.assert_allclose(dropped.ravel(), [1 / 3, 2 / 3])


def test_a_value_just_beyond_the_reference_is_not_the_maximum():
    """The maximum belongs to the last bin; 1.1 of it, in a bin as wide as the last one, is beyond it."""
    torque = np.array([0.1, 1.0, 1.1, 1.49])[None, None, :, None]
    reading = {"torque_sign": "absolute", "out_of_range": "dropped"}
    assert histograms(torque, np.ones((1, 1, 1)), 2, reading).ravel() == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize(
    ("name", "value"),
    [(n, v) for n in readings.of_stage("features") for v in readings.ambiguities()[n].alternatives],
)
def test_every_alternative_gives_finite_features(default_reading, name, value):
    reading = {**default_reading, name: value}
    random = np.random.default_rng(7)
    training, run = random.normal(5, 1, (2, 6, 60, 3)), random.normal(5.2, 1, (2, 5, 60, 3))
    result = hourly_features(run, build_reference(training, 12, reading), 12, reading)
    for values in result.values():
        assert np.isfinite(values).all()
    assert result["kl_divergence"].shape == (2, 5, 3)
    assert (result["kl_divergence"] >= 0).all()


def test_an_axis_at_rest_without_noise_is_not_an_error(default_reading):
    torque = np.zeros((1, 4, 60, 2))
    result = hourly_features(torque, build_reference(torque, 12, default_reading), 12, default_reading)
    assert not result["kl_divergence"].any()
    assert not result["variation"].any()


def test_variation_is_sample_standard_deviation_over_mean(default_reading):
    torque = np.random.default_rng(1).normal(3, 1, (1, 1, 60, 1))
    result = hourly_features(torque, build_reference(torque, 12, default_reading), 12, default_reading)
    size = np.abs(torque).ravel()
    assert result["variation"].item() == pytest.approx(size.std(ddof=1) / size.mean())
