"""Runs of equal values cover all places once, in order, and neighbours differ."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jointwear.statistics.runs import runs


@given(st.lists(st.integers(0, 2), max_size=40), st.integers(0, 5))
def test_runs_cover_all_places_once_and_neighbours_differ(values, start):
    values = np.array(values, dtype=int)
    found = runs(values, start)
    places = [place for run in found for place in range(run.start, run.stop)]
    assert places == list(range(start, start + len(values)))
    assert all(len(set(values[r.start - start : r.stop - start])) == 1 for r in found)
    assert all(values[a.start - start] != values[b.start - start] for a, b in pairwise(found))
