"""Which axis an alarm is of, and how sure that is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.monitor.watching.locate import axis_probability, honest_probability
from jointwear.monitor.watching.records import evidence


def test_probabilities_of_axes():
    z, limit = np.array([5.0, 1.0, np.nan, 4.9]), np.full(4, 4.2)
    p = axis_probability(z, limit)
    assert p[0] > 0.99
    assert p[3] > 0.99
    assert p[1] == pytest.approx(1.0)
    assert p[2] == 0.0
    assert axis_probability(np.array([4.3, 4.1]), np.full(2, 4.2))[0] < 0.8


def test_a_weak_alarm_beside_a_strong_one_or_while_all_axes_move_is_not_sure():
    z, limit = np.array([9.0, 4.5, 1.0, np.nan]), np.full(4, 4.0)
    p = honest_probability(z, limit)
    assert p[0] > 0.99
    assert p[1] == pytest.approx(1 / (1 + 5 * np.exp((16 - 20.25) / 2)), abs=1e-3)
    assert p[3] == 0.0
    assert honest_probability(np.array([9.0, 8.0, 1.0, np.nan]), limit)[1] > 0.99
    one = np.array([4.0 + 1e-9, 0.0, 0.0, 0.0])
    assert honest_probability(one, limit)[0] == pytest.approx(axis_probability(one, limit)[0])
    assert honest_probability(one, limit, together=True)[0] == pytest.approx(0.5, abs=1e-3)


def test_a_step_is_as_sure_as_its_own_chart_is_beyond_its_threshold():
    def of(step):
        level = SimpleNamespace(
            residual=np.zeros((1, 2)), mean=np.array([[0.02, 0.0]]), mean_std=np.full((1, 2), 0.01),
            threshold=np.full(2, 4.0), step=np.array([[step, -np.inf]]), step_threshold=np.full(2, 5.0),
            alarm=np.array([[True, False]]),
        )  # fmt: skip
        return evidence(level)

    told, threshold = of(6.0)
    assert told[0, 0] ** 2 - threshold[0, 0] ** 2 == pytest.approx(11.0)
    assert honest_probability(told[0], threshold[0], together=True)[0] > 0.95
    # An alarm of the level alone stays what the level says.
    assert of(-np.inf)[0][0, 0] == pytest.approx(2.0)
    assert told[0, 1] == 0.0
