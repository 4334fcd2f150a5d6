"""What a chi-square is worth and how likely noise reaches it are two readings of one number."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.discovery.linear import chance, least_nats


@given(st.floats(-40.0, -1e-3), st.integers(1, 12), st.integers(200, 200_000))
def test_what_noise_must_reach_is_reached_with_that_probability(log_probability, freedom, samples):
    probability = 10.0**log_probability
    nats = least_nats(probability, freedom, samples)
    assert chance(2.0 * nats + freedom, freedom, samples)[0] == pytest.approx(probability, rel=1e-6)
