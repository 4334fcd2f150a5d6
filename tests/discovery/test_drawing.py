"""What the figures of a data set show."""

import numpy as np
import pytest

from jointwear.discovery.presentation.drawing import longest_run


@pytest.mark.parametrize(
    ("index", "time", "shown"),
    [
        (np.arange(10), np.arange(10) * 0.1, slice(0, 10)),
        # A pause of an hour: a line across it would show torques that nobody measured.
        (np.arange(10), np.r_[np.arange(4) * 0.1, 3600 + np.arange(6) * 0.1], slice(4, 10)),
        # A clock that starts anew, and samples between that are not held out.
        (np.arange(10), np.r_[np.arange(7) * 0.1, np.arange(3) * 0.1], slice(0, 7)),
        (np.r_[0:3, 5:10], np.arange(10) * 0.1, slice(5, 10)),
        (np.arange(1), np.zeros(1), slice(0, 1)),
    ],
)
def test_a_line_of_torque_crosses_no_gap(index, time, shown):
    np.testing.assert_array_equal(longest_run(index, time), np.arange(10)[shown])
