"""Clock and motor temperatures of a case: recordings at temperatures that do not follow time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Temperature [degC] at which the nominal parameters hold.
REFERENCE_TEMPERATURE = 30.0


def start_times(rng: np.random.Generator, count: int, duration: float) -> np.ndarray:
    """Return when each recording starts (count,) [s]: one after the other, or spread over up to some days."""
    gaps = rng.uniform(2, 60, count) if rng.random() < 0.5 else np.exp(rng.uniform(np.log(600), np.log(7e4), count))
    starts = np.concatenate([[0.0], np.cumsum(duration + gaps[1:])])
    return np.round(starts, 2)


@dataclass(frozen=True)
class Temperatures:
    """Motor temperature of every recording and joint: level + swing (1 - exp(-t / constant)), arrays (r, n)."""

    level: np.ndarray
    swing: np.ndarray
    constant: np.ndarray

    def at(self, recording: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Return the temperature [degC] (m, n) at `time` (m,) [s] since the start of `recording` (m,)."""
        rise = 1 - np.exp(-np.asarray(time, dtype=float)[:, None] / self.constant[recording])
        return self.level[recording] + self.swing[recording] * rise


def temperatures(rng: np.random.Generator, recordings: int, joints: int) -> Temperatures:
    """Draw temperatures between about 15 and 63 degC whose order in time is shuffled for the arm and for each joint."""
    steps = np.linspace(22, 54, recordings)
    order = np.arange(recordings)
    while abs(np.corrcoef(order, np.arange(recordings))[0, 1]) > 0.5:
        order = rng.permutation(recordings)
    level = steps[order][:, None] + rng.uniform(-4, 4, (recordings, joints))
    return Temperatures(level, rng.uniform(-5, 5, (recordings, joints)), rng.uniform(4, 15, (recordings, joints)))
