"""Joint-space motion of a repetitive task: quintic segments between waypoints, and its sampled instants."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwear.robots.task_file import HOUR, read_task_file


@dataclass(frozen=True)
class Motion:
    """Position [rad], velocity [rad/s] and acceleration [rad/s2], each (..., n), at `time` [s] (...,)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def quintic_profile(s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return share of the way, rate and second rate by s = t/T of the quintic of the toolbox's jtraj, each like `s`.

    The share is 10 s^3 - 15 s^4 + 6 s^5. Written with (1 - s) factored out, both rates are exactly zero at both ends,
    so that the sign of a velocity never comes from round-off.
    """
    return s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2, 60 * s * (1 - s) * (1 - 2 * s)


def quintic(start: np.ndarray, stop: np.ndarray, duration: float, time: np.ndarray) -> Motion:
    """Move from rest at `start` to rest at `stop` along the quintic of the toolbox's jtraj.

    Parameters
    ----------
    start, stop : (n,) positions [rad].
    duration : time of the motion [s].
    time : (...,) instants in [0, duration] [s].
    """
    share, rate, second = quintic_profile((np.asarray(time, dtype=float) / duration)[..., None])
    span = np.asarray(stop, dtype=float) - np.asarray(start, dtype=float)
    return Motion(
        time=np.asarray(time, dtype=float),
        position=np.asarray(start, dtype=float) + span * share,
        velocity=span * rate / duration,
        acceleration=span * second / duration**2,
    )


@dataclass(frozen=True)
class Task:
    """A closed cycle through `waypoints` (k, n) [rad] in `durations` (k,) [s]; `phase` [s] of the first sample."""

    name: str
    waypoints: np.ndarray
    durations: np.ndarray
    phase: float = 0.0

    @property
    def cycle(self) -> float:
        """Duration of one cycle [s]."""
        return float(np.sum(self.durations))

    def motion(self, time: np.ndarray) -> Motion:
        """Return the commanded motion at `time` (m,) [s], the cycle repeating for ever."""
        time = np.asarray(time, dtype=float)
        within = np.mod(time, self.cycle)
        ends = np.cumsum(self.durations)
        segment = np.minimum(np.searchsorted(ends, within, side="right"), len(ends) - 1)
        parts = np.empty((3, len(time), self.waypoints.shape[1]))
        for k in np.unique(segment):
            chosen = segment == k
            following = self.waypoints[(k + 1) % len(self.waypoints)]
            begin = ends[k] - self.durations[k]
            piece = quintic(self.waypoints[k], following, self.durations[k], within[chosen] - begin)
            parts[:, chosen] = piece.position, piece.velocity, piece.acceleration
        return Motion(time, *parts)

    def samples(self, interval: float, count: int) -> Motion:
        """Return the motion at the `count` instants sampled every `interval` [s] from the phase on.

        The samples of every hour are the same because a whole number of cycles fits an hour.
        """
        return self.motion(self.phase + interval * np.arange(count))

    def grid(self, step: float) -> Motion:
        """Return the motion over one cycle in steps of `step` [s], both ends included."""
        return self.motion(np.linspace(0.0, self.cycle, round(self.cycle / step) + 1))


def task_from_data(data: dict[str, Any]) -> Task:
    """Build a task from the checked content of a task file."""
    return Task(data["name"], np.array(data["waypoints"]), np.array(data["durations"]), data["phase"])


def load_task(path: str | Path) -> Task:
    """Read and check a task file.

    Raises
    ------
    InputError : as :func:`jointwear.robots.task_file.read_task_file`.
    """
    return task_from_data(read_task_file(path))


__all__ = ["HOUR", "Motion", "Task", "load_task", "quintic", "task_from_data"]
