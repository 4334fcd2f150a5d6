"""An axis whose friction falls again and again is judged after the last fall as after the first."""

import numpy as np
import pytest

from jointwear.monitor.normal.conditions import Conditions
from jointwear.monitor.normal.learning import learn_axes
from jointwear.monitor.normal.series import Series
from jointwear.monitor.watching.asked import Asked, Period
from jointwear.monitor.watching.watching import watch

#: Falls that nobody entered, shifts from one to the next, and windows of a shift.
FALLS, EVERY, PER = 10, 7, 6


@pytest.mark.long
def test_wear_after_many_falls_that_nobody_entered_is_found_and_told_as_it_is():
    """After eight of them the starts were told and not learnt from: the level stayed that of before the last."""
    rng, days, axes = np.random.default_rng(1), 12 + EVERY * FALLS + 20, 4
    shift = np.repeat(np.arange(days), PER)
    w, flat = len(shift), np.ones((days * PER, axes))
    level = rng.normal(0, 0.003, (days, axes))[shift] + 0.006 * rng.standard_normal((w, axes))
    level[:, 0] -= 0.06 * np.clip((shift - 12) // EVERY, 0, FALLS)
    worn = shift >= days - 8
    level[worn, 0] += 0.15
    start = 86400.0 * shift + 3600.0 * (np.arange(w) % PER)
    conditions = Conditions(start, start + 3600.0, np.nan * flat, np.zeros((w, axes, 5)), flat, np.zeros(w), None)
    baseline = shift < 12
    series = Series(level, 4e-5 * flat, np.ones(axes), np.ones(axes))
    normal = learn_axes([series], ["friction"], conditions, np.repeat(baseline[:, None], axes, axis=1), shift)
    found = watch(normal, Period(conditions, baseline, shift), Asked(1e-3))
    assert len(found.starts[0]) == FALLS
    assert abs(np.nanmean(found.residual[worn, 0]) - 0.15) < 0.02
    assert shift[np.flatnonzero(found.alarm[:, 0])[0]] <= days - 6
    assert not found.alarm[:, 1:].any()
