"""Small data sets with a known missing effect, for the tests; formulas of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.discovery import Recording
from jointwear.discovery.estimates.outcome import Named, Outcome
from jointwear.discovery.linear import Term
from jointwear.discovery.problem.candidates import Candidate, raw_columns, term_of
from jointwear.discovery.problem.whitening import White
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

RECORDS, SECONDS, RATE = 4, 10.0, 100.0
#: Rate [Hz] of :func:`coarse`.
COARSE_RATE = 200.0


def fourier(robot: Robot, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Random periodic motion: time, position, velocity, acceleration."""
    time = np.arange(0, SECONDS, 1 / RATE)
    q, v, a = np.zeros((3, len(time), robot.joints))
    for j in range(robot.joints):
        w = 2 * np.pi / SECONDS * np.arange(1, 6)
        x, y = rng.standard_normal((2, 5)) / np.arange(1, 6)
        s, c = np.sin(np.outer(time, w)), np.cos(np.outer(time, w))
        size = min(1.0 / np.abs(s @ x + c @ y).max(), 1.6 / np.abs((c * w) @ x - (s * w) @ y).max())
        q[:, j] = size * (s @ x + c @ y) + 0.5 * (robot.lower[j] + robot.upper[j])
        v[:, j] = size * ((c * w) @ x - (s * w) @ y)
        a[:, j] = -size * ((s * w**2) @ x + (c * w**2) @ y)
    return time, q, v, a


def make_case(robot: Robot, seed: int, hidden=None, noise: float = 0.01) -> Recording:
    """Simulate `robot` and add `hidden(q, v, a, temperature, time, torque)` of shape (m, n); position is quantised."""
    rng = np.random.default_rng(seed)
    parts = []
    warm = rng.permutation(np.linspace(22.0, 40.0, RECORDS))
    for k in range(RECORDS):
        time, q, v, a = fourier(robot, rng)
        temperature = warm[k] + 3.0 * np.sin(2 * np.pi * time / 7.0)
        parts.append((time + k * (SECONDS + 0.5), q, v, a, temperature, np.full(len(time), k)))
    time, q, v, a, temperature, label = (np.concatenate(group) for group in zip(*parts, strict=True))
    torque = Dynamics(robot).inverse_dynamics(q, v, a)
    if hidden is not None:
        torque = torque + hidden(q, v, a, temperature, time, torque)
    torque = torque + noise * torque.std(axis=0) * rng.standard_normal(torque.shape)
    step = 2e-6
    return Recording(
        time=time,
        trajectory=label,
        position=step * np.round(q / step),
        torque=torque,
        temperature=temperature,
        name=f"case_{seed}",
    )


def wave(q, v, *_):
    """Friction that varies over the travel of joint 3."""
    full = np.zeros_like(q)
    full[:, 2] = 0.8 * np.sin(3 * q[:, 2] + 1) * np.sign(v[:, 2])
    return full


def coarse(robot, seed=0, step=2 * np.pi / 2**16, late=0.0, **told):
    """Four records of 5 s at 200 Hz with a coarse encoder; the torque is exact but for 0.2 %, maybe late."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, 5.0, 1 / COARSE_RATE)
    parts = []
    for k in range(4):
        phase, speed = rng.uniform(0, 6, (2, 6)), 2 * np.pi * np.array([0.25, 0.6])[:, None] * rng.uniform(0.8, 1.2, 6)
        size = np.array([0.5, 0.15])[:, None]

        def motion(t, size=size, speed=speed, phase=phase):
            x = speed * t[:, None, None] + phase
            q = np.sum(size * np.sin(x), axis=1)
            return q, np.sum(size * speed * np.cos(x), axis=1), -np.sum(size * speed**2 * np.sin(x), axis=1)

        torque = Dynamics(robot).inverse_dynamics(*motion(time - late))
        noise = 0.002 * torque.std(axis=0) * rng.standard_normal(torque.shape)
        parts.append((time + 6 * k, np.full(len(time), k), motion(time)[0], torque + noise))
    time, label, q, torque = (np.concatenate(x) for x in zip(*parts, strict=True))
    return Recording(time, label, step * np.round(q / step), torque, name="coarse", **told)


def that_lacks(white, told):
    """`white` with nothing left on any axis but what `told` {axis: (m,)} says, over the noise."""
    odd = replace(white.problem, discrepancy=white.problem.discrepancy.copy())
    targets = [np.zeros_like(y) for y in white.targets]
    for axis, y in told.items():
        whitener = white.whiteners[axis]
        odd.discrepancy[np.flatnonzero(white.problem.train)[whitener.rows], axis] = whitener.marginal * y
        targets[axis] = y
    return replace(white, problem=odd, targets=targets)


def lacking_on(white: White, axis: int, torque: np.ndarray) -> White:
    """Return a whitened problem whose `axis` lacks a torque (N_train,) [N m] too."""
    targets = [y + white.columns(a, torque) * (a == axis) for a, y in enumerate(white.targets)]
    return replace(white, targets=targets)


def trial_of(white: White, effect: str, axis: int, nonlinear: dict[str, float]) -> Named:
    """Return an effect of one axis as the gates are asked of it."""
    candidate = Candidate(effect, axis, None, nonlinear)
    return Named(candidate, term_of(white, candidate), None, 99.0)


#: The 0-based axis on which a wave over the angle of the motor has a name.
WAVING = 1


def wave_named(white, effect, torque, order=0.5):
    """Return an outcome in which a wave has a name, and the joint lacks a torque (N_train,) [N m]."""
    one = Candidate(effect, WAVING, None, {"order": order, "held": 1.0})
    columns = raw_columns(white, one)
    term = Term(
        effect, {WAVING: white.columns(WAVING, columns)}, np.full(2, 20.0), {WAVING: white.raw(WAVING, columns)}
    )
    asked = lacking_on(white, WAVING, torque)
    return Outcome(asked.problem, asked, asked.fit([term]), None, named=[Named(one, term, None, 99.0)])


def wave_of(white, order=0.5):
    """Return a wave (N_train,) [N m] over the angle of that joint's motor."""
    state = white.problem.train_state
    return 8.0 * np.sin(order * state.drive.gear_ratio[WAVING] * state.position[:, WAVING] + 0.4)
