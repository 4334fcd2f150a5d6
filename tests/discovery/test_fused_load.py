"""A load made of model and torque, and what an elastic gear does above the band of its columns."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from discovery_cases import coarse

from jointwear import effects
from jointwear.discovery import assumed
from jointwear.discovery.estimates.beyond_band import beyond_band
from jointwear.discovery.noise.noise import estimate
from jointwear.discovery.problem.candidates import Candidate, raw_columns, term_of, wider
from jointwear.discovery.problem.fused_load import end_of_columns, fused_load
from jointwear.discovery.problem.saturated import estimate_noise
from jointwear.discovery.problem.setting_up import build_problem
from jointwear.discovery.problem.whitening import whiten
from jointwear.discovery.settings import Settings
from jointwear.effects.order import second_derivative
from jointwear.measurement.derived.derived_noise import DerivedNoise
from jointwear.measurement.derived.filtering import derivatives, limit, low_pass
from jointwear.measurement.recording import split


def one_joint(share=0.0):
    """A link of 0.6 kg m2 behind a motor of 0.4 kg m2, positions with white noise that was derived up to 20 Hz.

    Returns the problem, load (N,) without noise, residual (N,) with an elastic gear of `share` [s2], and its noise
    model.
    """
    rng, rate, count = np.random.default_rng(6), 100.0, 4000
    link, motor, spread, torque_noise_ = 0.6, 0.4, 1e-4, 0.02
    time = np.arange(count) / rate
    noise = DerivedNoise(np.array([[spread**2 / (rate / 2)]]), (2,), np.array([20.0]), False, rate)
    shaken = low_pass(derivatives(time, low_pass(rng.normal(0, spread, count), 20.0, rate))[1], 20.0, rate)
    residual = rng.normal(0, torque_noise_, count) - (link + motor) * shaken
    load = 3.0 * np.sin(2 * np.pi * 0.5 * time) + (0.1 * np.sin(2 * np.pi * 9.0 * time) if share else 0.0)
    problem = SimpleNamespace(
        measured=SimpleNamespace(rate=rate, noise=noise),
        mass_squares=np.array([[(link + motor) ** 2]]),
        robot=SimpleNamespace(armature=np.array([motor])),
        train_state=SimpleNamespace(load=(load + link * shaken)[:, None], record=np.zeros(count)),
        settings=Settings(),
    )
    white = estimate(residual, np.ones(count, bool), np.zeros(count, int), 16)
    return problem, load, residual + share * second_derivative(_clock(time), load), white


def test_a_fused_load_shares_no_noise_with_the_residual():
    problem, load, residual, white = one_joint()
    fused = fused_load(problem, 0, white, residual)
    time = np.arange(len(load)) / problem.measured.rate
    given = problem.train_state.load[:, 0]
    errors = [second_derivative(_clock(time), x - load)[50:-50] for x in (given, fused)]
    shared = [np.corrcoef(x, residual[50:-50])[0, 1] for x in errors]
    assert shared[0] > 0.7
    assert abs(shared[1]) < 0.1
    assert np.std(errors[1]) < 0.6 * np.std(errors[0])


def test_a_fused_load_keeps_a_gear_that_it_knows():
    """What a gear adds to the residual is no noise of the load: not known, it takes most of a wave near its swing."""
    share = 3e-4
    problem, load, residual, white = one_joint(share)
    wave = load - low_pass(load, 3.0, problem.measured.rate)
    seen = [fused_load(problem, 0, white, residual, x) @ wave / (wave @ wave) for x in (0.0, share)]
    assert seen[0] < 0.6
    assert seen[1] == pytest.approx(1.0, abs=0.05)


def test_columns_of_a_soft_gear_end_before_the_fused_load_is_spoilt():
    problem, _, _, white = one_joint()
    ends = [end_of_columns(problem, 0, white, share, 7.0, 14.0) for share in (1e-6, 1e-4, 3e-4, 1e-2)]
    assert ends == sorted(ends, reverse=True)
    assert (ends[0], ends[-1]) == pytest.approx((14.0, 7.0))


def test_what_a_gear_does_above_its_band_does_not_change_its_size(robot):
    problem = build_problem(split(coarse(robot)), robot, Settings())
    white = whiten(problem, estimate_noise(problem))
    # Columns that end within the motion.
    white = replace(white, cutoffs=[replace(c, timing=1.0) for c in white.cutoffs])
    gear = Candidate("joint_flexibility", 1, None, {"inertia_over_stiffness": 1e-4, "inertia": 0.0, "side": 0})
    # A late torque has none: where its columns end what is above is noise.
    late = Candidate("actuation_delay", 1, None, {"delay": 0.01, "lag": 1})
    (beside,) = beyond_band(white, [gear, late])
    assert not np.any(beside.raw[1])
    state = white.state_of(effects.get_effect(gear.effect), 1, gear.nonlinear, assumed.OCTAVE)
    whole = white.columns(1, effects.get_effect(gear.effect).columns(state, 1, None, gear.nonlinear))[:, 0]
    lacking = replace(white, targets=[whole if axis == 1 else 0 * y for axis, y in enumerate(white.targets)])
    term = term_of(white, gear)
    sizes = [float(lacking.fit([term, *more]).theta[-1 - len(more)]) for more in ([], [beside])]
    assert sizes[0] > 1.1
    assert sizes[1] == pytest.approx(1.0, abs=0.05)


def test_a_gear_that_is_refused_is_asked_again_as_far_up_as_torque_can_be_judged(robot):
    problem = build_problem(replace(split(coarse(robot)), encoder_side="link"), robot, Settings())
    white = whiten(problem, estimate_noise(problem))
    white = replace(white, cutoffs=[replace(c, timing=1.0, swing=1.0, judged=8.0) for c in white.cutoffs])
    gear = Candidate("joint_flexibility", 1, None, {"inertia_over_stiffness": 1e-4, "inertia": 0.0, "side": 0})
    wide = wider(white, gear)
    assert wide == replace(gear, wide=True)
    assert wide.key == gear.key
    # What wide columns have beyond the others is of the load of the model.
    state, record, rate = problem.train_state, problem.train_state.record, problem.measured.rate
    load = state.load[:, [1]]
    beyond = (limit(load, record, 8.0, rate) - limit(load, record, 1.0, rate))[:, 0]
    more = raw_columns(white, wide) - raw_columns(white, gear)
    assert more[:, 0] == pytest.approx(1e-4 * second_derivative(state, beyond))
    # Where that is no further up, for another effect and with positions of the motor there are none.
    low = replace(white, cutoffs=[replace(c, judged=0.5) for c in white.cutoffs])
    late = Candidate("actuation_delay", 1, None, {"delay": 0.01, "lag": 1})
    before = replace(white, problem=replace(problem, state=replace(problem.state, encoder_side="motor")))
    assert [wider(low, gear), wider(white, late), wider(before, gear)] == [None, None, None]


def _clock(time):
    return SimpleNamespace(record=np.zeros(len(time)), time=time)
