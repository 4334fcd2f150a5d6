"""What lies outside the library: shaking whose rate changes, and torque between joints that a name would put in one."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.discovery.estimates.outcome import Named, Outcome, Unexplained
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search import acceptance
from jointwear.discovery.search.acceptance import predictive
from jointwear.discovery.search.crossval import CrossValidated
from jointwear.discovery.search.explained import explained, explained_elsewhere
from jointwear.discovery.search.leftovers import LINE
from jointwear.discovery.search.residual_lines import strongest_line
from jointwear.discovery.search.standing_alone import acts_elsewhere, left_open, nearly_all, stand_alone

RATE, SAMPLES, RECORDS = 100.0, 1100, 3


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 99), st.floats(0.05, 0.42), st.floats(0.5, 3.0))
def test_a_slow_sweep_is_found_at_any_rate(seed, rise, first):
    """Half the amplitude of the noise, whose power is spread over 550 frequencies."""
    rng = np.random.default_rng(seed)
    clock = np.arange(SAMPLES) / RATE
    wave = [np.sin(2 * np.pi * (first * clock + rise * clock**2 / 2) + rng.uniform(0, 6)) for _ in range(RECORDS)]
    state = SimpleNamespace(record=np.repeat(np.arange(RECORDS), SAMPLES))
    noise = rng.standard_normal(RECORDS * SAMPLES)
    rows = np.arange(len(noise))
    assert strongest_line(noise, rows, state, RATE).p_value > 1e-8
    line = strongest_line(noise + 0.5 * np.concatenate(wave), rows, state, RATE)
    assert line.p_value < 1e-8
    assert line.rate == pytest.approx(rise, abs=0.03)
    assert line.frequency == pytest.approx(first, abs=0.3)


def _outcome(white, torques):
    """Return an outcome in which a spring of joint 3 has a name and joint 2 lacks what `torques` says."""
    spring = Candidate("joint_spring", 2, None, {"centre": 0.0, "low": -9.0, "high": 9.0})
    columns = raw_columns(white, spring)
    term = Term("spring", {2: white.columns(2, columns)}, np.full(4, 20.0), {2: white.raw(2, columns)})
    targets = [y + white.columns(a, torques[a]) if a in torques else y for a, y in enumerate(white.targets)]
    asked = replace(white, targets=targets)
    left = [Unexplained(1, "position", "rad", 0.0, 1.0, 1e-12, 50.0)]
    return Outcome(
        asked.problem, asked, asked.fit([term]), None, named=[Named(spring, term, None, 99.0)], unexplained=left
    )


def test_a_torque_that_two_joints_share_is_no_spring_of_one(white):
    state = white.problem.train_state
    hose, other = 20.0 * np.sin(state.position[:, 2]), 20.0 * np.sin(7 * state.time)
    shared = _outcome(white, {1: hose, 2: hose})
    assert acts_elsewhere(shared, shared.named[0]) == 1
    apart = _outcome(white, {1: other, 2: hose})
    assert acts_elsewhere(apart, apart.named[0]) is None
    stand_alone(shared)
    assert not shared.named
    assert "joint 2" in shared.suspects[0][1]


@pytest.mark.parametrize("wave", [False, True])
def test_a_wave_that_shakes_a_joint_is_no_timing(white, wave):
    """Its name explains all that the joint lacks; beside waves of each record nothing is left of it."""
    late = Candidate("actuation_delay", 1, None, {"delay": 0.02, "lag": 0})
    columns = raw_columns(white, late)
    torque = 20.0 * np.sin(2 * np.pi * 1.3 * white.problem.train_state.time)[:, None] if wave else columns
    term = Term("late", {1: white.columns(1, torque)}, np.ones(1), {1: white.raw(1, torque)})
    discrepancy = white.problem.discrepancy.copy()
    discrepancy[white.problem.train, 1] += torque[:, 0]
    targets = [y + white.columns(a, torque[:, 0]) * (a == 1) for a, y in enumerate(white.targets)]
    asked = replace(white, problem=replace(white.problem, discrepancy=discrepancy), targets=targets)
    left = [Unexplained(1, LINE, "Hz", 1.3, 1.3, 1e-12, 50.0)]
    named = [Named(late, term, None, 99.0)]
    outcome = Outcome(asked.problem, asked, asked.fit([term]), None, named=named, unexplained=left)
    stand_alone(outcome)
    assert bool(outcome.named) == (not wave)
    assert not wave or "the structure that is left" in outcome.suspects[0][1]


def test_a_delay_is_not_lost_for_a_few_samples_beside_reversals(white):
    late = Candidate("actuation_delay", 1, None, {"delay": 0.02, "lag": 0})
    columns = raw_columns(white, late)
    term = Term("late", {1: white.columns(1, columns)}, np.ones(1), {1: white.raw(1, columns)})
    discrepancy = white.problem.discrepancy.copy()
    discrepancy[white.problem.train, 1] += columns[:, 0]
    targets = [y + white.columns(a, columns[:, 0]) * (a == 1) for a, y in enumerate(white.targets)]
    rows = white.whiteners[1].rows
    turning = np.argsort(np.abs(white.axis_state(1).velocity[rows, 1]))[:20]
    signs = np.where(np.arange(len(turning)) % 2, 1.0, -1.0)
    targets[1][turning] += signs * 1.05 * np.sqrt(np.sum(targets[1] ** 2) / len(turning))
    asked = replace(white, problem=replace(white.problem, discrepancy=discrepancy), targets=targets)
    left = [Unexplained(1, "velocity", "rad/s", 0.0, 0.1, 1e-12, 50.0)]
    one = Named(late, term, None, 99.0)
    outcome = Outcome(asked.problem, asked, asked.fit([term]), None, named=[one], unexplained=left)
    stand_alone(outcome)
    assert outcome.named == [one]


def test_a_body_that_links_could_stand_for_is_told_by_evidence(white, monkeypatch):
    """What the links take over at the price of unlikely parameters they predict as well."""
    barely = CrossValidated(nats=5.0, share=0.9)
    monkeypatch.setattr(acceptance, "cross_validate", lambda *_: barely)
    term = Term("", {1: np.zeros((len(white.targets[1]), 1))}, np.ones(1))

    def missed(candidate):
        return [r.gate for r in predictive(white, [], Named(candidate, term, None, 400.0))[1]]

    assert missed(Candidate("payload", None, None, {})) == []
    assert missed(Candidate("mounting_tilt", None, None, {})) == ["nats gained on records left out"]
    barely = CrossValidated(nats=-5.0, share=0.9)
    assert missed(Candidate("payload", None, None, {})) == ["nats gained on records left out"]


def test_a_name_of_the_whole_arm_is_asked_where_most_axes_that_it_moves_stay_open(white):
    tilt = Candidate("mounting_tilt", None, None)
    columns = raw_columns(white, tilt)
    moved = [a for a in range(6) if np.abs(columns[:, a]).max() > 1e-6]
    term = Term(
        "tilt",
        {a: white.columns(a, columns[:, a]) for a in moved},
        np.ones(2),
        {a: white.raw(a, columns[:, a]) for a in moved},
    )
    targets = [y + white.columns(a, columns[:, a] @ [0.3, 0.0]) for a, y in enumerate(white.targets)]
    asked = replace(white, targets=targets)
    one = Named(tilt, term, None, 500.0)
    fit = asked.fit([term])

    def left(axes):
        open_axes = [Unexplained(a, "position", "rad", 0.0, 1.0, 1e-12, 50.0) for a in axes]
        return left_open(Outcome(asked.problem, asked, fit, None, named=[one], unexplained=open_axes), one)

    strong = [a for a in moved if float(np.sum((term.blocks[a] @ [0.3, 0.0]) ** 2)) > asked.problem.settings.visible]
    assert len(strong) > 2
    assert left(strong) == strong
    assert left(strong[:1]) == []
    assert left([]) == []


def test_a_name_that_is_worth_less_than_what_is_left_on_its_joint_is_a_suspect(white):
    outcome = _outcome(white, {2: 20.0 * np.sin(white.problem.train_state.position[:, 2])})
    outcome.unexplained = [replace(outcome.unexplained[0], axis=2, nats=1.01 * outcome.named[0].evidence)]
    stand_alone(outcome)
    assert [reason for _, reason in outcome.suspects] == [
        "100 nats over position are left on joint 3, more than it explains"
    ]


def test_what_one_record_alone_shows_is_not_nearly_all_of_what_a_joint_lacks(white):
    """A torque that only the last of three records has is told by its other parts, and not by the other records."""
    problem = replace(white.problem)
    order = np.arange(problem.train.sum())
    fold, part = order * 3 // len(order), order * 6 // len(order)
    problem.__dict__.update(fold_of_sample=fold, part_of_sample=part)
    spring = Candidate("joint_spring", 2, None, {"centre": 0.0, "low": -9.0, "high": 9.0})
    column = (fold == 2)[:, None].astype(float)
    term = Term("spring", {2: white.columns(2, column)}, np.array([1e3]), {2: white.raw(2, column)})
    lacking = np.array(problem.discrepancy)
    lacking[np.flatnonzero(problem.train), 2] += 20.0 * column[:, 0]
    targets = [y + white.columns(2, 20.0 * column)[:, 0] if a == 2 else y for a, y in enumerate(white.targets)]
    trial = replace(white, problem=problem, targets=targets)
    problem.__dict__["discrepancy"] = lacking
    one = Named(spring, term, None, 99.0)
    assert explained(trial, [], one, predictive(trial, [], one)[0]) > 0.8
    assert explained_elsewhere(trial, [], one) < 0.5
    drift = replace(one, candidate=Candidate("torque_offset_drift", 2, None, {"start": 0.0, "period": 9.0}))
    assert explained_elsewhere(trial, [], drift) == 1.0


def test_what_a_form_may_be_off_by_does_not_ask_for_whole_records(white, monkeypatch):
    """A name that no other record shows stands beside structure that is small beside it, and not beside more."""
    outcome = _outcome(white, {2: 20.0 * np.sin(white.problem.train_state.position[:, 2])})
    one, form_error = outcome.named[0], white.problem.settings.form_error
    monkeypatch.setattr("jointwear.discovery.search.standing_alone.explained_elsewhere", lambda *_: 0.5)
    assert nearly_all(outcome, [], one, 0.9, 0.9 * form_error * one.evidence)
    assert not nearly_all(outcome, [], one, 0.9, 1.1 * form_error * one.evidence)
    assert not nearly_all(outcome, [], one, 0.7, 0.0)
