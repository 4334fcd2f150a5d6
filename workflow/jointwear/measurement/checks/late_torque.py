"""Torques that belong to another time than the motion beside them: two logs that were joined, a clock that is off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.effects.bristle import bristle
from jointwear.measurement.checks.torque_follows import free_torques, unfollowed
from jointwear.measurement.checks.torque_scale import thinned
from jointwear.measurement.derived.motion import Measured
from jointwear.measurement.refused import Refused
from jointwear.robots.robot import Robot

#: Delays [s] that are compared, either way, of which the shortest is told already. Drives and filters of logs take up
#: to some 25 ms.
DELAYS = (0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2)
#: Delay [s] from which no drive causes it.
REFUSED = 0.05
#: Share of the variance of the torque, a median over the joints, up to which the motion explains it as it is.
EXPLAINED = 0.003
#: Factor by which the right time lowers what is left of the variance, as a median over the joints.
LOWERED = 2.0
#: Travels [rad] after a reversal over which friction may build up: its torque turns late, and no clock is off.
TRAVELS = (5e-4, 2e-3, 8e-3, 3e-2)


def check_delay(measured: Measured, robot: Robot, name: str) -> list[str]:
    """Check that torque and motion belong to the same instants; a short delay of all joints comes back in words.

    Raises
    ------
    Refused : where all of the torque follows the motion far better at another time than a drive can be late by.
    """
    samples = thinned(measured)
    free = free_torques(samples, robot)
    if _explained(unfollowed(free, samples)):
        return []
    # Further columns explain no less: they are made only where something is left.
    free = np.concatenate([free, _built_up(measured)], axis=2)
    now = unfollowed(free, read_later(measured, samples, 0.0))
    if _explained(now):
        return []
    best, gain = 0.0, np.log(LOWERED)
    for delay in (sign * d for d in DELAYS for sign in (1, -1)):
        then = unfollowed(free, read_later(measured, samples, delay))
        if len(then) == len(now) and (found := float(np.median(np.log(now / np.maximum(then, 1e-12))))) > gain:
            best, gain = delay, found
    if not best:
        return []
    way = "late" if best > 0 else "early"
    words = f"the torque of all joints is about {1e3 * abs(best):.0f} ms {way} against the motion"
    if abs(best) >= REFUSED:
        raise Refused(
            f"{name}: {words}; read at that time it fits the model far better",
            "join torque and motion by one clock, or move the rows of the torque",
        )
    return [f"{words}: the clock of the log does that, as a delay of all drives would"]


def _explained(share: np.ndarray) -> bool:
    """Return whether the motion explains the torque as it is; `share` (j,) is what is left of its variance."""
    return not len(share) or bool(np.median(share) < EXPLAINED)


def _built_up(measured: Measured) -> np.ndarray:
    """Return friction that builds up after reversals over each of TRAVELS, of the thinned samples, (n, m, k)."""
    columns = []
    for travel in TRAVELS:
        state = np.zeros_like(measured.position)
        for label in np.unique(measured.trajectory):
            mine = measured.trajectory == label
            for joint in range(state.shape[1]):
                sense = np.sign(measured.velocity[mine, joint])
                state[mine, joint] = bristle(measured.position[mine, joint], sense, travel)
        columns.append(thinned(replace(measured, torque=state)).torque)
    return np.stack(columns, axis=1).transpose(2, 0, 1)


def read_later(measured: Measured, samples: Measured, delay: float) -> Measured:
    """Return thinned samples with the torque of all samples read `delay` [s] later, where their record has it.

    It is read at whole samples, each averaged with its neighbours: read between two of them, half of white noise and
    all that alternates would be gone at that time alone.
    """
    torque, usable = np.array(samples.torque), samples.usable.copy()
    delay = round(delay * measured.rate) / measured.rate
    for label in np.unique(samples.trajectory):
        mine, all_of_it = samples.trajectory == label, measured.trajectory == label
        clock, wanted = measured.time[all_of_it], samples.time[mine] + delay
        usable[mine] &= ((wanted >= clock[0]) & (wanted <= clock[-1]))[:, None]
        for joint in range(torque.shape[1]):
            smooth = _averaged(measured.torque[all_of_it, joint])
            torque[mine, joint] = np.interp(wanted, clock, smooth)
    return replace(samples, torque=torque, usable=usable & np.isfinite(torque))


def _averaged(torque: np.ndarray) -> np.ndarray:
    """Return a torque (k,) of which each sample is averaged with the two beside it, once and once and twice itself."""
    beside = np.pad(torque, 1, mode="edge")
    return 0.25 * beside[:-2] + 0.5 * torque + 0.25 * beside[2:]
