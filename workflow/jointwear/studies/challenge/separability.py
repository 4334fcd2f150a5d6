"""Can the hidden effect be seen at all, and told from its rivals? From the true torque, not from a verdict.

The energy of the true effect is what is left of its torque (size included) after the model's own free numbers have
taken what they can: Coulomb friction of each direction, viscous friction and motor inertia of every axis without
restraint, inertial parameters under the prior. It is counted in units of the noise variance of a sample, over the
moving samples of the training recordings. Coloured noise is whitened first: a variance of correlated samples says
nothing of what they carry. For white noise this is the plain ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from jointwear.robots.robot import Robot
from jointwear.studies.challenge.arm import inertial_columns
from jointwear.studies.challenge.world import World

#: A case counts as identifiable above this energy [noise variances].
IDENTIFIABLE = 60.0
#: Two names count as one where less than this is left of the true effect after the rival has been fitted too: a
#: likelihood ratio of e^10, weaker than any evidence on which a name should be given.
SEPARABLE = 20.0
#: Slower samples [rad/s] count as rest.
_REST = 0.02
#: One pair of neighbouring samples out of so many is looked at; energies are scaled up.
_STRIDE = 6


@dataclass(frozen=True)
class Sieve:
    """Removes from a torque what the nominal model's free numbers explain; made by :func:`build_sieve`."""

    first: np.ndarray
    moving: np.ndarray
    scale: np.ndarray
    colour: float
    columns: np.ndarray
    factor: tuple

    def _rows(self, torque: np.ndarray) -> np.ndarray:
        """Return whitened rows (k,) of torques (..., m, n)."""
        rows = (torque[..., self.first + 1, :] - self.colour * torque[..., self.first, :]) / self.scale
        return np.where(self.moving, rows, 0.0).reshape(*torque.shape[:-2], -1)

    def left(self, torque: np.ndarray) -> np.ndarray:
        """Return what is left of a torque (m, n) after the projection, scaled so that its square sum is the energy."""
        rows = self._rows(torque)
        explained = self.columns @ cho_solve(self.factor, self.columns.T @ rows)
        return np.sqrt(_STRIDE) * (rows - explained)

    def energy(self, torque: np.ndarray) -> float:
        """Return the energy of a torque (m, n) in noise variances, restraint of the inertial parameters included."""
        return float(np.sqrt(_STRIDE) * self._rows(torque) @ self.left(torque))


def build_sieve(
    world: World,
    nominal: Robot,
    train: np.ndarray,
    deviation: np.ndarray,
    colour: float,
    prior: float,
    without: tuple[int, ...] = (),
    without_mass: int | None = None,
) -> Sieve:
    """Prepare the projection for one world.

    Parameters
    ----------
    nominal : the model whose inertial parameters may vary.
    train : (m,) mask of training samples. deviation : (n,) standard deviation of the torque noise [N m].
    colour : coefficient of its autoregression. prior : relative standard deviation of the inertial parameters.
    without : base columns to leave out, for asking how well one parameter of the model itself can be seen: 4 k for
        the two Coulomb levels of axis k (0-based), 4 k + 2 viscous friction, 4 k + 3 motor inertia.
    without_mass : the same for the mass of one link (0-based).
    """
    s, n = world.state, world.arm.robot.joints
    first = np.arange(0, world.samples - 1, _STRIDE)
    first = np.concatenate([first + r * world.samples for r in range(len(world.paths))])
    first = first[train[first]]
    scale = deviation * np.sqrt(1 - colour**2)
    pairs = np.concatenate([first, first + 1])
    q, v, a = s.position[pairs], s.velocity[pairs], s.acceleration[pairs]
    drives = [np.where(v > 0, 1.0, 0.0), np.where(v < 0, -1.0, 0.0), v, a]
    columns = []
    for axis in range(n):
        for kind, values in enumerate(drives):
            if 4 * axis + (0 if kind == 1 else kind) not in without:
                column = np.zeros_like(v)
                column[:, axis] = values[:, axis]
                columns.append(column)
    free = len(columns)
    columns = np.concatenate([np.array(columns), inertial_columns(nominal, q, v, a, without_mass)])
    half = len(first)
    # Both samples of a whitened pair must move: at rest the torque tells nothing, not even about its neighbour.
    moving = np.minimum(np.abs(s.velocity[first]), np.abs(s.velocity[first + 1])) > _REST
    white = (columns[:, half:] - colour * columns[:, :half]) / scale
    white = np.where(moving, white, 0.0).reshape(len(columns), -1).T
    # Each column with unit length keeps the normal equations well conditioned; a column that never moves drops out.
    length = np.linalg.norm(white, axis=0)
    restraint = np.zeros(len(columns))
    restraint[free:] = 1 / (prior**2 * _STRIDE)
    keep = length > 0
    white, length, restraint = white[:, keep], length[keep], restraint[keep]
    gram = (white / length).T @ (white / length) + np.diag(restraint / length**2 + 1e-10)
    return Sieve(first, moving, scale, colour, white / length, cho_factor(gram))


def energy_left_by(sieve: Sieve, truth: np.ndarray, rivals: list[np.ndarray]) -> float:
    """Return the energy of a torque `truth` (m, n) after fitting a sum of rival torques, each (m, n), as well."""
    rest = sieve.left(truth)
    basis = np.array([sieve.left(r) for r in rivals]).T
    length = np.linalg.norm(basis, axis=0)
    basis = basis[:, length > 1e-9] / length[length > 1e-9]
    if basis.shape[1]:
        rest = rest - basis @ np.linalg.lstsq(basis, rest, rcond=1e-8)[0]
    return float(rest @ rest)
