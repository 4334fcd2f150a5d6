"""Estimates of the monitor: the change of friction in every window, and what normal windows vary by."""

from __future__ import annotations

import numpy as np
import pytest
from monitor_windows import COULOMB, PER_WINDOW, VISCOUS, motion, residuals, sums

from jointwear.monitor.estimate import (
    COLUMNS,
    choose_free,
    column_change,
    contrast,
    coulomb_estimates,
    learn_normal,
    prior_scale,
)


def test_columns_turn_levels_into_one_growth():
    change = column_change(COULOMB)
    assert np.allclose(motion() @ change[0] @ np.eye(5)[0], motion()[..., 0] * 10 + motion()[..., 1] * 6)


def test_contrast_is_least_squares():
    x = motion()[:, 1]
    gram, y = x.T @ x, np.random.default_rng(1).standard_normal(PER_WINDOW)
    free = np.ones((1, 5), dtype=bool)
    weights, information = contrast(gram[None], free)
    assert weights[0] @ (x.T @ y) == pytest.approx(np.linalg.lstsq(x, y)[0][0])
    assert 1 / information[0] == pytest.approx(np.linalg.inv(gram)[0, 0])


def test_a_hidden_column_has_no_information():
    gram = np.zeros((1, 5, 5))
    gram[0, :2, :2] = 4.0
    weights, information = contrast(gram, np.array([[True, True, False, False, False]]))
    assert information[0] == 0.0
    assert not weights.any()
    assert not choose_free(gram)[0, 1]


def test_estimates_are_unbiased_and_their_deviation_is_honest():
    growth = np.tile([0.05, 0.0, -0.02], (400, 1))
    normal = learn_normal(sums(residuals(120, np.zeros((120, 3)), 2)), prior_scale(COULOMB, VISCOUS))
    change, std = coulomb_estimates(sums(residuals(400, growth, 3)), normal)
    mean_error = np.sqrt(std.mean(axis=0) ** 2 / 400 + 1 / normal.weight)
    assert np.all(np.abs(change.mean(axis=0) - growth[0]) < 3.5 * mean_error)
    assert change.std(axis=0) == pytest.approx(std.mean(axis=0), rel=0.2)


def test_what_is_wrong_in_the_model_leaves_with_the_normal_mean():
    x = motion()
    wrong = 0.05 * x[..., 3] + 0.1 * VISCOUS * x[..., 2] + 0.1 * COULOMB[:, 0] * x[..., 0]
    growth = np.tile([0.0, 0.04, 0.0], (50, 1))
    normal = learn_normal(sums(residuals(120, np.zeros((120, 3)), 4, wrong)), prior_scale(COULOMB, VISCOUS))
    change, std = coulomb_estimates(sums(residuals(50, growth, 5, wrong)), normal)
    assert np.all(np.abs(change.mean(axis=0) - growth[0]) < 4 * np.sqrt(std.mean(axis=0) ** 2 / 50 + 1 / normal.weight))


def test_a_load_on_the_arm_is_no_wear():
    load = 0.5 * motion()[..., 3] + 0.4
    normal = learn_normal(sums(residuals(120, np.zeros((120, 3)), 6)), prior_scale(COULOMB, VISCOUS))
    assert normal.free[:, COLUMNS.index("offset")].all()
    assert normal.free[:, COLUMNS.index("gravity")].all()
    change, std = coulomb_estimates(sums(residuals(50, np.zeros((50, 3)), 7, load)), normal)
    assert np.all(np.abs(change.mean(axis=0)) < 4 * np.sqrt(std.mean(axis=0) ** 2 / 50 + 1 / normal.weight))


def test_slow_variation_of_normal_windows_is_found_and_noise_has_none():
    slow = np.zeros((300, 3))
    random = np.random.default_rng(8)
    for k in range(1, 300):
        slow[k] = 0.95 * slow[k - 1] + 0.004 * random.standard_normal(3)
    found = learn_normal(sums(residuals(300, slow, 9)), prior_scale(COULOMB, VISCOUS))
    assert np.all(found.slow > 0.2)
    assert np.all(found.memory >= 0.8)
    white = learn_normal(sums(residuals(300, np.zeros((300, 3)), 10)), prior_scale(COULOMB, VISCOUS))
    assert np.all(white.slow == 0)
