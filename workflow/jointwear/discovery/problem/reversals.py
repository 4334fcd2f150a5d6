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
from jointwear.files.wording import listed
from jointwear.measurement.derived.motion import RESOLVED, Measured, moving
from jointwear.robots.robot import Robot
from jointwear.statistics.known import OVER_MEDIAN

#: Slow motion is missing where all but one sample in a hundred are this many times faster than the slowest that shows
#: a direction.
SLOWEST, MISSING = 0.01, 3.0
#: The filter before a high rate is reduced rings at a step of friction: the part of it that is left at the samples
#: which are the third and the fourth ones from it. The first two are never used.
RINGS = ((3, 0.04), (4, 0.02))


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


def leave_out_ringing(measured: Measured, robot: Robot) -> Measured:
    """Return the samples of a reduced rate without those near reversals where the filter rings by more than the noise.

    The friction of the model steps at once there, and the torque, which was filtered, as the filter does.
    """
    if not np.isfinite(measured.band):
        return measured
    usable, step = measured.usable.copy(), robot.coulomb_positive - robot.coulomb_negative
    for axis, noise in enumerate(_noise(measured)):
        reach = max((sample for sample, part in RINGS if part * step[axis] > noise), default=0)
        own = slice(axis, axis + 1)
        usable[:, own] &= moving(measured.velocity[:, own], measured.trajectory, measured.speed_floor[own], reach)
    return replace(measured, usable=usable)


def _noise(measured: Measured) -> np.ndarray:
    """Return the standard deviation (n,) [N m] of the torque from sample to sample, infinite where no axis is judged.

    Third differences of white noise have twenty times its variance, and those of a motion hardly any.
    """
    third = np.diff(measured.torque, 3, axis=0)
    whole = measured.usable[3:] & measured.usable[:-3]
    middle = [float(np.median(np.abs(d[w]))) if w.any() else np.inf for d, w in zip(third.T, whole.T, strict=True)]
    return OVER_MEDIAN * np.array(middle) / np.sqrt(20.0)  # of the binomial coefficients 1, 3, 3, 1


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
    speeds = listed([f"{low:.2g} rad/s on joint {axis + 1}" for axis, low in slowest.items()])
    told = f"positions do not resolve what follows a reversal, and {assumed.BESIDE:g} s beside it are left out"
    return [f"{told}: friction at speeds below {speeds} cannot be seen; log at a higher rate to see it"]
