"""How the allowance of false alarms is shared."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.allowance import (
    BACKLASH_SHARE,
    LARGEST_SHARE,
    LEVEL_SHARE,
    VISCOUS_SHARE,
    level_share,
)

RATES = st.floats(0.01, 100.0)


@given(RATES, RATES)
def test_a_higher_stated_rate_always_allows_more(one, other):
    low, high = sorted((one, other))
    assert level_share(low) <= level_share(high) <= LARGEST_SHARE
    assert low * level_share(low) <= high * level_share(high)


@pytest.mark.parametrize("rate", [0.3, 1.0, 3.0])
def test_all_charts_together_stay_within_what_is_stated(rate):
    assert level_share(rate) + VISCOUS_SHARE + BACKLASH_SHARE <= 1.01


def test_one_in_a_thousand_hours_has_the_share_that_is_stated():
    assert level_share(1.0) == LEVEL_SHARE
