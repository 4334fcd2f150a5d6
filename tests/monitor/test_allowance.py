"""How the allowance of false alarms is shared."""

import pytest

from jointwear.monitor.watching.allowance import BACKLASH_SHARE, LEVEL_SHARE, VISCOUS_SHARE


def test_all_charts_together_have_what_is_stated():
    total = LEVEL_SHARE + VISCOUS_SHARE + BACKLASH_SHARE
    assert total == pytest.approx(1.0)


def test_the_level_is_what_wear_mostly_moves_and_has_most_of_it():
    assert min(VISCOUS_SHARE, BACKLASH_SHARE) > 0
    assert LEVEL_SHARE > 4 * (VISCOUS_SHARE + BACKLASH_SHARE)
