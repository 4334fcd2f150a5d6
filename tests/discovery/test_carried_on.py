"""A robot file that carries an effect on to times or temperatures that were never seen says so."""

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery.problem.candidates import Candidate
from jointwear.discovery.problem.restrictions import beyond_the_temperature, beyond_the_time


@pytest.mark.parametrize(("last", "told"), [(9.0, False), (25.0, True)])
def test_what_is_carried_on_beyond_the_time_that_was_seen_is_told(last, told):
    time = np.array([0.0, 5.0, last, 10.0, 15.0])
    test = np.arange(5) == 2
    problem = SimpleNamespace(measured=SimpleNamespace(time=time), train=~test, test=test)
    written = [Candidate("torque_offset_drift", 2, None, {}), Candidate("stribeck_friction", 0, None, {})]
    words = beyond_the_time(problem, written)
    assert len(words) == told
    assert not told or words[0].startswith("joint 3: drifting torque offset follows time")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ([31.0, 44.0], False),
        ([29.9, 45.1], False),  # hardly beyond
        ([18.0, 22.0], True),
        ([44.0, 52.0], True),
        ([np.nan, np.nan], False),
    ],
)
def test_what_is_carried_on_beyond_the_temperatures_that_were_seen_is_told(asked, told):
    warm = np.column_stack([[30.0, np.nan, 45.0, *asked], [20.0, 20.0, 20.0, 80.0, 80.0]])
    test = np.arange(5) > 2
    problem = SimpleNamespace(state=SimpleNamespace(temperature=warm), train=~test, test=test)
    written = [
        Candidate(e, 0, None, {}) for e in ("temperature_dependent_viscous_friction", "torque_constant_temperature")
    ]
    # What follows no temperature is not carried on, however warm its joint.
    words = beyond_the_temperature(problem, [*written, Candidate("stribeck_friction", 1, None, {})])
    assert len(words) == told
    assert not told or words[0].startswith(
        f"joint 1: its temperature is {asked[0]:.0f} to {asked[1]:.0f} degC in the test"
    )
