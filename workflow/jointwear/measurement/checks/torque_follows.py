"""Torques that have nothing to do with the motion beside them: other rows, another recording, a clock that is off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.flange import FlangeLoad
from jointwear.robots.robot import Robot

#: Share of the variance of the torque that the motion leaves, a median over the joints, from which the two do not
#: belong together. Right recordings left 0.002 at most in simulation and 0.07 of real arms; the same moved by a seventh
#: of their length left 0.66 and more, put in another order 0.98.
MOST_LEFT = 0.5
#: Time [s] over which the torque is evened before it is asked. A controller that answers to steps of an encoder shakes
#: a heavy arm faster than it moves it, by more than half of the variance (docs/decisions/what_is_refused.md).
EVENED = 0.1


def check_follows(measured: Measured, robot: Robot, name: str) -> None:
    """Check that the torque changes with the motion, whatever the masses, the friction and the load are.

    Raises
    ------
    Refused : where it does not on most joints.
    """
    samples = thinned(replace(measured, torque=_evened(measured)))
    left = unfollowed(free_torques(samples, robot), samples)
    if len(left) and np.median(left) > MOST_LEFT:
        raise Refused(
            f"{name}: the torque does not follow the motion; with scale, friction and load left free "
            f"{100 * np.median(left):.0f} % of its variance remain in the median of the joints",
            "give time, positions and torques of the same rows of one recording, and check the columns of 'variables'",
            by_keys=True,
        )


def _evened(measured: Measured) -> np.ndarray:
    """Return the torque (m, n) [N m] as means over :data:`EVENED` of the samples that can be judged, recording by
    recording; where none can, as it is."""
    width = max(1, round(EVENED * measured.rate))
    torque = measured.torque.copy()
    for label in np.unique(measured.trajectory):
        mine = measured.trajectory == label
        values, used = torque[mine], measured.usable[mine] & np.isfinite(torque[mine])
        total, count = (
            uniform_filter1d(x, width, axis=0, mode="constant")
            for x in (np.where(used, values, 0.0), used.astype(float))
        )
        # Sums that run along leave rounding where nothing is counted.
        some = count > 0.5 / width
        torque[mine] = np.where(some, total / np.where(some, count, 1.0), values)
    return torque


def free_torques(measured: Measured, robot: Robot) -> np.ndarray:
    """Return what may explain the torque of each joint, whatever the masses, the friction and the load are, (n, m, k):
    the model, friction, inertia, an offset and a load at the flange."""
    motion = measured.position, measured.velocity, measured.acceleration
    rigid, load = Dynamics(robot).rigid_body_torque(*motion), FlangeLoad(robot).unit_sum(*motion)
    v = measured.velocity
    own = np.stack([rigid, np.sign(v), v, measured.acceleration, np.ones_like(v)], axis=1)
    return np.concatenate([own, load], axis=1).transpose(2, 0, 1)


def unfollowed(free: np.ndarray, measured: Measured) -> np.ndarray:
    """Return the share of the variance of the torque that no multiple of `free` (n, m, k) explains, for each joint that
    moves, (j,)."""
    found = []
    for j, used in enumerate(measured.usable.T):
        torque = measured.torque[used, j]
        if used.sum() < FEWEST_OF_JOINT or np.ptp(torque) == 0.0:
            continue
        columns = free[j, used]
        columns /= np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-12)
        found.append(np.var(torque - columns @ np.linalg.lstsq(columns, torque, rcond=1e-9)[0]) / np.var(torque))
    return np.array(found)
