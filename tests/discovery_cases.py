"""Small data sets with a known missing effect, for the tests; formulas of their own."""

from __future__ import annotations

import numpy as np

from jointwear.discovery import Recording
from jointwear.robots.dynamics import Dynamics
from jointwear.robots.robot import Robot

RECORDS, SECONDS, RATE = 4, 10.0, 100.0


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
