"""A robot file that carries a drift on to times that were never seen says so."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.candidates import Candidate
from jointwear.discovery.restrictions import beyond_the_time


@pytest.mark.parametrize(("last", "told"), [(9.0, False), (25.0, True)])
def test_what_is_carried_on_beyond_the_time_that_was_seen_is_told(last, told):
    time = np.array([0.0, 5.0, last, 10.0, 15.0])
    test = np.arange(5) == 2
    problem = SimpleNamespace(measured=SimpleNamespace(time=time), train=~test, test=test)
    written = [Candidate("torque_offset_drift", 2, None, {}), Candidate("stribeck_friction", 0, None, {})]
    words = beyond_the_time(problem, written)
    assert len(words) == told
    assert not told or words[0].startswith("joint 3: drifting torque offset follows time")
