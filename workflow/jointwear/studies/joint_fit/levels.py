"""Torque levels of one task at its six sampled instants: all that the hourly histograms of an axis depend on.

With Coulomb friction by the commanded velocity and the disturbance returned through the coupled dynamics the torque
of an axis is, instant by instant, a level plus Gaussian noise of one size that no other axis has a part in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.trajectory import quintic_profile
from jointwear.studies.recovery.sampled_motion import CYCLE, SEGMENT, progress

GRID_STEP = 0.5  # s; as in the simulation


@dataclass(frozen=True)
class Noise:
    """`share` of the mean |torque| that the disturbance has; `encoder` [rad] and `step` [s] of the measurement."""

    share: float = 0.01
    encoder: float = 1e-4
    step: float = 0.5


@dataclass(frozen=True)
class Levels:
    """One task: `torque` (n, k) [N m] at the instants, `friction` (n, k) the Coulomb friction in it [N m].

    `spread` (n,) standard deviation of the noise [N m]; `spread_rise` (n,) how much it grows when the axis' Coulomb
    friction doubles [N m].
    """

    torque: np.ndarray
    friction: np.ndarray
    spread: np.ndarray
    spread_rise: np.ndarray


def task_levels(
    dynamics: Dynamics, start: np.ndarray, stop: np.ndarray, phase: np.ndarray, noise: Noise
) -> list[Levels]:
    """Return the levels of S tasks that go from start to stop and back in half a cycle each.

    Parameters
    ----------
    start, stop : (S, n) [rad]; phase : (S,) time of the first instant [s].
    """
    robot = dynamics.robot
    halves = np.full(len(phase), SEGMENT)
    share, rate, second = progress(np.asarray(phase, dtype=float), halves)  # (S, k)
    time = np.arange(0.0, SEGMENT + GRID_STEP / 2, GRID_STEP)
    # Both halves meet the same states but for the direction, so that one of them is computed.
    way, way_rate, way_second = _quintic(time)
    span = (stop - start)[:, None, :]

    def states(s, r, a):
        return start[:, None] + span * s[..., None], span * r[..., None], span * a[..., None]

    count = len(phase)
    at = states(share, rate, second)
    over = states(*(np.broadcast_to(v, (count, len(v))) for v in (way, way_rate, way_second)))
    rigid = dynamics.rigid_body_torque(*(np.concatenate(pair, axis=1) for pair in zip(at, over, strict=True)))
    k = share.shape[1]

    friction = robot.coulomb(at[1])
    torque = rigid[:, :k] + at[1] * robot.viscous + friction
    forth, back = robot.coulomb(over[1]), robot.coulomb(-over[1])
    # The grid of the simulation holds the start twice and the turn once.
    whole = np.concatenate(
        [rigid[:, k:] + over[1] * robot.viscous + forth, (rigid[:, k:] - over[1] * robot.viscous + back)[:, :-1]],
        axis=1,
    )
    both = np.concatenate([forth, back[:, :-1]], axis=1)
    mean = np.abs(whole).mean(axis=1)
    rise = (np.sign(whole) * both).mean(axis=1)
    # One draw moves velocity and acceleration; it matters for an axis at rest alone.
    floor = noise.encoder * (robot.armature / noise.step**2 + robot.viscous / noise.step)
    spread = np.hypot(noise.share * mean, floor)
    slope = noise.share * rise * (noise.share * mean / spread)
    return [Levels(torque[i].T, friction[i].T, spread[i], slope[i]) for i in range(count)]


def _quintic(time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    share, rate, second = quintic_profile(time / SEGMENT)
    return share, rate / SEGMENT, second / SEGMENT**2


__all__ = ["CYCLE", "Levels", "Noise", "task_levels"]
