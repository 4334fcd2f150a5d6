"""Corrections of the links that leave bodies which may exist: what is fitted is what is written.

A fit is linear: where structure is left, or little tells the links apart, it asks for masses and moments below zero. A
robot file takes none. Cut off one by one they leave other torque on every axis that carries the link. So the fit is
moved, by as little as its own posterior has it, to the nearest links that may exist (a semidefinite program over the
inertias of all links: Wensing, Kim and Slotine 2018, "Linear matrix inequalities for physically consistent inertial
parameter identification"), and everything else follows as its covariance says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from jointwear.robots.inertia import LEAST_MASS, SIX, bodies, parameters_of_body, to_joint_frame
from jointwear.robots.robot import Robot

#: Weights of the barrier, in nats: at the last one the links are about as many nats from the best as there are links.
BARRIER = tuple(10.0**k for k in range(3, -3, -1))
#: Steps of Newton's method at each weight, halvings of one step, and the decrement [nats] that ends it early.
STEPS, HALVINGS, ENOUGH = 25, 40, 1e-3
#: Eigenvalue, of a matrix with a diagonal of ones, below which a nominal link has nothing.
NOTHING = 1e-9


def _entries() -> np.ndarray:
    """Return the derivative (10, 6, 6) of [[I, S(mc)'], [S(mc), m]] by the ten parameters of a body.

    It has no negative eigenvalue where neither the mass nor a moment about the centre of mass is negative.
    """
    found = np.zeros((10, 6, 6))
    found[0, 3:, 3:] = np.eye(3)
    for k, (i, j) in enumerate(((2, 1), (0, 2), (1, 0))):
        found[1 + k, 3 + i, j] = found[1 + k, j, 3 + i] = 1.0
        found[1 + k, 3 + j, i] = found[1 + k, i, 3 + j] = -1.0
    for k, (i, j) in enumerate(SIX):
        found[4 + k, i, j] = found[4 + k, j, i] = 1.0
    return found


ENTRIES = _entries()


@dataclass(frozen=True)
class _Limit:
    """A symmetric matrix `at` + z . `by` without negative eigenvalues; `by` is (k, d, d)."""

    at: np.ndarray
    by: np.ndarray

    def inverse(self, z: np.ndarray) -> np.ndarray | None:
        """Return the inverse of the matrix at z (k,), None where it has an eigenvalue of zero or below."""
        try:
            factor = cho_factor(self.at + np.tensordot(z, self.by, axes=1))
        except LinAlgError:
            return None
        return cho_solve(factor, np.eye(len(self.at)))


def _limits(robot: Robot, change: np.ndarray) -> list[_Limit]:
    """Return what holds for the links of a robot if `change` (10 n, k) times z is added to their parameters.

    A URDF takes any inertia that gives the torques of the fit; masses are bounded in either kind of file.
    """
    limits = []
    for link, (mass, com, inertia) in enumerate(bodies(robot)):
        rows = np.linalg.solve(to_joint_frame(robot, link), change[10 * link : 10 * link + 10])
        if mass > 0:
            limits.append(_Limit(np.array([[(1 - LEAST_MASS) * mass]]), rows[0][:, None, None]))
        if robot.links is None:
            continue
        at = np.tensordot(parameters_of_body(mass, com, inertia), ENTRIES, axes=1)
        size = np.sqrt(np.maximum(np.diag(at), 0.0))
        scale = np.divide(1.0, size, out=np.zeros(6), where=size > 0)
        values, vectors = np.linalg.eigh(scale[:, None] * at * scale)
        # Of a link that is given without a part of its inertia only what it has can be wrong.
        seen = scale[:, None] * vectors[:, values > NOTHING]
        if seen.shape[1]:
            by = np.tensordot(rows.T, ENTRIES, axes=1)
            limits.append(_Limit(seen.T @ at @ seen, seen.T @ by @ seen))
    return limits


def nearest_links(robot: Robot, change: np.ndarray, fitted: np.ndarray, precision: np.ndarray) -> np.ndarray:
    """Return the coefficients (k,) nearest to those fitted with which every link is a body that may exist.

    Parameters
    ----------
    change : (10 n, k) inertial parameters in the joint frames by the coefficients; zeros are the given robot.
    fitted, precision : (k,) and (k, k) of the coefficients: near is what costs few nats.
    """
    limits = _limits(robot, change)
    if all(limit.inverse(fitted) is not None for limit in limits):
        return fitted
    z = np.zeros_like(fitted)
    inverses = [limit.inverse(z) for limit in limits]
    limits = [limit for limit, inverse in zip(limits, inverses, strict=True) if inverse is not None]

    def cost(z: np.ndarray, weight: float) -> tuple[float, list[np.ndarray]]:
        inverses, total = [], 0.5 * float((z - fitted) @ precision @ (z - fitted))
        for limit in limits:
            inverse = limit.inverse(z)
            if inverse is None:
                return np.inf, []
            inverses.append(inverse)
            total += weight * float(np.linalg.slogdet(inverse)[1])
        return total, inverses

    for weight in BARRIER:
        value, inverses = cost(z, weight)
        for _ in range(STEPS):
            slope, bend = precision @ (z - fitted), precision.copy()
            for limit, inverse in zip(limits, inverses, strict=True):
                turned = np.einsum("ab,kbc->kac", inverse, limit.by)
                slope -= weight * np.einsum("kaa->k", turned)
                bend += weight * np.einsum("kab,lba->kl", turned, turned)
            step = -np.linalg.solve(bend, slope)
            decrement = -float(slope @ step)
            if decrement < ENOUGH * min(weight, 1.0):
                break
            for k in range(HALVINGS):
                trial = z + 0.5**k * step
                then, there = cost(trial, weight)
                if then < value:
                    break
            else:
                break
            z, value, inverses = trial, then, there
    return z
