"""What an axis has grown by when a new program begins: believed where it stands out, else taken for none."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.watching.falls import with_service
from jointwear.monitor.watching.growth_so_far import LARGE, shrunk, stands_out
from jointwear.monitor.watching.watched_axis import Start


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


def test_growth_without_an_alarm_is_told_where_it_is_likelier_than_none():
    assert stands_out(0.09, 0.03**2)
    assert not stands_out(0.03, 0.02**2)
    assert not stands_out(-0.2, 0.01**2)


def test_a_service_begins_anew_what_was_carried_over_later_starts():
    """What goes on over a change of program after it was measured against what no longer holds."""
    before, after = Start(10, False, True, (0.1, 1e-4)), Start(50, False, True, (0.2, 1e-4))
    later = with_service([before, after], hit=30, start=Start(25, True))
    assert later == [before, Start(25, True), Start(50, False, True)]
    assert with_service(later, hit=30, start=Start(25, True)) is None
    assert with_service(later, hit=30, start=Start(20, True)) is None
