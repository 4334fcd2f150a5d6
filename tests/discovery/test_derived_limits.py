"""Limits that follow from others, or from what they are about."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.discovery import Settings
from jointwear.discovery.search import acceptance


@given(usual=st.floats(0.05, 0.6))
def test_two_standard_deviations_of_what_is_usually_off(usual):
    moved = Settings(usual=usual)
    assert moved.wrongest_mass == pytest.approx(2 * usual)
    assert moved.off_scale == pytest.approx(1 + 2 * usual)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), axis=st.integers(0, 5))
def test_an_effect_twice_as_large_as_what_is_lacking_leaves_more_than_there_was(white, seed, axis):
    """Whatever friction and motor inertia stand beside it: the gate of what only cancels others needs no limit."""
    problem = white.problem
    used = problem.usable[:, axis]
    lacking = problem.discrepancy[problem.train, axis][used]
    friction = problem.friction_columns(problem.train_state, axis)[used]
    rng = np.random.default_rng(seed)
    torque = np.cumsum(rng.standard_normal(used.sum())) + friction @ rng.normal(0.0, 5.0, 4)
    # As like what is lacking as it can be.
    torque = rng.uniform(0.0, 5.0) * lacking + 1e-3 * torque
    own = acceptance.without_drives(problem, axis, torque)
    size = 2.0 * np.sqrt(np.mean(lacking**2) / np.mean(own**2)) * 1.001
    left = acceptance.without_drives(problem, axis, lacking - size * torque)
    assert np.mean(left**2) > np.mean(lacking**2)


def test_a_correction_of_friction_may_be_as_large_as_all_that_its_axis_lacks(white):
    problem, axis = white.problem, 1
    known = replace(problem, discrepancy=1e-3 * problem.discrepancy)
    assert known.friction_prior(axis)[0] == pytest.approx(known.scale[axis])
    rough = replace(problem, discrepancy=100.0 * problem.discrepancy)
    used = rough.usable[:, axis]
    rms = np.sqrt(np.mean(rough.discrepancy[rough.train, axis][used] ** 2))
    assert rms > 2.0 * rough.scale[axis]
    assert rough.friction_prior(axis)[0] == pytest.approx(rms)
