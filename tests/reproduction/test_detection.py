"""Principal components, control limits and onset rules."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from jointwear.reproduction import readings
from jointwear.reproduction.control_limits import q_limit, t2_limit
from jointwear.reproduction.detection import NormalModel, alarms, onset, score
from jointwear.reproduction.normal_model import by_numpy, by_scikit_learn, fit_normal_model


def test_q_limit_of_the_ballistic_missile_example():
    # J. E. Jackson, A User's Guide to Principal Components (1991), section 2.7.2: two components kept of four,
    # residual eigenvalues 29.33 and 16.41, 95 % limit of Q 140.45.
    assert q_limit(np.array([29.33, 16.41]), 0.95) == pytest.approx(140.45, abs=0.05)


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99])
@pytest.mark.parametrize("eigenvalues", [[1.0, 0.8, 0.5], [2.0, 0.3], [1.0] * 6, [0.4]])
def test_q_limit_against_an_empirical_quantile(eigenvalues, confidence):
    draws = np.random.default_rng(3).normal(size=(400_000, len(eigenvalues))) ** 2 @ np.array(eigenvalues)
    covered = (draws <= q_limit(np.array(eigenvalues), confidence)).mean()
    assert covered == pytest.approx(confidence, abs=0.006)


def test_q_limit_without_residual_variance_is_zero():
    assert q_limit(np.zeros(3), 0.95) == 0


def test_q_limit_where_the_power_transform_is_not_defined():
    # One dominant and very many small variances make h0 negative.
    eigenvalues = np.array([10.0] + [0.05] * 400)
    theta = [np.sum(eigenvalues**k) for k in (1, 2, 3)]
    assert 1 - 2 * theta[0] * theta[2] / (3 * theta[1] ** 2) < 0
    draws = np.random.default_rng(3).normal(size=(20_000, len(eigenvalues))) ** 2 @ eigenvalues
    assert (draws <= q_limit(eigenvalues, 0.95)).mean() == pytest.approx(0.95, abs=0.015)


def test_t2_limit_is_the_f_quantile():
    expected = 3 * (120**2 - 1) / (120 * 117) * stats.f.ppf(0.95, 3, 117)
    assert t2_limit(3, 120, 0.95) == pytest.approx(expected, rel=1e-12)
    with pytest.raises(ValueError, match="observations"):
        t2_limit(5, 5, 0.95)


def coverage(default_reading, hours, runs):
    """False alarm shares of Q and T2 on new Gaussian data with correlated series."""
    random = np.random.default_rng(11)
    mixing = random.normal(size=(6, 6))
    training = random.normal(size=(runs, hours, 6)) @ mixing
    fresh = random.normal(size=(runs, 500, 6)) @ mixing
    model = fit_normal_model(training, 0.95, 0.75, default_reading)
    q, t2 = score(fresh, model)
    return (q <= model.q_limit[:, None]).mean(), (t2 <= model.t2_limit[:, None]).mean()


def test_limits_cover_gaussian_data(default_reading):
    q, t2 = coverage(default_reading, hours=3000, runs=20)
    # 20 x 500 hours; hours of one run share the fitted model, so three binomial errors and the fit's own error.
    assert q == pytest.approx(0.95, abs=3 * np.sqrt(0.95 * 0.05 / 10_000) + 0.004)
    assert t2 == pytest.approx(0.95, abs=3 * np.sqrt(0.95 * 0.05 / 10_000) + 0.004)


def test_components_exceed_the_wanted_share(default_reading):
    random = np.random.default_rng(2)
    series = random.normal(size=(5, 120, 6)) @ random.normal(size=(6, 6))
    model = fit_normal_model(series, 0.95, 0.75, default_reading)
    share = np.cumsum(model.eigenvalues, axis=1) / model.eigenvalues.sum(axis=1, keepdims=True)
    for i, kept in enumerate(model.kept):
        assert share[i, kept - 1] > 0.75
        assert kept == 1 or share[i, kept - 2] <= 0.75


def test_score_agrees_with_scikit_learn(default_reading):
    from sklearn.decomposition import PCA

    random = np.random.default_rng(4)
    series = random.normal(size=(1, 200, 6)) @ random.normal(size=(6, 6))
    model = fit_normal_model(series, 0.95, 0.75, default_reading)
    z = (series[0] - series[0].mean(0)) / series[0].std(0, ddof=1)
    pca = PCA(n_components=int(model.kept[0])).fit(z)
    back = pca.inverse_transform(pca.transform(z))
    q, t2 = score(series, model)
    np.testing.assert_allclose(q[0], ((z - back) ** 2).sum(1), atol=1e-9)
    np.testing.assert_allclose(t2[0], (pca.transform(z) ** 2 / pca.explained_variance_).sum(1), atol=1e-9)


@pytest.mark.parametrize("hours", [5, 200])
def test_both_decompositions_score_alike(default_reading, hours):
    random = np.random.default_rng(hours)
    series = random.normal(size=(2, hours, 6)) @ random.normal(size=(6, 6))
    ours, theirs = (
        fit_normal_model(series, 0.95, 0.75, default_reading, decompose) for decompose in (by_numpy, by_scikit_learn)
    )
    np.testing.assert_allclose(ours.q_limit, theirs.q_limit, rtol=1e-9)
    for a, b in zip(score(series, ours), score(series, theirs), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-9)


def test_a_series_without_variation_does_not_break_the_model(default_reading):
    series = np.random.default_rng(0).normal(size=(2, 50, 6))
    series[..., 5] = 0
    q, t2 = score(series, fit_normal_model(series, 0.95, 0.75, default_reading))
    assert np.isfinite(q).all()
    assert np.isfinite(t2).all()


@given(st.integers(0, 2**32 - 1), st.floats(0, 9))
def test_rounding_raises_no_alarm(seed, decades):
    """Three axes move and three components are kept: nothing is left, however far a run is from normal."""
    random = np.random.default_rng(seed)
    series = random.normal(size=(2, 60, 6)) * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
    reading = {name: a.default for name, a in readings.ambiguities().items()} | {"components": "three"}
    model = fit_normal_model(series, 0.95, 0.75, reading)
    q, t2 = score(series * 10**decades, model)
    assert (q == 0).all()
    assert (t2 > 0).all()


def test_what_an_axis_at_rest_adds_is_no_rounding(default_reading):
    series = np.random.default_rng(6).normal(size=(1, 60, 6)) * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
    model = fit_normal_model(series, 0.95, 0.75, {**default_reading, "components": "three"})
    run = 1e5 * series + [0.0, 0.0, 0.0, 0.0, 1e-3, 0.0]
    q, _ = score(run, model)
    np.testing.assert_allclose(q, 1e-6, rtol=1e-3)


@pytest.mark.parametrize(
    ("name", "value"),
    [(n, v) for n in readings.of_stage("detection") for v in readings.ambiguities()[n].alternatives],
)
def test_every_alternative_fits_and_scores(default_reading, name, value):
    random = np.random.default_rng(9)
    features = {
        "kl_divergence": random.random((2, 60, 6)),
        "mean_absolute_torque": random.random((2, 60, 6)) + 3,
        "maximum_torque": random.random((2, 60, 6)) + 5,
        "histogram": random.dirichlet(np.ones(12), (2, 60, 6)),
    }
    reading = {**default_reading, name: value}
    series = readings.ambiguities()["pca_input"].alternatives[reading["pca_input"]](features)
    model = fit_normal_model(series, 0.95, 0.75, reading)
    assert isinstance(model, NormalModel)
    q, _ = score(series, model)
    found = onset(q > model.q_limit[:, None], reading["onset_rule"], 5)
    assert found.shape == (2,)


def rule(above, name, count=3):
    return onset(np.array([above], dtype=bool), name, count)[0]


def test_onset_rules():
    above = [0, 1, 0, 1, 1, 1, 0, 1, 1]
    assert rule(above, "single_hour") == 2
    assert rule(above, "consecutive_hours") == 4
    assert rule(above, "until_the_end") == 8
    assert np.isnan(rule([0, 1, 1, 0], "consecutive_hours"))
    assert np.isnan(rule([1, 1], "consecutive_hours"))
    assert np.isnan(rule([0, 0, 0], "single_hour"))


def test_alarms_count_starts():
    above = np.array([[1, 1, 1, 0, 1, 1, 1, 1, 0, 1]], dtype=bool)
    assert alarms(above, "consecutive_hours", 3)[0] == 2
    assert alarms(above, "single_hour", 3)[0] == 3


@given(st.lists(st.floats(0.01, 10.0), min_size=1, max_size=6), st.floats(-280, 250))
def test_q_limit_scales_with_the_variances_however_small(values, power):
    scale = 10.0**power
    small = q_limit(np.array(values) * scale, 0.95)
    assert small == pytest.approx(q_limit(np.array(values), 0.95) * scale, rel=1e-9)
