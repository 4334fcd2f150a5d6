"""The ridge fit behind the noise, and what of it is worked out once."""

import numpy as np
import pytest

from jointwear.discovery.noise.noise import SETTLE, Whitener, coloured, drawn, estimate, regress, whitenable
from jointwear.discovery.noise.ridge_fit import RidgeFit

LABEL = np.repeat([0, 1], 400)
WHITE = Whitener(whitenable(np.ones(800, bool), LABEL, 2), np.array([1.2, -0.5]), 0.3)


@pytest.mark.parametrize("white", [None, WHITE])
def test_sums_of_products_of_what_is_left_are_those_of_the_columns_left(white):
    """Those of a column of the fit too, of which next to nothing is left."""
    rng = np.random.default_rng(0)
    columns = rng.standard_normal((800, 12))
    used = rng.random(800) < 0.9
    fit = RidgeFit(columns, used, white)
    groups = [
        rng.standard_normal((800, 2)),
        columns[:, :1] @ [[1.0, 2.0]],
        rng.standard_normal((800, 3)).cumsum(axis=0),
    ]
    for columns_of_group, found in zip(groups, fit.squares(groups), strict=True):
        left = fit(columns_of_group)
        left = left[used] if white is None else white(left)
        np.testing.assert_allclose(found, left.T @ left, rtol=1e-9)
    assert fit.squares([]) == []


def test_what_columns_take_off_is_what_a_regression_on_what_is_left_of_them_takes_off():
    rng = np.random.default_rng(3)
    used = rng.random(800) < 0.9
    fit = RidgeFit(rng.standard_normal((800, 12)), used, None)
    groups, left = [rng.standard_normal((800, k)) for k in (2, 3)], fit(rng.standard_normal(800))
    for columns, (gained, size) in zip(groups, fit.gained(groups, fit.squares(groups), left), strict=True):
        beside, before = fit(columns)[used], left[used]
        np.testing.assert_allclose(size, np.linalg.lstsq(beside, before, rcond=None)[0], rtol=1e-9)
        np.testing.assert_allclose(gained, before @ before - np.sum((before - beside @ size) ** 2), rtol=1e-9)


def test_the_order_of_a_noise_model_is_that_of_a_regression_for_each():
    rng = np.random.default_rng(1)
    series = coloured(WHITE, drawn(LABEL, 1, rng))[:, 0]
    found = estimate(series, np.ones(800, bool), LABEL)
    rows = whitenable(np.ones(800, bool), LABEL, 6)
    fits = [regress(series, rows, order) for order in range(7)]
    scores = [len(rows) * np.log(variance) + (k + 1) * np.log(len(rows)) for k, (_, variance) in enumerate(fits)]
    assert len(found.lags) == int(np.argmin(scores)) == 2
    np.testing.assert_array_equal(found.lags, fits[2][0])
    assert found.sigma == np.sqrt(fits[2][1])


def test_noise_whitened_by_its_own_model_is_what_it_was_drawn_from():
    drive = drawn(LABEL, 3, np.random.default_rng(2))
    before = np.concatenate([piece[SETTLE:] for piece in drive])[WHITE.rows]
    np.testing.assert_allclose(WHITE(coloured(WHITE, drive)), before, atol=1e-12)
