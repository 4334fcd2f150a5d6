"""The controllers that move the plants: both know the nominal arm only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

CONTROLLERS = ("pd_gravity", "computed_torque")


@dataclass(frozen=True)
class Reference:
    """What is asked of the arm at every control step, arrays (m, n), and the torque that the nominal model foresees."""

    position: np.ndarray
    velocity: np.ndarray
    feedforward: np.ndarray


@dataclass
class Controller:
    """A law of the two kinds.

    "pd_gravity": position and speed error on top of the gravity torque of the asked pose.
    "computed_torque": inverse dynamics of the asked motion, and a position loop that asks a speed of a
    proportional-integral speed loop.

    Attributes
    ----------
    inertia : (n,) [kg m2] that each axis moves. bandwidth : [rad/s] of the position loop.
    """

    kind: str
    reference: Reference
    inertia: np.ndarray
    bandwidth: float
    step: float

    def __post_init__(self) -> None:
        w = self.bandwidth
        if self.kind == "pd_gravity":
            self._stiffness, self._damping, self._reset = self.inertia * w**2, self.inertia * 2 * w, 0.0
        else:
            self._stiffness, self._damping = None, self.inertia * 4 * w
            self._reset = self._damping * 2 * w * self.step
        self._integral = np.zeros_like(self.inertia)

    def restart(self) -> None:
        """Forget the past."""
        self._integral = np.zeros_like(self.inertia)

    def torque(self, index: int, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return the torque (n,) [N m] that is commanded at a control step."""
        r = self.reference
        miss, slip = r.position[index] - position, r.velocity[index] - velocity
        if self.kind == "pd_gravity":
            return r.feedforward[index] + self._stiffness * miss + self._damping * slip
        error = slip + self.bandwidth * miss
        self._integral += self._reset * error
        return r.feedforward[index] + self._damping * error + self._integral
