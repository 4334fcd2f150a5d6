"""The controllers that move the plants: both know the nominal arm, and what their encoders tell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from jointwear.studies.challenge.sensors import quantise

CONTROLLERS = ("pd_gravity", "computed_torque")
#: Time constant [s] with which a controller smooths the speed that it derives from encoder steps.
SMOOTHING = 0.003


@dataclass(frozen=True)
class Reference:
    """What is asked of the arm at every control step, arrays (m, n), and the torque that the nominal model foresees."""

    position: np.ndarray
    velocity: np.ndarray
    feedforward: np.ndarray


@dataclass
class Reader:
    """What a controller knows of the motion: whole steps of its encoders, and the smoothed speed between them.

    Attributes
    ----------
    steps : (n,) of the encoders [rad]; 0 reads position and speed exactly. step : of control [s].
    """

    steps: np.ndarray
    step: float

    def __post_init__(self) -> None:
        self.exact = not np.any(self.steps)
        self._new = 1 - np.exp(-self.step / SMOOTHING)
        self.restart()

    def restart(self) -> None:
        """Forget the past."""
        self._last = self._speed = None

    def read(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return position [rad] and speed [rad/s], each (n,), as they are known at a control step."""
        if self.exact:
            return position, velocity
        known = quantise(position, self.steps)
        if self._last is None:
            self._last, self._speed = known, velocity.copy()
        self._speed = self._speed + self._new * ((known - self._last) / self.step - self._speed)
        self._last = known
        return known, self._speed

    def rounding(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what rounding alone changes of the positions [rad] and speeds [rad/s] that are known, (m, n) each."""
        error = quantise(position, self.steps) - position
        change = np.diff(error, axis=0, prepend=error[:1]) / self.step
        return error, lfilter([self._new], [1.0, self._new - 1.0], change, axis=0)


@dataclass
class Controller:
    """A law of the two kinds.

    "pd_gravity": position and speed error on top of the gravity torque of the asked pose.
    "computed_torque": inverse dynamics of the asked motion, and a position loop that asks a speed of a
    proportional-integral speed loop.

    Attributes
    ----------
    inertia : (n,) [kg m2] that each axis moves. bandwidth : [rad/s] of the position loop. step : of control [s].
    reader : what it knows of the motion.
    """

    kind: str
    reference: Reference
    inertia: np.ndarray
    bandwidth: float
    step: float
    reader: Reader

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
        self.reader.restart()

    def torque(self, index: int, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return the torque (n,) [N m] that is commanded at a control step of the true motion (n,)."""
        position, velocity = self.reader.read(position, velocity)
        r = self.reference
        miss, slip = r.position[index] - position, r.velocity[index] - velocity
        if self.kind == "pd_gravity":
            return r.feedforward[index] + self._stiffness * miss + self._damping * slip
        error = slip + self.bandwidth * miss
        self._integral += self._reset * error
        return r.feedforward[index] + self._damping * error + self._integral

    def answer_to_steps(self, position: np.ndarray) -> np.ndarray:
        """Return the torque (m, n) [N m] that is commanded of positions (m, n) because encoders round them."""
        if self.reader.exact:
            return np.zeros_like(position)
        missed, slipped = self.reader.rounding(position)
        stiffness = self._damping * self.bandwidth if self._stiffness is None else self._stiffness
        return -stiffness * missed - self._damping * slipped
