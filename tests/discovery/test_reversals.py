"""Samples beside reversals that a derived motion does not show as they were."""

from dataclasses import replace

import numpy as np
import pytest

from jointwear.discovery import assumed
from jointwear.discovery.reversals import leave_out_reversals
from jointwear.measurement.motion import Measured

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
