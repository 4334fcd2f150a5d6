"""The normal period of the study of the monitor: mean, scatter and memory of its windows, and estimates against it."""

from __future__ import annotations

import numpy as np
import pytest
from monitor_windows import COULOMB, VISCOUS, motion, residuals, sums

from jointwear.monitor.normal.estimate import COLUMNS, prior_scale
from jointwear.studies.monitor_study.normal_period import coulomb_estimates, learn_normal


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
    assert normal.pooled.free[:, COLUMNS.index("offset")].all()
    assert normal.pooled.free[:, COLUMNS.index("gravity")].all()
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
