"""Samples beside reversals that a derived motion does not show as they were."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jointwear.discovery import assumed
from jointwear.discovery.problem.reversals import leave_out_reversals, leave_out_ringing
from jointwear.measurement.derived.motion import Measured, measure
from jointwear.measurement.recording import Recording

RATE, TURN = 200.0, 300


def turning(**more):
    """One joint that turns at sample 300 of 600, and one that goes on."""
    time = np.arange(600) / RATE
    velocity = np.stack([1.5 - time + 1e-9, np.ones(600)], axis=1)
    velocity[TURN:, 0] = -np.abs(velocity[TURN:, 0])
    return Measured(
        time=time,
        trajectory=np.zeros(600, dtype=int),
        position=np.cumsum(velocity, axis=0) / RATE,
        velocity=velocity,
        acceleration=np.zeros((600, 2)),
        torque=np.ones((600, 2)),
        temperature=np.full((600, 2), np.nan),
        usable=np.ones((600, 2), dtype=bool),
        cutoff=np.array([20.0, 20.0]),
        rate=RATE,
        speed_floor=np.array([0.0, 0.0]),
        **more,
    )


def left_out(measured):
    usable = leave_out_reversals(measured).usable
    assert usable[:, 1].all()
    return np.flatnonzero(~usable[:, 0])


def test_a_resolved_motion_keeps_all_samples():
    assert len(left_out(turning(reach=np.array([5.0, 5.0])))) == 0


def test_splines_leave_out_one_spacing_of_their_knots_before_a_reversal_alone():
    found = left_out(turning(reach=np.array([5.0, 5.0]), fitted=True))
    spacing = int(np.ceil(0.5 / 20.0 * RATE))
    np.testing.assert_array_equal(found, np.arange(TURN - spacing, TURN + 1))


@pytest.mark.parametrize("fitted", [False, True])
def test_what_sampling_does_not_resolve_is_left_out_on_both_sides(fitted):
    found = left_out(turning(reach=np.array([90.0, 90.0]), fitted=fitted))
    reach = int(np.ceil(assumed.BESIDE * RATE))
    np.testing.assert_array_equal(found, np.arange(TURN - reach, TURN + reach + 1))


def test_wide_knots_leave_out_no_more_than_what_is_not_resolved():
    wide = replace(turning(reach=np.array([1.0, 1.0]), fitted=True), cutoff=np.array([1.0, 1.0]))
    assert left_out(wide)[0] == TURN - int(np.ceil(assumed.BESIDE * RATE))


@pytest.mark.parametrize("rate", [500.0, 1000.0])
def test_the_step_of_friction_rings_in_no_sample_that_is_used_of_a_reduced_rate(rate):
    time = np.arange(0.0, 20.0, 1.0 / rate)
    phase = np.outer(time, [3.1, 4.3]) + np.arange(2.0)
    position, velocity = [0.8, 0.5] * np.sin(phase), [2.48, 2.15] * np.cos(phase)
    torque = -0.6 * position * [9.61, 18.49] + 2.0 * np.sign(velocity)
    arm = SimpleNamespace(coulomb_positive=np.full(2, 2.0), coulomb_negative=np.full(2, -2.0))

    def seen(noise):
        heard = torque + noise * np.random.default_rng(1).standard_normal(torque.shape)
        return measure(Recording(time, np.zeros(len(time), dtype=int), position, heard))

    quiet = seen(1e-4)
    assert 0 < quiet.rate < 0.5 * rate
    left = np.abs(quiet.torque - 0.6 * quiet.acceleration - 2.0 * np.sign(quiet.velocity))
    used = leave_out_ringing(quiet, arm).usable
    assert used.mean() > 0.8
    assert left[used].max() < 0.03 < left[quiet.usable].max()
    loud = seen(1.0)
    assert np.array_equal(leave_out_ringing(loud, arm).usable, loud.usable)
    slow = replace(quiet, band=np.inf)
    assert leave_out_ringing(slow, arm) is slow
