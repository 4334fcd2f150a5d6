"""How sure an effect of the whole arm is, where the axes disagree about it."""

import numpy as np
import pytest

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.model.between_axes import between_variance, of_scales


def test_axes_that_agree_have_no_variance_between_them():
    rng = np.random.default_rng(0)
    assert between_variance(np.ones(6), np.full(6, 1e-4)) == 0.0
    assert between_variance(np.array([1.3]), np.array([1e-4])) == 0.0
    scattered = [between_variance(1 + 0.03 * rng.standard_normal(6), np.full(6, 1e-6)) for _ in range(400)]
    assert np.mean(scattered) == pytest.approx(0.03**2, rel=0.1)


def test_an_axis_that_knows_nothing_says_nothing_of_the_others():
    values, variances = np.array([1.0, 1.02, 0.99, 1.01, 0.98, 50.0]), np.array([*[1e-4] * 5, 400.0])
    assert between_variance(values, variances) < 0.03**2


class Whitened:
    def __init__(self, targets):
        self.targets = targets


def fitted(scales, seed):
    """Return estimate and standard deviations, without and with the part of the scales, of a mass of 2 on six axes."""
    rng = np.random.default_rng(seed)
    columns = {j: 30.0 * rng.standard_normal((200, 1)) for j in range(6)}
    friction = [Term(f"friction {j}", {j: np.ones((200, 1))}, np.ones(1), drive=(j, 0)) for j in range(6)]
    body = Term("payload", columns, np.array([10.0]))
    targets = [2.0 * s * columns[j][:, 0] + rng.standard_normal(200) for j, s in enumerate(scales)]
    fit = Fit(targets, [*friction, body])
    more = of_scales(Whitened(targets), fit, body)
    return fit.theta[-1], np.sqrt(fit.covariance[-1, -1]), np.sqrt(fit.covariance[-1, -1] + more[-1, -1])


def test_the_interval_of_a_mass_covers_what_torque_constants_hide():
    found = [fitted(1 + 0.03 * np.random.default_rng(k).standard_normal(6), k) for k in range(60)]
    narrow, wide = (np.mean([abs(x[0] - 2.0) <= 2 * x[i] for x in found]) for i in (1, 2))
    assert narrow < 0.5
    assert wide >= 0.85


def test_the_interval_of_a_clean_case_stays():
    found = [fitted(np.ones(6), k) for k in range(60)]
    assert np.median([x[2] / x[1] for x in found]) < 1.2
    assert np.mean([abs(x[0] - 2.0) <= 2 * x[2] for x in found]) >= 0.9
