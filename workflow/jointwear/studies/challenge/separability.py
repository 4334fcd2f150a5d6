"""Can the hidden effect be seen at all, and told from its rivals? From the true torque, not from a verdict.

See :mod:`jointwear.studies.sieve`; the moving samples of the training recordings count.
"""

from __future__ import annotations

import numpy as np

from jointwear.robots.robot import Robot
from jointwear.studies.challenge.world import World
from jointwear.studies.sieve import Sieve, build_sieve, drive_columns, inertial_torques

#: A case counts as identifiable above this energy [noise variances].
IDENTIFIABLE = 60.0
#: Two names count as one where less than this is left of the true effect after the rival has been fitted too: a
#: likelihood ratio of e^10, weaker than any evidence on which a name should be given.
SEPARABLE = 20.0
#: One pair of neighbouring samples out of so many is looked at; energies are scaled up.
_STRIDE = 6


def sieve_world(
    world: World,
    nominal: Robot,
    train: np.ndarray,
    deviation: np.ndarray,
    colour: float,
    prior: float,
    without: tuple[str, int] | None = None,
) -> Sieve:
    """Return the projection of torques on one world.

    Parameters
    ----------
    nominal : the model whose inertial parameters may vary.
    train : (m,) mask of training samples. deviation : (n,) standard deviation of the torque noise [N m].
    colour : coefficient of its autoregression. prior : relative standard deviation of the inertial parameters.
    without : (parameter, 0-based axis) of the model that is asked for and must not be taken by itself.
    """
    s = world.state
    first = np.arange(0, world.samples - 1, _STRIDE)
    first = np.concatenate([first + r * world.samples for r in range(len(world.paths))])
    first = first[train[first]]
    pairs = np.concatenate([first, first + 1])
    q, v, a = s.position[pairs], s.velocity[pairs], s.acceleration[pairs]
    inertial = inertial_torques(nominal, q, v, a, prior, without)
    return build_sieve(first, np.abs(v), drive_columns(v, a, without), inertial, deviation, colour, _STRIDE)
