"""A line at one speed of a joint is a wave over its position; one at any speed is structure."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.search import leftovers
from jointwear.discovery.search.leftovers import LINE, unexplained

AXIS, FREQUENCY, SPEED, NEAR = 1, 9.0, 0.5, 0.2


def _line(white):
    return 0.8 * np.sin(2 * np.pi * FREQUENCY * white.problem.train_state.time)[:, None]


def _at_one_speed(white):
    """Return the torque (N, 1) [N m] of such a wave where the joint has nearly one speed."""
    speed = np.abs(white.problem.train_state.velocity[:, [AXIS]])
    return 4.0 * _line(white) * (np.abs(speed - SPEED) < NEAR)


def _unexplained(white, torque, step=None):
    problem = replace(white.problem, encoder_step=step)
    targets = [y + white.columns(a, torque)[:, 0] * (a == AXIS) for a, y in enumerate(white.targets)]
    lacking = replace(white, problem=problem, targets=targets)
    return [u.argument for u in unexplained(Outcome(problem, lacking, lacking.fit(), None), asked={(AXIS, LINE)})[0]]


@pytest.mark.parametrize("step", [0.06, None])
def test_a_line_at_any_speed_stays_unexplained_whether_the_step_is_known_or_not(white, step):
    assert _unexplained(white, _line(white), step) == [LINE]


def test_a_wave_at_one_speed_alone_is_no_line(white, monkeypatch):
    measured = white.problem.measured
    floor = np.full_like(measured.speed_floor, 2 * NEAR)
    coarse = replace(white.problem, measured=replace(measured, speed_floor=floor))
    torque = _at_one_speed(white)
    assert _unexplained(replace(white, problem=coarse), torque) == []
    monkeypatch.setattr(leftovers, "SPEEDS", 0)
    assert _unexplained(replace(white, problem=coarse), torque) == [LINE]
