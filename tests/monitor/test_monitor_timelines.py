"""Lines over time on the page: windows that are drawn as one, and gaps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwear.monitor.presentation.drawing import _alone, _pauses, _thin


@given(st.integers(1, 40), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_thinned_windows_are_weighted_means_of_those_that_are_known(count, parts, seed):
    random = np.random.default_rng(seed)
    values, std = random.normal(size=count), random.uniform(0.1, 2.0, count)
    values[random.random(count) < 0.3] = np.nan
    groups = np.array_split(random.permutation(count), min(parts, count))
    mean, error = _thin(values, std, groups)
    for k, group in enumerate(groups):
        good = group[np.isfinite(values[group])]
        if not len(good):
            assert np.isnan(mean[k])
            continue
        weight = 1 / std[good] ** 2
        assert mean[k] == pytest.approx(np.average(values[good], weights=weight), rel=1e-9, abs=1e-12)
        assert error[k] == pytest.approx(weight.sum() ** -0.5, rel=1e-9)


def test_a_line_over_time_is_interrupted_where_nothing_was_measured():
    hours = np.concatenate([24 * day + np.arange(6, 14) for day in (0, 1, 4)])
    assert _pauses(hours).tolist() == [8, 16]
    assert not len(_pauses(24.0 * np.array([0, 1, 2, 5, 6])))
    assert not len(_pauses(np.zeros(1)))
    broken = np.insert(np.arange(4.0), [1, 2], np.nan)
    assert np.flatnonzero(_alone(broken)).tolist() == [0, 2]
