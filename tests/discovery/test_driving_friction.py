"""A torque that is the same throughout a motion: friction may stand for it as long as it brakes."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Outcome, Unexplained
from jointwear.discovery.search.driving_friction import DIRECTION, driving_friction, driving_in_words

AXIS = 2


def with_constant_torque(white, times):
    """Return the outcome of data in which one torque is off by so many times the friction of its joint."""
    robot = white.problem.robot
    torque = times * robot.coulomb_positive[AXIS] * np.ones(len(white.problem.train_state.time))
    targets = [y + white.columns(AXIS, torque) if a == AXIS else y for a, y in enumerate(white.targets)]
    asked = replace(white, targets=targets)
    return Outcome(white.problem, asked, asked.fit(), None)


@pytest.mark.parametrize(("times", "directions"), [(0.0, []), (0.7, []), (-0.7, []), (2.0, [-1.0]), (-2.0, [1.0])])
def test_friction_that_would_have_to_drive_is_something_else(white, times, directions):
    """A dead zone that gravity held on one side was 'retuned': friction of 1.4 N m one way and none the other."""
    found = driving_friction(with_constant_torque(white, times))
    assert [(u.axis, u.argument, u.low) for u in found] == [(AXIS, DIRECTION, d) for d in directions]
    assert all(
        u.p_value < white.problem.settings.unexplained_p and u.nats > white.problem.settings.accept for u in found
    )
    assert [w[:8] for w in driving_in_words(found)] == ["joint 3:"] * len(directions)


def test_a_joint_that_stays_unexplained_is_told_once(white):
    outcome = with_constant_torque(white, 2.0)
    outcome.unexplained = [Unexplained(AXIS, "position", "rad", 0.0, 1.0, 1e-12, 50.0)]
    assert driving_friction(outcome) == []
