"""Sizes of what is known, where some or all of it is not."""

import numpy as np

from jointwear.statistics.known import known_rms


def test_the_size_of_what_is_known_leaves_the_rest_out():
    values = np.array([[3.0, np.nan, np.nan], [4.0, 2.0, np.nan]])
    np.testing.assert_allclose(known_rms(values), [np.sqrt(12.5), 2.0, 0.0])
    np.testing.assert_allclose(known_rms(values, 2), [np.sqrt(12.5), np.inf, np.inf])
