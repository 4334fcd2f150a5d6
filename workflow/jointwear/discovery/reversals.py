"""Reversals that the sampling does not resolve: there a derived acceleration is wrong, and looks like a delay.

A controller with some play turns the torque at another instant than the joint turns. In between the acceleration is
a short pulse. Positions that were sampled too slowly do not hold it; their spectrum then reaches the end of the band
instead of falling to its noise floor.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from jointwear.discovery import assumed
from jointwear.measurement.motion import RESOLVED, Measured

#: Slow motion is missing where all but one sample in a hundred are this many times faster than the slowest that shows
#: a direction.
SLOWEST, MISSING = 0.01, 3.0


def resolved_motion(measured: Measured) -> bool:
    """Return whether accelerations were measured, or derived from a motion that the sampling resolves.

    Recordings at a high rate are reduced with the torque filtered alike: there nothing is amiss.
    """
    if np.isfinite(measured.band) or measured.reach is None:
        return True
    return bool(np.max(measured.reach) < RESOLVED * measured.rate)


def leave_out_reversals(measured: Measured) -> Measured:
    """Return the samples without those near reversals where the motion is not resolved, or splines were fitted."""
    if resolved_motion(measured) and not measured.fitted:
        return measured
    usable = measured.usable.copy()
    for axis in np.flatnonzero(np.isfinite(measured.cutoff)):
        before, after = _beside(measured, axis)
        v = measured.velocity[:, axis]
        moves = np.where(np.abs(v) > measured.speed_floor[axis], np.sign(v), 0.0)
        for instant in np.flatnonzero(np.diff(moves) != 0) + 1:
            usable[max(instant - before, 0) : instant + after + 1, axis] = False
    return replace(measured, usable=usable)


def _beside(measured: Measured, axis: int) -> tuple[int, int]:
    """Return how many samples before and after a reversal of an axis are left out.

    A spline spreads over one spacing of its knots how a joint stops, sticks and breaks away: in the fit it still moves
    where it stands already, and the torque, which is on its way to the other direction by then, looks early. After the
    reversal the torque of the fit is right, and Stribeck's curve begins there.
    """
    reach = int(np.ceil(assumed.BESIDE * measured.rate))
    if not resolved_motion(measured):
        return reach, reach
    return min(reach, int(np.ceil(0.5 / measured.cutoff[axis] * measured.rate))), 0


def unseen_slow_motion(measured: Measured, judged: Collection[int]) -> list[str]:
    """Return in words below which speeds nothing is seen because reversals are left out; `judged` 0-based joints."""
    if resolved_motion(measured):
        return []
    slowest = {}
    for axis in judged:
        speed = np.abs(measured.velocity[measured.usable[:, axis], axis])
        low = float(np.quantile(speed, SLOWEST)) if len(speed) else 0.0
        if low > MISSING * measured.speed_floor[axis]:
            slowest[axis] = low
    if not slowest:
        return []
    speeds = ", ".join(f"{low:.2g} rad/s on joint {axis + 1}" for axis, low in slowest.items())
    told = f"positions do not resolve what follows a reversal, and {assumed.BESIDE:g} s beside it are left out"
    return [f"{told}: nothing is seen of friction slower than {speeds}; log faster for it"]
