"""An effect whose size changes during the recordings is none of those that a robot file can hold."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.search.changing_size import CHANGING, changing
from jointwear.discovery.search.slow_noise import beside_slow_noise
from jointwear.discovery.search.standing_alone import stand_alone
from jointwear.effects import get_effect

AXIS = 2
SPRING = Candidate("joint_spring", AXIS, None, {"centre": 0.0, "low": -9.0, "high": 9.0})


def _outcome(white, candidate, size):
    """Return an outcome in which an effect has a name, whose torque is `size` (N_train,) times that of its columns."""
    columns = raw_columns(white, candidate)
    term = Term(
        candidate.effect,
        {AXIS: white.columns(AXIS, columns)},
        np.full(columns.shape[1], 20.0),
        {AXIS: white.raw(AXIS, columns)},
    )
    extra = white.columns(AXIS, (size * columns.sum(axis=1))[:, None])[:, 0]
    asked = replace(white, targets=[y + extra if a == AXIS else y for a, y in enumerate(white.targets)])
    return Outcome(asked.problem, asked, asked.fit([term]), None, named=[Named(candidate, term, None, 99.0)])


@pytest.mark.parametrize(
    ("share", "least", "most"),
    [(1.0, None, None), (0.9, None, None), (0.5, CHANGING, 1.2)],
    ids=["all", "most", "half"],
)
def test_what_is_there_for_a_part_of_the_time_is_told_by_its_spread(white, share, least, most):
    clock = white.problem.train_state.time
    outcome = _outcome(white, SPRING, 9.0 * (np.mod(clock, 4.0) < 4.0 * share))
    spread = changing(outcome, outcome.named[0])
    assert (spread is None) if least is None else least < spread < most
    if least is not None:
        stand_alone(outcome)
        assert not outcome.named
        assert outcome.suspects[0][1].startswith("its size is not the same throughout the recordings")


@settings(max_examples=10, deadline=None)
@given(size=st.floats(-9.0, 9.0), seed=st.integers(0, 99))
def test_noise_of_the_size_of_the_effect_moves_no_size(white, size, seed):
    outcome = _outcome(white, SPRING, np.full(len(white.problem.train_state.time), size))
    noise = np.random.default_rng(seed).standard_normal(len(outcome.white.targets[AXIS]))
    targets = [y + noise if a == AXIS else y for a, y in enumerate(outcome.white.targets)]
    white_again = replace(outcome.white, targets=targets)
    again = replace(outcome, white=white_again, fit=white_again.fit(outcome.fit.terms[-1:]))
    assert changing(again, again.named[0]) is None


def test_a_size_that_swings_by_less_than_half_keeps_its_name(white):
    """A form that is a little off, or a wear that goes on, is of that kind."""
    clock = white.problem.train_state.time
    outcome = _outcome(white, SPRING, 9.0 * (1.0 + 0.4 * CHANGING * np.sin(clock)))
    assert changing(outcome, outcome.named[0]) is None


@pytest.mark.parametrize(
    ("effect", "form"),
    [("torque_offset_drift", {"start": 0.0, "time_constant": 60.0}), ("temperature_dependent_coulomb_friction", None)],
)
def test_what_follows_the_time_or_the_temperature_is_not_asked(white, effect, form):
    form = get_effect(effect).grid(white.problem.train_state, AXIS)[0] if form is None else form
    candidate = Candidate(effect, AXIS, None, form)
    outcome = _outcome(white, candidate, 1.0 * (np.mod(white.problem.train_state.time, 10.0) < 5.0))
    assert changing(outcome, outcome.named[0]) is None


@pytest.mark.parametrize("grows", [False, True])
def test_a_delay_that_grows_within_each_record_is_that_of_a_clock(white, grows):
    """Its mean looks like friction and inertia too, what varies about it does not."""
    state = white.problem.train_state
    begins = np.array([state.time[np.asarray(state.record) == r].min() for r in state.record])
    lasts = np.array([np.ptp(state.time[np.asarray(state.record) == r]) for r in state.record])
    size = 2.0 * (state.time - begins) / lasts if grows else np.ones(len(state.time))
    outcome = _outcome(white, Candidate("actuation_delay", AXIS, None, {"delay": 0.02, "lag": 0}), size)
    spread = changing(outcome, outcome.named[0])
    assert (spread is not None) == grows
    stand_alone(outcome)
    assert outcome.unsteady == ({("actuation_delay", AXIS, None)} if grows else set())


@pytest.mark.parametrize(("unsteady", "asked"), [(set(), 2), ({SPRING.key}, 1)])
def test_slow_noise_makes_no_size_constant_that_was_seen_to_change(white, monkeypatch, unsteady, asked):
    outcome = _outcome(white, SPRING, np.ones(len(white.problem.train_state.time)))
    first = replace(outcome, named=[], unsteady=unsteady)
    answers = iter([first, outcome])
    louder = iter([white.whiteners, None])
    monkeypatch.setattr("jointwear.discovery.search.slow_noise.slower_noise", lambda _: next(louder))
    monkeypatch.setattr("jointwear.discovery.search.slow_noise.whiten", lambda *_: white)
    assert beside_slow_noise(white, lambda _: next(answers)) is (outcome if asked == 2 else first)
