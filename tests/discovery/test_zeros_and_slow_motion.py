"""Zeros that are set anew are no drift, a factor within its own error is none, and what is not seen is told."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import lacking_on, trial_of

from jointwear.discovery.estimates.refine import evidence_at, refine, simplest
from jointwear.discovery.problem.candidates import Candidate, raw_columns
from jointwear.discovery.problem.reversals import unseen_slow_motion
from jointwear.discovery.search.acceptance import sigmas_off
from jointwear.effects import get_effect

AXIS = 1
DRIFT = get_effect("torque_offset_drift")


@pytest.mark.parametrize("waves", [0.5, 1.2, 1.75, 2.3, 2.75, 3.3, 3.8])
def test_a_slow_wave_has_its_period_however_often_it_turns(white, waves):
    """The evidence has a peak for every half wave over the time of the recordings: a search stays on its own."""
    state = white.problem.train_state
    start, span = float(np.min(state.time)), float(np.ptp(state.time))
    lacking = lacking_on(white, AXIS, 7.0 * np.sin(2 * np.pi * waves * (state.time - start) / span + 0.4))
    fit = lacking.fit([])
    grid = [Candidate("torque_offset_drift", AXIS, None, p) for p in DRIFT.grid(state, AXIS) if "period" in p]
    best = max(grid, key=lambda c: evidence_at(lacking, fit, c))
    assert span / refine(lacking, fit, best).nonlinear["period"] == pytest.approx(waves, abs=0.1)


def test_of_waves_through_the_same_few_recordings_the_slowest_is_written(white):
    """Five points in time have many waves through them; between the recordings they differ."""
    state = white.problem.train_state
    record = np.asarray(state.record) - np.min(state.record)
    apart = replace(state, time=state.time + 400.0 * record**1.5)
    problem = replace(white.problem)
    problem.__dict__.update(train_state=apart)
    few, span = replace(white, problem=problem), float(np.ptp(apart.time))
    start = float(np.min(apart.time))
    fast = Candidate("torque_offset_drift", AXIS, None, {"start": start, "period": span / 4.0})
    for size, waves in ((0.5, 4.0), (40.0, 0.85)):
        lacking = lacking_on(few, AXIS, size * np.sin(2 * np.pi * waves * (apart.time - start) / span + 0.4))
        fit = lacking.fit([])
        found = simplest(lacking, fit, refine(lacking, fit, fast))
        assert found.nonlinear["period"] > 0.9 * span
        half = 0.5 * white.problem.settings.accept
        assert evidence_at(lacking, fit, found) > evidence_at(lacking, fit, refine(lacking, fit, fast)) - half
    # Where the data decide, the wave is as fast as they say.
    lacking = lacking_on(white, AXIS, 7.0 * np.sin(2 * np.pi * 3.3 * (state.time - state.time[0]) / np.ptp(state.time)))
    known = replace(fast, nonlinear={"start": float(state.time[0]), "period": float(np.ptp(state.time)) / 3.3})
    found = simplest(lacking, lacking.fit([]), known)
    assert found.nonlinear["period"] == pytest.approx(known.nonlinear["period"], rel=0.01)


def test_wear_between_recordings_is_as_most_forms_through_them_have_it(white):
    """Three levels say nothing of when the last was reached: growth that ends at once after the second is the edge."""
    state, wear = white.problem.train_state, get_effect("wear_drift")
    record = np.asarray(state.record) - np.min(state.record)
    when = np.array([0.0, 300.0, 5000.0])[record]
    apart = replace(state, time=state.time - np.array([state.time[record == k][0] for k in range(3)])[record] + when)
    problem = replace(white.problem)
    problem.__dict__.update(train_state=apart)
    few, span = replace(white, problem=problem), float(np.ptp(apart.time))
    share = apart.time / span
    lacking = lacking_on(few, AXIS, 5.0 * share**2 * apart.direction[:, AXIS])
    fit = lacking.fit([])
    sudden = Candidate("wear_drift", AXIS, None, {"start": 0.0, "rate": 4.0 / span, "exponent": 4.0})
    found = simplest(lacking, fit, refine(lacking, fit, sudden))
    one = apart.part(np.flatnonzero(apart.direction[:, AXIS] == 1)[:2])
    ends = replace(one, time=np.array([0.6, 1.0]) * span)
    growth, end = wear.columns(ends, AXIS, None, found.nonlinear)[:, 0]
    assert growth / end == pytest.approx(0.36, abs=0.12)
    growth, end = wear.columns(ends, AXIS, None, sudden.nonlinear)[:, 0]
    assert growth / end > 0.9


def test_a_factor_within_its_own_error_is_none(white):
    trial = trial_of(white, "torque_constant_error", AXIS, {})
    needed = white.problem.settings.mass_sigmas
    assert sigmas_off(white, [], white.fit([]), trial) < needed
    weaker = lacking_on(white, AXIS, 0.1 * raw_columns(white, trial.candidate)[:, 0])
    assert sigmas_off(weaker, [], weaker.fit([]), trial) > needed


@pytest.mark.parametrize(("reach", "slow", "told"), [(45.0, False, True), (45.0, True, False), (5.0, False, False)])
def test_speeds_that_are_not_seen_are_told(reach, slow, told):
    velocity = np.linspace(0.0 if slow else 0.2, 1.0, 500)[:, None]
    measured = SimpleNamespace(
        band=np.inf,
        reach=np.array([reach]),
        rate=100.0,
        velocity=velocity,
        usable=velocity > 0.01,
        speed_floor=np.array([0.01]),
    )
    words = unseen_slow_motion(measured, (0,))
    assert bool(words) == told
    assert not told or "friction at speeds below 0.21 rad/s on joint 1 cannot be seen" in words[0]
