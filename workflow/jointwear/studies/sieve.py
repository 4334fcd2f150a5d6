"""What is left of a hidden torque once the model's own free parameters have taken what they can.

Coulomb friction of each direction, viscous friction and motor inertia of every axis are free, inertial parameters are
held by a prior. Energies are counted in units of the noise variance of a sample. Coloured noise is whitened first: a
variance of correlated samples says nothing of what they carry. For white noise this is the plain ratio.
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

#: Parameters of a drive, in the order of :func:`drive_columns`; the two Coulomb levels go together.
DRIVE_PARAMETERS = ("coulomb_friction", "coulomb_friction", "viscous_friction", "motor_inertia")


@dataclass(frozen=True)
class Sieve:
    """The projection, made by :func:`build_sieve`.

    Attributes
    ----------
    first : (p,) first sample of each whitened pair. moving : (p, n) mask. scale : (n,) [N m].
    colour : coefficient of the autoregression of the noise. columns : (k, c) whitened, of unit length.
    factor : Cholesky factor of their normal equations. weight : how many pairs each one stands for.
    """

    first: np.ndarray
    moving: np.ndarray
    scale: np.ndarray
    colour: float
    columns: np.ndarray
    factor: tuple
    weight: float

    def rows(self, torque: np.ndarray) -> np.ndarray:
        """Return whitened rows (..., k) of torques (..., m, n) [N m]."""
        rows = (torque[..., self.first + 1, :] - self.colour * torque[..., self.first, :]) / self.scale
        rows = np.sqrt(self.weight) * np.where(self.moving, rows, 0.0)
        return rows.reshape(*torque.shape[:-2], -1)

    def left(self, torque: np.ndarray) -> np.ndarray:
        """Return what is left (k,) of a torque (m, n) [N m]."""
        rows = self.rows(torque)
        return rows - self.columns @ cho_solve(self.factor, self.columns.T @ rows)

    def energy(self, torque: np.ndarray, others: list[np.ndarray] | None = None) -> float:
        """Return the energy of a torque (m, n) in noise variances, restraint of the inertial parameters included.

        Parameters
        ----------
        others : torques (m, n) that are fitted as well, without restraint.
        """
        rows, left = self.rows(torque), self.left(torque)
        energy = rows @ left
        if others:
            # What is left of a sum of squares, restraint included, after a joint fit: a Schur complement.
            sieved = np.array([self.left(o) for o in others])
            plain = np.array([self.rows(o) for o in others])
            energy -= (sieved @ rows) @ np.linalg.lstsq(sieved @ plain.T, sieved @ rows, rcond=1e-10)[0]
        return float(max(energy, 0.0))


def drive_columns(velocity: np.ndarray, acceleration: np.ndarray, without: tuple[str, int] | None = None) -> np.ndarray:
    """Return torques (c, m, n) of the free parameters of every drive, from arrays (m, n) [rad/s], [rad/s2].

    Parameters
    ----------
    without : (parameter, 0-based axis) that is asked for and must not be taken by itself.
    """
    values = (np.where(velocity > 0, 1.0, 0.0), np.where(velocity < 0, -1.0, 0.0), velocity, acceleration)
    columns = []
    for axis in range(velocity.shape[1]):
        for parameter, value in zip(DRIVE_PARAMETERS, values, strict=True):
            if (parameter, axis) != without:
                column = np.zeros_like(velocity)
                column[:, axis] = value[:, axis]
                columns.append(column)
    return np.array(columns).reshape(-1, *velocity.shape)


def inertial_torques(
    nominal: Robot,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    prior: float,
    without: tuple[str, int] | None = None,
) -> np.ndarray:
    """Return the torques (r, m, n) [N m] of inertial parameters that are each off by one deviation of their prior.

    The prior is that of discovery (:func:`jointwear.robots.inertia.prior_factor`): what it may put down to the links
    cannot be seen, zeros of the robot file among them.

    Parameters
    ----------
    prior : relative standard deviation of the inertial parameters that the user states.
    without : (parameter, 0-based axis) of the model; where it is `link_inertia` the mass of that link is exact.
    """
    factor = prior_factor(nominal, prior)
    if without and without[0] == "link_inertia":
        heavy = mass_direction(nominal, without[1])
        heavy = heavy / np.linalg.norm(heavy)
        factor = factor - np.outer(heavy, heavy @ factor)
    return np.moveaxis(inertial_regressor(Dynamics(nominal), position, velocity, acceleration) @ factor, -1, 0)


def build_sieve(
    first: np.ndarray,
    speed: np.ndarray,
    drives: np.ndarray,
    inertial: np.ndarray,
    noise: np.ndarray,
    colour: float,
    weight: float,
) -> Sieve:
    """Prepare the projection.

    Parameters
    ----------
    first : (p,) first sample of each pair of neighbours that is looked at.
    speed : (2 p, n) absolute speed of the first and then of the second samples [rad/s].
    drives : (c, 2 p, n) torques of free parameters; c may be 0. inertial : (i, 2 p, n) torques of inertial ones,
        each off by one deviation of its prior (:func:`inertial_torques`).
    noise : (n,) standard deviation of the torque noise [N m]. colour : coefficient of its autoregression.
    weight : how many pairs of the recordings each one stands for; energies are scaled up by it.
    """
    half = len(first)
    scale = noise * np.sqrt(1 - colour**2)
    # Both samples of a whitened pair must move: at rest the torque tells nothing, not even about its neighbour.
    moving = np.minimum(speed[:half], speed[half:]) > REST
    columns = np.concatenate([drives, inertial])
    white = (columns[:, half:] - colour * columns[:, :half]) / scale
    white = np.sqrt(weight) * np.where(moving, white, 0.0).reshape(len(columns), -1).T
    # Each column with unit length keeps the normal equations well conditioned; a column that never moves drops out.
    length = np.linalg.norm(white, axis=0)
    held = np.zeros(len(columns))
    held[len(drives) :] = 1.0
    keep = length > 1e-9
    white, length, held = white[:, keep], length[keep], held[keep]
    gram = (white / length).T @ (white / length) + np.diag(held / length**2 + 1e-10)
    return Sieve(first, moving, scale, colour, white / length, cho_factor(gram), weight)
