"""Estimates of the monitor: regressors of a window, and which of them are estimated along."""

from __future__ import annotations

import numpy as np
import pytest
from monitor_windows import COULOMB, PER_WINDOW, motion

from jointwear.monitor.normal.estimate import choose_free, column_change, contrast


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
