"""Reversals that the sampling does not resolve: there a derived acceleration is wrong, and looks like a delay.

A controller with some play turns the torque at another instant than the joint turns. In between the acceleration is
a short pulse. Positions that were sampled too slowly do not hold it; their spectrum then reaches the end of the band
instead of falling to its noise floor.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.motion import RESOLVED, Measured

#: Time [s] left out on either side of a reversal that is not resolved.
BESIDE = 0.1


def resolved_motion(measured: Measured) -> bool:
    """Return whether accelerations were measured, or derived from a motion that the sampling resolves.

    Recordings at a high rate are reduced with the torque filtered alike: there nothing is amiss.
    """
    if np.isfinite(measured.band) or measured.reach is None:
        return True
    return bool(np.max(measured.reach) < RESOLVED * measured.rate)


def leave_out_reversals(measured: Measured) -> Measured:
    """Return the samples without those near reversals where the motion is not resolved."""
    if resolved_motion(measured):
        return measured
    usable = measured.usable.copy()
    reach = int(np.ceil(BESIDE * measured.rate))
    for axis in np.flatnonzero(np.isfinite(measured.cutoff)):
        v = measured.velocity[:, axis]
        moves = np.where(np.abs(v) > measured.speed_floor[axis], np.sign(v), 0.0)
        for instant in np.flatnonzero(np.diff(moves) != 0) + 1:
            usable[max(instant - reach, 0) : instant + reach + 1, axis] = False
    return replace(measured, usable=usable)
