"""What was judged stays as it was: windows that come later move no state and no alarm of those before them.

Exceptions, by their nature: what a later window explains. A change of the torque's scale, the logs of another robot and
a program or product that the baseline lacks are known only some windows after they begin, and a service is told late;
from their begin on, all is judged anew. Nothing of this is in these windows.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from monitor_windows import SETTINGS, residuals, statistics_of

from jointwear.monitor.judging.judge import judge
from jointwear.monitor.normal.shifts import shift_labels

HOUR, DAYS, LEARNT, WORN = 3600.0, 10, 5, 0
#: Windows of a working day, and of a last run over a day and a half.
DAY, LONG = 16, 36
KNOWN = DAYS * DAY


def judged(grown, after, warmer=0.0, windows=KNOWN + LONG):
    """Judge an arm that runs 16 h a day, of which axis 1 grows by `grown` after the baseline; behind its tenth day it
    runs by the hours `after` (36,), axis 2 by `warmer` [K] off the temperature that all share."""
    growth = np.zeros((KNOWN + LONG, 3))
    growth[LEARNT * DAY + 8 :, WORN] = grown
    s = statistics_of(residuals(KNOWN + LONG, growth, 31))
    hours = np.concatenate([(24.0 * np.arange(DAYS)[:, None] + np.arange(DAY)).ravel(), 24.0 * DAYS + after])
    temperature = np.repeat(25 + 2 * np.sin(hours / 5)[:, None], 3, axis=1)
    temperature[KNOWN:, 1] += warmer
    s = replace(s, start=HOUR * hours, end=HOUR * (hours + 1), temperature=temperature).part(slice(0, windows))
    return judge(s, s.end <= LEARNT * 24 * HOUR, SETTINGS)


RUNS = {
    "in one run": np.arange(LONG, dtype=float),
    "in three shifts": (24.0 * np.arange(3)[:, None] + np.arange(12)).ravel(),
    "after a week": 168.0 + np.arange(LONG),
}


@pytest.mark.long
@pytest.mark.parametrize("grown", [0.0, 0.12])
@pytest.mark.parametrize("warmer", [0.0, 0.5])
def test_later_windows_leave_states_and_alarms_as_they_were(grown, warmer):
    end = HOUR * (24.0 * (DAYS - 1) + DAY)
    before = judged(grown, RUNS["in one run"], windows=KNOWN)
    assert {a["axis"] for a in before.alarms if a["detector"] == "model"} == ({WORN + 1} if grown else set())
    for name, after in RUNS.items():
        later = judged(grown, after, warmer)
        assert np.array_equal(later.status[:KNOWN], before.status), name
        assert np.array_equal(later.reason[:KNOWN], before.reason), name
        assert [a for a in later.alarms if a["time"] <= end] == before.alarms, name
        for estimate, values in before.estimates.items():
            np.testing.assert_allclose(later.estimates[estimate][:KNOWN], values, rtol=1e-6, atol=1e-9, err_msg=name)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.integers(1, 30), st.integers(3, 40)), min_size=2, max_size=12),
    st.integers(1, 11),
    st.booleans(),
)
def test_a_later_run_however_long_cuts_no_shift_anew(runs, learnt, steady):
    begins = np.cumsum([0, *(hours + pause for hours, pause in runs[:-1])])
    start = HOUR * np.concatenate([b + np.arange(float(hours)) for b, (hours, _) in zip(begins, runs, strict=True)])
    first = sum(hours for hours, _ in runs[:learnt])
    baseline = np.arange(len(start)) < first
    whole = shift_labels(start, start + HOUR, baseline, steady)
    for k in range(first, len(start)):
        part = shift_labels(start[:k], start[:k] + HOUR, baseline[:k], steady)
        assert np.array_equal(part, whole[:k])


def test_a_robot_that_later_never_stops_is_cut_into_days():
    hours = np.concatenate([(24.0 * np.arange(5)[:, None] + np.arange(16)).ravel(), 120 + np.arange(96.0)])
    label = shift_labels(HOUR * hours, HOUR * (hours + 1), hours < 120)
    assert np.bincount(label).tolist() == [16] * 5 + [24] * 4


def test_a_baseline_of_less_than_a_day_is_cut_into_parts_once_its_run_never_stops():
    """Of one shift, or two, nothing is learnt, so that nothing is judged anew when they are cut."""
    hours = np.arange(60.0)
    first = hours < 20
    for count, parts in ((20, 1), (24, 1), (25, 7), (60, 15)):
        label = shift_labels(HOUR * hours[:count], HOUR * (hours[:count] + 1), first[:count])
        assert label[-1] + 1 == parts
