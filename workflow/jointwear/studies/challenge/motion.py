"""Motion of the test cases: periodic excitation and pick-and-place, each with its derivatives in closed form.

A path is asked for any time, also between and before the samples: torque delays and elastic joints need that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jointwear.robots.robot import Robot


class Path(Protocol):
    """A motion of n joints. `at` takes times (m,) [s] and returns position, velocity, acceleration, each (m, n)."""

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...


@dataclass(frozen=True)
class FourierPath:
    """Finite Fourier series (Swevers et al. 1997): centre (n,), cosine and sine coefficients (h, n), period [s]."""

    centre: np.ndarray
    cosine: np.ndarray
    sine: np.ndarray
    period: float

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position [rad], velocity [rad/s] and acceleration [rad/s2], each (m, n)."""
        rate = 2 * np.pi / self.period * np.arange(1, len(self.cosine) + 1)
        phase = np.asarray(time, dtype=float)[:, None] * rate
        c, s = np.cos(phase), np.sin(phase)
        return (
            self.centre + c @ self.cosine + s @ self.sine,
            (c * rate) @ self.sine - (s * rate) @ self.cosine,
            -(c * rate**2) @ self.cosine - (s * rate**2) @ self.sine,
        )


@dataclass(frozen=True)
class TransferPath:
    """Stops (k, n) joined by moves; move i starts at begin[i] and takes duration[i] [s], at rest otherwise.

    The profile is the polynomial of degree 7 that starts and ends with zero velocity, acceleration and jerk:
    35 u^4 - 84 u^5 + 70 u^6 - 20 u^7.
    """

    stops: np.ndarray
    begin: np.ndarray
    duration: np.ndarray

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position [rad], velocity [rad/s] and acceleration [rad/s2], each (m, n)."""
        time = np.asarray(time, dtype=float)
        move = np.clip(np.searchsorted(self.begin, time, side="right") - 1, 0, len(self.begin) - 1)
        length = self.duration[move][:, None]
        u = np.clip((time - self.begin[move])[:, None] / length, 0.0, 1.0)
        span = self.stops[move + 1] - self.stops[move]
        return (
            self.stops[move] + span * u**4 * (35 - 84 * u + 70 * u**2 - 20 * u**3),
            span / length * 140 * u**3 * (1 - u) ** 3,
            span / length**2 * 420 * u**2 * (1 - u) ** 2 * (1 - 2 * u),
        )


@dataclass(frozen=True)
class SampledPath:
    """A motion known at equal steps from time 0, with the motor torque that made it; arrays (m, n)."""

    step: float
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray

    def _between(self, values: np.ndarray, time: np.ndarray) -> np.ndarray:
        x = np.clip(np.asarray(time, dtype=float) / self.step, 0, len(values) - 1)
        low = np.minimum(x.astype(int), len(values) - 2)
        part = (x - low)[:, None]
        return values[low] * (1 - part) + values[low + 1] * part

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position [rad], velocity [rad/s] and acceleration [rad/s2] between the steps, each (m, n)."""
        return tuple(self._between(v, time) for v in (self.position, self.velocity, self.acceleration))

    def torque_at(self, time: np.ndarray) -> np.ndarray:
        """Return the motor torque [N m] between the steps, (m, n)."""
        return self._between(self.torque, time)


def _range(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Return centre and half width [rad] of the positions that motions use: 85 % of the limits, at most 2.4 rad."""
    half = np.minimum(0.85 * (robot.upper - robot.lower) / 2, 2.4)
    return (robot.lower + robot.upper) / 2, half


def fourier_path(robot: Robot, rng: np.random.Generator, speed: np.ndarray) -> FourierPath:
    """Draw a Fourier series of eight harmonics (up to about 1 Hz) within the joint limits.

    Parameters
    ----------
    robot : limits of its joints. rng : random numbers.
    speed : (n,) largest velocity [rad/s]; reached where the limits allow.
    """
    centre, half = _range(robot)
    period = rng.uniform(7.5, 15.0)
    shape = (8, robot.joints)
    weight = rng.uniform(0.3, 1.0, shape) / np.arange(1, 9)[:, None] ** 0.7
    angle = rng.uniform(0, 2 * np.pi, shape)
    path = FourierPath(np.zeros(robot.joints), weight * np.cos(angle), weight * np.sin(angle), period)
    position, velocity, _ = path.at(np.linspace(0, period, 400))
    swing, fastest = np.abs(position).max(axis=0), np.abs(velocity).max(axis=0)
    scale = np.minimum(0.95 * half / swing, speed / fastest)
    room = half - scale * swing
    return FourierPath(centre + rng.uniform(-1, 1, robot.joints) * room, path.cosine * scale, path.sine * scale, period)


def transfer_paths(robot: Robot, rng: np.random.Generator, count: int, duration: float) -> list[TransferPath]:
    """Draw `count` pick-and-place sequences of `duration` [s] among eight poses, at the pace of a factory cell."""
    centre, half = _range(robot)
    poses = centre + half * rng.uniform(-1, 1, (8, robot.joints)) * 0.9
    paths = []
    for _ in range(count):
        pace = rng.uniform(0.55, 1.6)
        order, begin, length, now = [int(rng.integers(8))], [], [], rng.uniform(0.1, 0.5)
        while now < duration:
            following = int(rng.choice([k for k in range(8) if k != order[-1]]))
            # 35/16 is the peak of the profile's velocity for unit span and time.
            reach = float(np.max(np.abs(poses[following] - poses[order[-1]])))
            time = max(0.6, 35 / 16 * reach / (pace * 2.0))
            order.append(following)
            begin.append(now)
            length.append(time)
            now += time + rng.uniform(0.1, 0.6)
        paths.append(TransferPath(poses[order], np.array(begin), np.array(length)))
    return paths
