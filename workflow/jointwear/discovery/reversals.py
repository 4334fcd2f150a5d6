"""Samples that no model can be judged by: unresolved reversals, and stops of a drive that two joints share.

Where the sampling does not resolve a reversal a derived acceleration is wrong, and looks like a delay.

A controller with some play turns the torque at another instant than the joint turns. In between the acceleration is
a short pulse. Positions that were sampled too slowly do not hold it; their spectrum then reaches the end of the band
instead of falling to its noise floor.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from jointwear.effects.rests import rests
from jointwear.measurement.motion import RESOLVED, Measured, runs

#: Time [s] left out on either side of a reversal that is not resolved.
BESIDE = 0.1
#: Joints that may share a drive are at most this far apart.
REACH = 2
#: Joints that turn as one for more than this share of their motion are made to, by the program: nothing sticks.
MADE_TO = 0.2


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


def leave_out_shared_stops(measured: Measured) -> Measured:
    """Return the samples without those at which two joints turn as one, because a drive that both share sticks.

    Its friction is then anything up to Coulomb friction, on both joints, whatever drags along with whatever.
    """
    usable, records = measured.usable.copy(), runs(measured.trajectory)
    n = usable.shape[1]
    for i, j in combinations(range(n), 2):
        if j - i > REACH:
            continue
        moving = measured.usable[:, i] & measured.usable[:, j]
        for sign in (1.0, -1.0):
            stuck = np.zeros(len(usable), dtype=bool)
            for rest in rests(measured.velocity[:, i] + sign * measured.velocity[:, j], measured.time, records):
                stuck[max(rest.samples.start - 1, 0) : rest.samples.stop + 1] = True
            stuck &= moving
            if stuck.sum() <= MADE_TO * moving.sum():
                usable[stuck, i] = usable[stuck, j] = False
    return replace(measured, usable=usable)
