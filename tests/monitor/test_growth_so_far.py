"""What an axis has grown by when a new program begins: believed where it stands out, else taken for none."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.watching.growth_so_far import LARGE, shrunk


def test_a_growth_that_stands_out_is_taken_as_it_is_and_scatter_for_none():
    value, variance = shrunk(0.2, 0.01**2)
    assert value == pytest.approx(0.2, rel=0.01)
    assert variance == pytest.approx(0.01**2, rel=0.02)
    value, variance = shrunk(0.005, 0.01**2)
    assert value == pytest.approx(0.0, abs=0.001)
    assert variance < 0.005**2


@given(st.floats(-0.5, 0.5), st.floats(1e-4, 0.3))
def test_it_lies_between_nothing_and_what_was_measured(mean, error):
    value, variance = shrunk(mean, error**2)
    assert 0.0 <= value * np.sign(mean) <= abs(mean)
    assert 0.0 <= variance <= LARGE**2 + mean**2
