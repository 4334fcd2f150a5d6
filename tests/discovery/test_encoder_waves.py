"""Waves over the steps of an encoder are no structure; a line of its own is, whatever the steps are."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.leftovers import LINE, unexplained, without_steps
from jointwear.discovery.outcome import Outcome

AXIS, STEP = 1, 0.06


def _answer(white):
    """Return the torque (N, 1) [N m] of a controller that follows positions in steps."""
    return 0.8 * np.sin(2 * np.pi * white.problem.train_state.position[:, [AXIS]] / STEP + 0.4)


def _line(white):
    return 0.8 * np.sin(2 * np.pi * 9.0 * white.problem.train_state.time)[:, None]


def _left(white, torque):
    own = white.columns(AXIS, torque)[:, 0]
    return np.sum(without_steps(white, AXIS, own, STEP) ** 2) / np.sum(own**2)


def test_waves_over_the_steps_are_taken_off_and_a_line_is_not(white):
    assert _left(white, _answer(white)) < 0.05
    assert _left(white, _line(white)) > 0.7


@pytest.mark.parametrize("known", [True, False])
def test_a_line_stays_unexplained_whether_the_step_is_known_or_not(white, known):
    problem = replace(white.problem, encoder_step=STEP if known else None)
    targets = [y + white.columns(a, _line(white))[:, 0] * (a == AXIS) for a, y in enumerate(white.targets)]
    lacking = replace(white, problem=problem, targets=targets)
    found, _ = unexplained(Outcome(problem, lacking, lacking.fit(), None), asked={(AXIS, LINE)})
    assert [u.argument for u in found] == [LINE]
