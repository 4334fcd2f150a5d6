"""Gaussian linear algebra: the posterior of a set of terms over all axes, and what a candidate would gain."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import gammaincc, gammainccinv

#: Share of the square of a direction of columns that other terms have to leave for it to be free.
FREE = 1e-3


@dataclass(frozen=True)
class Term:
    """Whitened columns of one group of coefficients with independent Gaussian priors.

    `blocks` holds an (m_axis, k) array for every axis that the coefficients act on, `std` (k,) their prior. `raw`
    holds the same columns before whitening [N m per coefficient], where predictions in N m are wanted. `drive` is
    the 0-based axis of whose drive the coefficients are parameters, and the place of the one that is, if it is one.
    `effect` says that they are those of a named effect, not of the nominal model. `turn` (k, k) holds, a column for
    each coefficient, the direction that it has among those of the term that this one was made of; None for the same.
    """

    label: str
    blocks: dict[int, np.ndarray]
    std: np.ndarray
    raw: dict[int, np.ndarray] = field(default_factory=dict)
    drive: tuple[int, ...] = ()
    effect: bool = False
    turn: np.ndarray | None = None

    def turned(self, precision: np.ndarray) -> Term:
        """Return the term under a prior (k, k) of its original coefficients that does not hold for each on its own.

        The coefficients are turned to those that are independent under it.
        """
        values, vectors = np.linalg.eigh(precision)
        change = vectors if self.turn is None else self.turn.T @ vectors
        blocks, raw = ({axis: x @ change for axis, x in part.items()} for part in (self.blocks, self.raw))
        return replace(self, blocks=blocks, raw=raw, std=1.0 / np.sqrt(values), turn=vectors)


class Fit:
    """Posterior of the coefficients of `terms` given whitened targets.

    Parameters
    ----------
    targets : one (m_axis,) array an axis; empty for an axis that cannot be judged.
    known : the fit of the first of `terms` to the same targets, whose sums of products are taken over.
    """

    def __init__(self, targets: list[np.ndarray], terms: list[Term], known: Fit | None = None) -> None:
        self.terms = terms
        self.slices: list[slice] = []
        start = 0
        for term in terms:
            self.slices.append(slice(start, start + len(term.std)))
            start += len(term.std)
        self.std = np.concatenate([t.std for t in terms]) if terms else np.zeros(0)
        self.columns: list[np.ndarray] = []
        self.design: list[np.ndarray] = []
        self.targets = targets
        normal = np.diag(1.0 / self.std**2)
        right = np.zeros(start)
        taken = 0
        if known is not None:
            taken = len(known.std)
            normal[:taken, :taken], right[:taken] = known.normal, known.right
        for axis, y in enumerate(targets):
            active = [i for i, t in enumerate(terms) if axis in t.blocks]
            index = np.concatenate(
                [np.arange(self.slices[i].start, self.slices[i].stop) for i in active] or [np.zeros(0, int)]
            )
            design = np.concatenate([terms[i].blocks[axis] for i in active] or [np.zeros((len(y), 0))], axis=1)
            self.columns.append(index)
            self.design.append(design)
            held = int(np.searchsorted(index, taken))
            fresh = design[:, held:]
            products = fresh.T @ design
            normal[np.ix_(index[held:], index)] += products
            normal[np.ix_(index[:held], index[held:])] += products[:, :held].T
            right[index[held:]] += fresh.T @ y
        self.normal, self.right = normal, right
        factor = cho_factor(normal)
        self.theta = cho_solve(factor, right)
        self.covariance = cho_solve(factor, np.eye(start))
        self.log_det = 2 * float(np.sum(np.log(np.diag(factor[0])))) + 2 * float(np.sum(np.log(self.std)))
        self.residual = [y - d @ self.theta[c] for y, d, c in zip(targets, self.design, self.columns, strict=True)]
        squares = sum(float(r @ r) for r in self.residual) + float(np.sum((self.theta / self.std) ** 2))
        self.evidence = -0.5 * squares - 0.5 * self.log_det

    def where(self, label: str) -> slice | None:
        """Return the place of the coefficients of the first term of a label, None without such a term."""
        return next((w for t, w in zip(self.terms, self.slices, strict=True) if t.label == label), None)

    def coefficients(self, term: Term) -> np.ndarray | None:
        """Return the fitted coefficients (k,) of a term, None where it is none of the fit's own."""
        return next((self.theta[w] for t, w in zip(self.terms, self.slices, strict=True) if t is term), None)

    def projected(self, blocks: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return b = X'r (k,) and V (k, p) with X'M X = X'X - V V', of columns X on one or more axes."""
        count = next(iter(blocks.values())).shape[1]
        b, cross = np.zeros(count), np.zeros((count, len(self.theta)))
        for axis, columns in blocks.items():
            b += columns.T @ self.residual[axis]
            cross[:, self.columns[axis]] += columns.T @ self.design[axis]
        return b, cross

    def gram(self, blocks: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return b = X'r (k,) and H = X'M X (k, k): what is left of X after the terms have had their say."""
        b, cross = self.projected(blocks)
        full = sum(x.T @ x for x in blocks.values())
        return b, full - cross @ self.covariance @ cross.T

    def gram_each(self, blocks: dict[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return b and H (k,) of :meth:`gram` of each of the columns alone."""
        b, cross = self.projected(blocks)
        full = sum(np.sum(x**2, axis=0) for x in blocks.values())
        return b, full - np.sum((cross @ self.covariance) * cross, axis=1)

    def mimicked(self, blocks: dict[int, np.ndarray], theta: np.ndarray) -> np.ndarray:
        """Return the coefficients (p,) with which the terms follow columns X on one or more axes times `theta` (k,)."""
        return self.covariance @ (self.projected(blocks)[1].T @ theta)


def gain(b: np.ndarray, gram: np.ndarray, std: np.ndarray) -> np.ndarray:
    """Return the evidence [nats] that columns with prior `std` add: fit less the price of complexity.

    Parameters
    ----------
    b, std : (..., k) X'r of the columns and their prior. gram : (..., k, k) what is left of X'X, see :meth:`Fit.gram`;
        many groups of as many columns are answered at once, (...).
    """
    if b.shape[-1] == 1:
        one, right = 1.0 + (std * gram[..., 0] * std)[..., 0], (std * b)[..., 0]
        sound = one > 0
        one = np.where(sound, one, 1.0)
        return np.where(sound, 0.5 * right**2 / one - 0.5 * np.log(one), -np.inf)[()]
    scaled = np.eye(b.shape[-1]) + std[..., :, None] * gram * std[..., None, :]
    right = std * b
    sign, log_det = np.linalg.slogdet(scaled)
    # By rounding alone a determinant may fail to be positive: such a group gains nothing.
    sound = sign > 0
    scaled = np.where(sound[..., None, None], scaled, np.eye(b.shape[-1]))
    fitted = np.linalg.solve(scaled, right[..., None])[..., 0]
    return np.where(sound, 0.5 * np.sum(right * fitted, axis=-1) - 0.5 * log_det, -np.inf)[()]


def gain_of_one(b: np.ndarray, gram: np.ndarray) -> float:
    """Return the nats that one column with b = X'r (1,) and gram X'M X (1, 1) adds with a coefficient of one, not
    fitted."""
    return float(b[0] - 0.5 * gram[0, 0])


def posterior_mean(b: np.ndarray, gram: np.ndarray, std: np.ndarray) -> np.ndarray:
    """Return the coefficients (..., k) of columns under their prior `std`; arguments as of :func:`gain`."""
    if b.shape[-1] == 1:
        return b / (gram[..., 0] + 1 / std**2)
    prior = np.eye(b.shape[-1]) / std[..., :, None] ** 2
    return np.linalg.solve(gram + prior, b[..., None])[..., 0]


def chi_square(b: np.ndarray, gram: np.ndarray, full: np.ndarray) -> tuple[float, int]:
    """Return b' H^-1 b over the directions that the terms leave free, and their number.

    Parameters
    ----------
    b : (k,) products of columns with what the terms leave. gram : (k, k) H, of the columns less the terms. full :
        (k, k) of the columns themselves.
    """
    values, turned, _ = _free(b, gram, full)
    return float(np.sum(turned**2 / values)), len(values)


def chance(statistic: float, freedom: int, samples: int) -> tuple[float, float]:
    """Return the probability that noise alone gives a chi-square on so many samples, and what it is worth [nats].

    Parameters
    ----------
    statistic, freedom : of :func:`chi_square`, freedom not 0.
    """
    return float(gammaincc(freedom / 2, statistic / 2 / _known(samples))), 0.5 * (statistic - freedom)


def least_nats(probability: float, freedom: int, samples: int) -> float:
    """Return what a chi-square is worth [nats] that noise alone reaches with a probability: :func:`chance` inverted."""
    return float(_known(samples) * gammainccinv(freedom / 2, probability)) - 0.5 * freedom


def _known(samples: int) -> float:
    """Return how far off a chi-square may be: the variance of the noise is estimated too, to sqrt(2 / samples)."""
    return 1.0 + np.sqrt(2.0 / samples)


def fitted(columns: np.ndarray, target: np.ndarray) -> tuple[float, np.ndarray]:
    """Return what columns (m, k) take off the squares of a target (m,), and their coefficients (k,)."""
    return solved(columns.T @ target, columns.T @ columns)


def solved(b: np.ndarray, gram: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the same from the products b (k,) of the columns with the target and their own, gram (k, k)."""
    values, turned, vectors = _free(b, gram, gram)
    return float(np.sum(turned**2 / values)), vectors @ (turned / values)


def least_squares(b: np.ndarray, gram: np.ndarray, full: np.ndarray) -> np.ndarray:
    """Return the coefficients (k,) H^-1 b over the directions that the terms leave free; arguments as of
    :func:`chi_square`."""
    values, turned, vectors = _free(b, gram, full)
    return vectors @ (turned / values)


def _free(b: np.ndarray, gram: np.ndarray, full: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return eigenvalues (f,) of the scaled H in the free directions, b in them (f,), and the directions (k, f)."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(full), 1e-300))
    values, vectors = np.linalg.eigh(scale[:, None] * gram * scale)
    keep = values > FREE
    directions = scale[:, None] * vectors[:, keep]
    return values[keep], directions.T @ b, directions
