"""What a missing sample reaches: its surroundings, and no further."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jointwear.measurement.derived.missing_samples import reached


@given(st.lists(st.booleans(), min_size=1, max_size=80), st.integers(0, 40))
def test_a_sample_is_reached_where_one_that_is_missing_is_near(missing, reach):
    found = reached(np.array(missing), reach)
    places = np.flatnonzero(missing)
    near = [bool(len(places)) and np.abs(places - k).min() <= reach for k in range(len(missing))]
    np.testing.assert_array_equal(found, near)
