"""The next experiment: a Fourier trajectory within the joint limits that tells two rival effects apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.discovery.estimates.outcome import Outcome
from jointwear.discovery.problem.candidates import LINK_MASS, Candidate
from jointwear.effects import State, get_effect, make_state
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import gravity_regressor, inertial_regressor, to_joint_frame
from jointwear.robots.robot import Robot

#: Length [s], rate [Hz] and harmonics of a motion, its slowest turns, and how many are tried. Every so many samples one
#: is looked at.
DURATION, RATE, HARMONICS, SLOWEST, TRIALS, EVERY = 20.0, 50.0, 5, (1, 2, 3), 60, 4
#: Least size of a harmonic over that of the others; part of the travel of a joint on either side, and most of it [rad].
LEAST_HARMONIC, TRAVEL, MOST_TRAVEL = 0.2, 0.4, 1.0
#: Quantile of the speeds that were seen, times which a joint may move, and a speed [rad/s] that it may have anyway.
SEEN, FASTER, ALLOWED = 0.99, 1.2, 0.3
#: Rise of temperature [K] over a motion.
WARMING = 15.0
#: Standard deviations of their prior by which the links are left free.
FREE = 10.0


@dataclass(frozen=True)
class Experiment:
    """A motion, (m, n), and the share of the first effect that the rival cannot imitate, before and with it."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    pair: tuple[str, str]
    axis: int
    share_now: float
    share_then: float


def fourier_motion(robot: Robot, fastest: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Return time (m,), position, velocity, acceleration (m, n) of a random periodic motion.

    It stays within 80 % of the travel (at most one radian each way) and below `fastest` (n,) [rad/s].
    """
    time = np.arange(0.0, DURATION, 1 / RATE)
    n = robot.joints
    q, v, a = np.zeros((3, len(time), n))
    for j in range(n):
        sine, cosine = rng.standard_normal((2, HARMONICS)) * rng.uniform(LEAST_HARMONIC, 1.0, HARMONICS)
        w = 2 * np.pi / DURATION * rng.choice(SLOWEST) * np.arange(1, HARMONICS + 1)
        s, c = np.sin(np.outer(time, w)), np.cos(np.outer(time, w))
        x, dx, ddx = (
            s @ sine + c @ cosine,
            (c * w) @ sine - (s * w) @ cosine,
            -((s * w**2) @ sine + (c * w**2) @ cosine),
        )
        middle, half = 0.5 * (x.max() + x.min()), 0.5 * np.ptp(x)
        travel = TRAVEL * (robot.upper[j] - robot.lower[j])
        size = min(min(travel, MOST_TRAVEL) / half, fastest[j] / np.abs(dx).max())
        centre = 0.5 * (robot.lower[j] + robot.upper[j])
        slack = max(travel - size * half, 0.0)
        q[:, j] = centre + rng.uniform(-1, 1) * slack + size * (x - middle)
        v[:, j], a[:, j] = size * dx, size * ddx
    return time, q, v, a


def _share(state: State, regressor: np.ndarray, factor: np.ndarray, first: Candidate, second: Candidate) -> float:
    """Return the part of the first effect's energy on its axis left after friction, inertia prior and the rival."""
    axis = first.axis if first.axis is not None else (second.axis or 0)

    def columns(candidate: Candidate) -> np.ndarray:
        effect = get_effect(candidate.effect)
        if effect.whole_arm:
            columns = effect.columns(state, 0, None, candidate.nonlinear)[:, axis]
            return columns[:, : effect.leading or columns.shape[1]]
        return effect.columns(state, candidate.axis, candidate.source, candidate.nonlinear)

    v = state.velocity[:, axis]
    base = np.stack([v > 0, v < 0, v, state.acceleration[:, axis]], axis=1).astype(float)
    base = np.concatenate([base, FREE * (regressor[:, axis] @ factor)], axis=1)
    target, rival = columns(first), columns(second)
    full = np.concatenate([base, rival], axis=1)
    full = full / np.maximum(np.linalg.norm(full, axis=0), 1e-12)
    u, s, _ = np.linalg.svd(full, full_matrices=False)
    u = u[:, s > 1e-6]
    left = target - u @ (u.T @ target)
    return float(np.sum(left**2) / max(np.sum(target**2), 1e-300))


def propose(outcome: Outcome) -> Experiment | None:
    """Return the best of random Fourier motions for the first pair of effects that the data cannot tell apart.

    None where every named effect stands alone.
    """
    pair = next(
        (
            (n.candidate, other)
            for n in outcome.named
            for other in n.ties
            if LINK_MASS not in (n.candidate.effect, other.effect)
        ),
        None,
    )
    if pair is None:
        return None
    problem = outcome.problem
    robot, dynamics = problem.robot, Dynamics(problem.robot)
    speed = np.array([np.quantile(np.abs(problem.state.velocity[:, j]), SEEN) for j in range(robot.joints)])
    speed = np.maximum(FASTER * speed, ALLOWED)
    # Numbers that no other stage draws.
    rng = np.random.default_rng(np.random.SeedSequence([0, 91]))
    train = problem.train
    now = _share(problem.train_state, problem.regressor[train], problem.factor, *pair)
    tip = to_joint_frame(robot, robot.joints - 1)
    warm = np.nanmean(problem.state.temperature, axis=0) if problem.state.has_temperature else None
    best: tuple[float, tuple] | None = None
    for _ in range(TRIALS):
        time, q, v, a = fourier_motion(robot, speed, rng)
        thin = slice(None, None, EVERY)
        regressor = inertial_regressor(dynamics, q[thin], v[thin], a[thin])
        last = regressor[:, :, -10:] @ tip
        # Effects of temperature need warming up besides motion.
        temperature = None if warm is None else warm + WARMING * (time[thin, None] / DURATION - 0.5)
        state = make_state(
            robot,
            q[thin],
            v[thin],
            a[thin],
            np.array(dynamics.rigid_body_torque(q[thin], v[thin], a[thin])),
            time=problem.state.time[0] + time[thin],
            temperature=temperature,
            record=np.zeros(len(time[thin]), dtype=int),
            tip_regressor=lambda last=last: last,
            gravity_regressor=lambda poses=q[thin]: gravity_regressor(robot, poses),
        )
        share = _share(state, regressor, problem.factor, *pair)
        if best is None or share > best[0]:
            best = (share, (time, q, v, a))
    share, motion = best
    axis = pair[0].axis if pair[0].axis is not None else (pair[1].axis or 0)
    return Experiment(*motion, (pair[0].effect, pair[1].effect), axis, now, share)
