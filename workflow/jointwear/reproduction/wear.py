"""Wear of one axis: growth of its Coulomb friction over time, equation (7) of the paper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Wear:
    """Growth of Coulomb friction by `increase_percent` [%] of its first value over `hours` [h].

    `shape` is the dimensionless constant c2 x hours of equation (7). The paper gives two constants and one
    condition; the condition fixes c1, so the shape stays free.
    """

    increase_percent: float
    shape: float
    hours: float = 120.0

    def growth(self, hour: np.ndarray) -> np.ndarray:
        """Return the share by which the friction has grown, 0 at hour 0 and increase_percent/100 at the end."""
        rise = _rise(self.shape * (np.asarray(hour, dtype=float) / self.hours))
        return self.increase_percent / 100 * (rise / _rise(np.float64(self.shape)))

    def coulomb(self, positive: float, negative: float, hour: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the worn Coulomb levels [N m] for positive and negative velocity at `hour`."""
        factor = 1 + self.growth(hour)
        return positive * factor, negative * factor

    def constants(self, level: float) -> tuple[float, float]:
        """Return c1 [N m] and c2 [1/h] of equation (7) for a friction of `level` [N m]."""
        return self.increase_percent / 100 * level / float(_rise(np.float64(self.shape))), self.shape / self.hours


def _rise(x: np.ndarray) -> np.ndarray:
    # 1/(1 + exp(-x^4)) - 1/2, written so that small x keeps its digits.
    square = np.square(x)
    return 0.5 * np.tanh(0.5 * np.square(square))
