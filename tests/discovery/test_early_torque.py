"""A torque that is early, as a command is, and structure beside it."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search.standing_alone import stand_alone

AXIS = 1


@pytest.mark.parametrize("open_axis", [AXIS, AXIS + 1])
@pytest.mark.parametrize(
    ("delay", "kind", "stands"), [(-0.02, "motor", False), (-0.02, "command", True), (0.02, "motor", True)]
)
def test_a_motor_torque_that_is_early_has_no_name_beside_structure(white, delay, kind, stands, open_axis):
    """A bad tooth, once in a turn of the motor, was named a torque that is 12 ms early."""
    early = Candidate("actuation_delay", AXIS, None, {"delay": delay, "lag": 0})
    columns = raw_columns(white, early)
    term = Term("early", {AXIS: white.columns(AXIS, columns)}, np.ones(1), {AXIS: white.raw(AXIS, columns)})
    discrepancy = white.problem.discrepancy.copy()
    discrepancy[white.problem.train, AXIS] += columns[:, 0]
    targets = [y + white.columns(a, columns[:, 0]) * (a == AXIS) for a, y in enumerate(white.targets)]
    problem = replace(white.problem, discrepancy=discrepancy, state=replace(white.problem.state, torque_kind=kind))
    asked = replace(white, problem=problem, targets=targets)
    one = Named(early, term, None, 99.0)
    left = [Unexplained(open_axis, "motor angle", "rad", 0.0, 6.3, 1e-12, 50.0)]
    outcome = Outcome(problem, asked, asked.fit([term]), None, named=[one], unexplained=left)
    stand_alone(outcome)
    assert bool(outcome.named) == (stands or open_axis != AXIS)
    assert not outcome.suspects or "early" in outcome.suspects[0][1]
