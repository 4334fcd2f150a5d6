"""A torque that is early, as a command is, and structure beside it."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery import assumed
from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search import leftovers, taken_back
from jointwear.discovery.search.early_torque import delay_of
from jointwear.discovery.search.standing_alone import doubt_early_torque, shaken_alike, stand_alone

AXIS = 1


def late(white, delay, kind="motor"):
    """Return the outcome of data in which the torque of one joint is late, with that as its name."""
    candidate = Candidate("actuation_delay", AXIS, None, {"delay": delay, "lag": 0})
    columns = raw_columns(white, candidate)
    term = Term("early", {AXIS: white.columns(AXIS, columns)}, np.ones(1), {AXIS: white.raw(AXIS, columns)})
    discrepancy = white.problem.discrepancy.copy()
    discrepancy[white.problem.train, AXIS] += columns[:, 0]
    targets = [y + white.columns(a, columns[:, 0]) * (a == AXIS) for a, y in enumerate(white.targets)]
    problem = replace(white.problem, discrepancy=discrepancy, state=replace(white.problem.state, torque_kind=kind))
    asked = replace(white, problem=problem, targets=targets)
    return Outcome(problem, asked, asked.fit([term]), None, named=[Named(candidate, term, None, 99.0)])


@pytest.mark.parametrize(("share", "stands"), [(0.5, False), (-0.5, False), (2.0, True)])
def test_a_delay_within_what_the_time_of_a_torque_is_known_to_is_no_name(white, share, stands, monkeypatch):
    """A torque logged a quarter of a millisecond early on all joints, at 125 Hz, was the delay of one of them."""
    settled = []
    monkeypatch.setattr(taken_back, "settle", settled.append)
    outcome = late(white, share * assumed.CLOCK / white.problem.measured.logged_rate)
    taken_back.believe_no_delay_within_the_clock(outcome)
    assert bool(outcome.named) == stands
    assert len(settled) == len(outcome.refusals) == (not stands)
    assert all(r.reached < r.needed for r in outcome.refusals)


@pytest.mark.parametrize(
    ("periods", "kind", "others", "stands"),
    [
        (-0.4, "motor", False, False),
        (-0.4, "motor", True, True),
        (-0.4, "command", False, True),
        (0.4, "motor", False, True),
        (-0.8, "motor", False, True),
    ],
)
def test_a_torque_that_may_be_held_on_all_joints_is_no_delay_of_one(white, periods, kind, others, stands, monkeypatch):
    """0.4 ms early at 250 Hz, beside a spring and an elastic gear, had a name where the others could not say better."""
    monkeypatch.setattr(taken_back, "settle", lambda outcome: None)
    outcome = late(white, periods / white.problem.measured.logged_rate, kind)
    if not others:
        outcome.problem = replace(outcome.problem, judged=(AXIS,))
        outcome.white = replace(outcome.white, problem=outcome.problem)
    taken_back.believe_no_delay_within_the_clock(outcome)
    assert bool(outcome.named) == stands
    assert all(r.reached < r.needed and "held" in r.gate for r in outcome.refusals)


@pytest.mark.parametrize("open_axis", [AXIS, AXIS + 1])
@pytest.mark.parametrize(
    ("delay", "kind", "stands"), [(-0.02, "motor", False), (-0.02, "command", True), (0.02, "motor", True)]
)
def test_a_motor_torque_that_is_early_has_no_name_beside_structure(white, delay, kind, stands, open_axis):
    """A bad tooth, once in a turn of the motor, was named a torque that is 12 ms early."""
    outcome = late(white, delay, kind)
    left = [Unexplained(open_axis, "motor angle", "rad", 0.0, 6.3, 1e-12, 50.0)]
    outcome.unexplained = left
    stand_alone(outcome)
    assert bool(outcome.named) == (stands or open_axis != AXIS)
    assert not outcome.suspects or "early" in outcome.suspects[0][1]


def test_the_tolerance_of_a_form_takes_nothing_off_a_delay(white):
    """That of a delay holds the delay itself: 17 ms early came out as 0.9 ms late, and kept its name."""
    outcome = late(white, -0.02)
    (one,) = outcome.named
    wide = Term("form", one.term.blocks, 5.0 * np.ones(1), one.term.raw)
    outcome.named = [replace(one, form=wide)]
    outcome.fit = outcome.white.fit(outcome.named[0].terms)
    assert abs(outcome.fit.coefficients(one.term)[0]) < 0.5
    assert delay_of(outcome, outcome.named[0]) == pytest.approx(-0.02, rel=0.2)


def test_an_early_torque_is_asked_again_when_a_name_beside_it_has_fallen(white, monkeypatch):
    """What that had explained is left then."""
    outcome = late(white, -0.02)
    doubt_early_torque(outcome)
    assert outcome.named
    left = [Unexplained(AXIS, "line over time", "Hz", 6.6, 6.7, 1e-28, 80.0)]
    outcome.unexplained = left
    monkeypatch.setattr(leftovers, "unexplained", lambda _: (left, left))
    doubt_early_torque(outcome)
    assert not outcome.named
    assert "early" in outcome.suspects[0][1]


def test_a_delay_that_waves_over_time_explain_has_no_name_where_they_shake_other_joints(white):
    """A spindle out of balance, 6.4 Hz, shook five joints and was told as an elastic gear of a sixth."""
    outcome = late(white, 0.02)
    (one,) = outcome.named
    assert shaken_alike(outcome, one) is None
    lines = [Unexplained(axis, "line over time", "Hz", 6.4, 6.4, 1e-28, 80.0) for axis in (0, 2, AXIS)]
    outcome.unexplained = lines
    assert shaken_alike(outcome, one) is None
    # The same name of what does shake at that pace.
    shaking = np.sin(2 * np.pi * 6.4 * white.problem.train_state.time)[:, None]
    block = white.columns(AXIS, shaking)
    targets = [y + block[:, 0] if a == AXIS else y for a, y in enumerate(white.targets)]
    outcome.white = replace(white, targets=targets)
    one = replace(one, term=Term("early", {AXIS: block}, np.ones(1), {AXIS: white.raw(AXIS, shaking)}))
    outcome.named = [one]
    assert "shake joints 1 and 3, explain" in shaken_alike(outcome, one)
    # One other joint alone may swing with it.
    outcome.unexplained = lines[1:]
    assert shaken_alike(outcome, one) is None
