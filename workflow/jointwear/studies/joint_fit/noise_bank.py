"""Random numbers that every candidate of a search meets, so that two candidates differ by what they are alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.statistics.randomness import generator
from jointwear.studies.recovery.sampled_motion import INSTANTS

#: Cycles of the task in an hour's samples, hours of training and of normal operation: those of the paper, whatever the
#: configuration asks the reproduction for.
REPEATS, TRAINING_HOURS, NORMAL_HOURS = 10, 120, 168


@dataclass(frozen=True)
class NoiseBank:
    """Standard normal deviates of one task in single precision.

    `training` (n, k, repeats, r, hours), `normal` likewise: axis, instant, repeat within the hour, replicate, hour;
    `top`, `bottom` (n, k, r): largest and smallest of the training.
    """

    training: np.ndarray
    normal: np.ndarray
    top: np.ndarray
    bottom: np.ndarray

    @property
    def replicates(self) -> int:
        """Number of replicates."""
        return self.training.shape[3]


def draw_bank(seed: int, name: str, axes: int, replicates: int) -> NoiseBank:
    """Draw the deviates of a task; `name` keys the stream."""
    random = generator(seed, "joint fit", name, replicate=0)

    def draw(hours: int) -> np.ndarray:
        return random.standard_normal((axes, INSTANTS, REPEATS, replicates, hours), dtype=np.float32)

    training = draw(TRAINING_HOURS)
    return NoiseBank(training, draw(NORMAL_HOURS), training.max(axis=(2, 4)), training.min(axis=(2, 4)))
