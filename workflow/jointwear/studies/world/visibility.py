"""Can a hidden thing be seen at all? From the torque that it really makes and the noise, not from a verdict.

Its energy is what is left of its torque after the model's own free numbers (Coulomb friction of each direction,
viscous friction, motor inertia, and inertial parameters under a prior) have taken what they can, in units of the noise
variance of a sample. The noise is that of the torque channel, and that of encoders which is felt as acceleration
within the band of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from jointwear.robots.dynamics import Dynamics
from jointwear.robots.inertia import inertial_regressor, mass_direction, prior_factor
from jointwear.robots.robot import Robot

#: Slower samples [rad/s] count as rest.
REST = 0.02
#: Pairs of neighbouring samples that are looked at, at most.
_PAIRS = 1400


@dataclass(frozen=True)
class Samples:
    """Logged instants, arrays (m, n), `recording` (m,): motion without noise, of the side that the encoders see."""

    recording: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    rate: float


@dataclass(frozen=True)
class Sieve:
    """Removes from a torque what the free numbers of the nominal model explain."""

    first: np.ndarray
    moving: np.ndarray
    scale: np.ndarray
    colour: float
    columns: np.ndarray
    factor: tuple
    weight: float

    def rows(self, torque: np.ndarray) -> np.ndarray:
        """Return whitened rows (k,) of a torque (m, n)."""
        rows = (torque[self.first + 1] - self.colour * torque[self.first]) / self.scale
        return np.where(self.moving, rows, 0.0).ravel()

    def left(self, torque: np.ndarray) -> np.ndarray:
        """Return what is left of a torque (m, n) after the projection, (k,)."""
        rows = self.rows(torque)
        rest = rows - self.columns @ cho_solve(self.factor, self.columns.T @ rows)
        return np.sqrt(self.weight) * rest

    def energy(self, torque: np.ndarray, others: list[np.ndarray] | None = None) -> float:
        """Return the energy of a torque (m, n) in noise variances, restraint of the inertial parameters included, after
        a fit of the torques `others`, each (m, n), as well."""
        rows = np.sqrt(self.weight) * self.rows(torque)
        left = self.left(torque)
        energy = rows @ left
        if others:
            # What is left of a sum of squares, restraint included, after a joint fit: a Schur complement.
            sieved = np.array([self.left(o) for o in others])
            plain = np.sqrt(self.weight) * np.array([self.rows(o) for o in others])
            energy -= (sieved @ rows) @ np.linalg.lstsq(sieved @ plain.T, sieved @ rows, rcond=1e-10)[0]
        return float(max(energy, 0.0))


def build_sieve(
    samples: Samples,
    nominal: Robot,
    train: np.ndarray,
    noise: np.ndarray,
    colour: float,
    prior: float,
    drives: bool = True,
    without: tuple[str, int] | None = None,
) -> Sieve:
    """Prepare the projection.

    Parameters
    ----------
    train : (m,) mask. noise : (n,) [N m], `colour` the coefficient of its autoregression.
    prior : relative standard deviation of the inertial parameters. drives : friction and motor inertia are free.
    without : (number, 0-based axis) of the model that is asked for and must not be taken by itself.
    """
    n = nominal.joints
    usable = np.flatnonzero(train[:-1] & train[1:] & (np.diff(samples.recording) == 0))
    stride = max(1, len(usable) // _PAIRS)
    first = usable[::stride]
    scale = noise * np.sqrt(1 - colour**2)
    pairs = np.concatenate([first, first + 1])
    q, v, a = samples.position[pairs], samples.velocity[pairs], samples.acceleration[pairs]
    columns = []
    if drives:
        words = ("coulomb_friction", "coulomb_friction", "viscous_friction", "motor_inertia")
        values = (np.where(v > 0, 1.0, 0.0), np.where(v < 0, -1.0, 0.0), v, a)
        for axis in range(n):
            for word, value in zip(words, values, strict=True):
                if (word, axis) != without:
                    column = np.zeros_like(v)
                    column[:, axis] = value[:, axis]
                    columns.append(column)
    free = len(columns)
    regressor = inertial_regressor(Dynamics(nominal), q, v, a)
    factor = prior_factor(nominal, prior)
    if without and without[0] == "link_inertia":
        heavy = mass_direction(nominal, without[1])
        heavy = heavy / np.linalg.norm(heavy)
        factor = factor - np.outer(heavy, heavy @ factor)
    inertial = np.moveaxis(regressor @ factor, -1, 0)
    columns = np.concatenate([np.array(columns).reshape(free, *v.shape), inertial])
    half = len(first)
    speed = np.abs(samples.velocity)
    moving = np.minimum(speed[first], speed[first + 1]) > REST
    white = (columns[:, half:] - colour * columns[:, :half]) / scale
    white = np.where(moving, white, 0.0).reshape(len(columns), -1).T
    length = np.linalg.norm(white, axis=0)
    restraint = np.zeros(len(columns))
    restraint[free:] = 1 / stride
    keep = length > 1e-9
    white, length, restraint = white[:, keep], length[keep], restraint[keep]
    gram = (white / length).T @ (white / length) + np.diag(restraint / length**2 + 1e-10)
    return Sieve(first, moving, scale, colour, white / length, cho_factor(gram), stride)
