"""How wrong the nominal parameters are: corrections of friction, motor inertia and links, with a likely size.

The search leaves the drive parameters free. The model that is written asks how far the parameters of this model
usually are from the truth: one relative error for all of them, chosen by the evidence of the data (empirical Bayes),
and parameters that stand out are set free one by one. Where the nominal model is right the corrections vanish, so that
they cannot take a part of an effect; where all its parameters are somewhat wrong each is moved as far as the data ask.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import softmax

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.problem import FRICTION, SENSE
from jointwear.discovery.problem.whitening import INERTIAL, White

#: Relative errors of the drive parameters that are weighed against each other; the last leaves them free. The
#: first stands for none: 1e-4 of the Coulomb friction of a large axis is already more than all of a small effect.
DRIVE_ERRORS = (1e-6, 0.01, 0.03, 0.1, 0.3, np.inf)
#: The same for the inertial parameters, in units of their prior.
INERTIAL_ERRORS = (1e-5, 0.3, 1.0)
#: How many parameters may be set free one by one: a bound on time, each has to be worth it.
MOST_FREE = 6
#: Width of the prior of a parameter that is left as it is, and halvings of an interval of widths: of rounding only.
NOTHING, HALVINGS = 1e-12, 40
#: Times its size by which a correction may take a parameter below zero before it is held, and after: of rounding only.
BELOW, STILL_BELOW = 1.001, 1.01
#: How often it is asked which parameters would be negative: to hold one moves the others.
ROUNDS = 4

#: Prior (p,) of the coefficients of a fit -> log evidence, coefficients (p,), Cholesky factor of their precision.
Weigh = Callable[[np.ndarray], tuple[float, np.ndarray, tuple[np.ndarray, bool]]]


def likely_base(white: White, extra: list[Term]) -> tuple[list[Term], float]:
    """Return the base terms, one a drive parameter, with the prior under which the data are most likely.

    Parameters
    ----------
    extra : the effects that are part of the model.

    Returns
    -------
    the terms, and the relative error of the drive parameters, one of :data:`DRIVE_ERRORS`.
    """
    nominal = white.problem.drive_parameters
    base: list[Term] = []
    for term in white.base:
        if not term.drive:
            base.append(term)
            continue
        (axis,) = term.drive
        for k in range(len(FRICTION)):
            blocks, raw = {axis: term.blocks[axis][:, [k]]}, {axis: term.raw[axis][:, [k]]}
            base.append(Term(f"{term.label} {k}", blocks, term.std[[k]], raw, (axis, k)))
    fit = Fit(white.targets, [*base, *extra])
    weigh = _under_priors(fit)
    places = {t.drive: w for t, w in zip(fit.terms, fit.slices, strict=True) if t.drive}
    inertial = fit.where(INERTIAL)
    drives = np.array([w.start for w in places.values()], dtype=int)
    size = np.array([abs(nominal[place]) for place in places])
    wide = fit.std[drives]
    needed = 0.5 * white.problem.settings.accept
    best: tuple[float, np.ndarray, float] = (-np.inf, fit.std, np.inf)
    for restraint in INERTIAL_ERRORS if inertial is not None else (1.0,):
        for error in DRIVE_ERRORS:
            std = fit.std.copy()
            if inertial is not None:
                std[inertial] *= restraint
            # A parameter that the model gives as zero has no relative error: it is free.
            std[drives] = np.where(size > 0, np.minimum(wide, error * np.maximum(size, 1e-12)), wide)
            value, std = _set_free(weigh, std, drives, wide, needed, MOST_FREE if np.isfinite(error) else 0)
            if value > best[0]:
                best = (value, std, error)
    sign = np.array([SENSE[k] for _, k in places])
    std = _none_negative(weigh, best[1].copy(), drives, size, sign, needed)
    gone = {place for place, w in places.items() if std[w.start] <= NOTHING}
    chosen = [replace(t, std=std[w]) for t, w in zip(base, fit.slices, strict=False) if t.drive not in gone]
    return chosen, best[2]


def _set_free(
    weigh: Weigh, std: np.ndarray, drives: np.ndarray, wide: np.ndarray, needed: float, most: int
) -> tuple[float, np.ndarray]:
    """Return the log evidence and the prior (p,) of coefficients of which those that stand out are free.

    Parameters
    ----------
    std : (p,) prior. drives : (k,) places of drive parameters, `wide` (k,) the prior of one that is free.
    needed : log evidence that each has to be worth. most : so many are set free.
    """
    value, theta, factor = weigh(std)
    for _ in range(most):
        pull = np.where(std[drives] < wide, np.abs(theta[drives]) / std[drives] ** 2, 0.0)
        # By how much the fit pulls at a prior, in units of what noise would make of it.
        spread = np.maximum(std[drives] ** 2 - np.diag(cho_solve(factor, np.eye(len(std))))[drives], 1e-300)
        k = int(np.argmax(pull * std[drives] ** 2 / np.sqrt(spread)))
        if std[drives[k]] >= wide[k]:
            break
        trial = std.copy()
        trial[drives[k]] = wide[k]
        got, theta_free, factor_free = weigh(trial)
        if got < value + needed:
            break
        std, value, theta, factor = trial, got, theta_free, factor_free
    return value, std


def _none_negative(
    weigh: Weigh, std: np.ndarray, drives: np.ndarray, size: np.ndarray, sign: np.ndarray, needed: float
) -> np.ndarray:
    """Return a prior (p,) under which no parameter of a drive is negative.

    One that would have to be goes to zero if the data ask for that, else it is not what is wrong.

    Parameters
    ----------
    std : (p,) prior. drives : (k,) places of the parameters, of `size` and `sign` (k,). needed : log evidence by which
        the data have to ask.
    """
    for _ in range(ROUNDS):
        theta = weigh(std)[1]
        negative = np.flatnonzero((sign * theta[drives] < -BELOW * size) & (std[drives] > NOTHING))
        if not len(negative):
            break
        for k in negative:
            held, without = std.copy(), std.copy()
            held[drives[k]] = _to_zero(weigh, std, drives[k], size[k])
            without[drives[k]] = NOTHING
            std = held if size[k] > 0 and weigh(held)[0] > weigh(without)[0] + needed else without
    theta = weigh(std)[1]
    std[drives[sign * theta[drives] < -STILL_BELOW * size]] = NOTHING
    return std


def doubted_links(white: White, fit: Fit) -> np.ndarray:
    """Return the covariance (p, p) of the coefficients of a fit if nobody knows how wrong the links are.

    The errors under which the data are most likely are often hardly more so than others, and none at all makes what
    moves with a link look certain: a mass at the flange beside that of the wrist. Each of :data:`INERTIAL_ERRORS`
    counts as much as the data speak for it (Bayesian model averaging: Hoeting et al. 1999, eq. 3 and 4).
    """
    weighed = weighed_links(white, fit)
    if not weighed:
        return fit.covariance
    evidences = [evidence for evidence, _, _ in weighed]
    covariances = [spread + np.outer(theta - fit.theta, theta - fit.theta) for _, theta, spread in weighed]
    return np.tensordot(softmax(evidences), covariances, axes=1)


def weighed_links(white: White, fit: Fit) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Return what a fit says under each of :data:`INERTIAL_ERRORS`: log evidence, coefficients (p,), covariance (p, p).

    The log evidences share an unknown constant. Nothing is returned for a fit that moves no links.
    """
    where = fit.where(INERTIAL)
    usual = next((t.std for t in white.base if t.label == INERTIAL), None)
    if where is None or usual is None:
        return []
    weigh, weighed = _under_priors(fit), []
    for error in INERTIAL_ERRORS:
        std = fit.std.copy()
        std[where] = error * usual
        evidence, theta, factor = weigh(std)
        weighed.append((evidence, theta, cho_solve(factor, np.eye(len(std)))))
    return weighed


def _under_priors(fit: Fit) -> Weigh:
    """Return what weighs a prior (p,) of the coefficients of a fit.

    It gives the log evidence up to a constant, the coefficients (p,) and the Cholesky factor of their precision.
    """
    data = fit.normal - np.diag(fit.std**-2.0)

    def weigh(std: np.ndarray) -> tuple[float, np.ndarray, tuple[np.ndarray, bool]]:
        factor = cho_factor(data + np.diag(std**-2.0))
        theta = cho_solve(factor, fit.right)
        log_det = 2 * float(np.sum(np.log(np.diag(factor[0])))) + 2 * float(np.sum(np.log(std)))
        return 0.5 * float(fit.right @ theta) - 0.5 * log_det, theta, factor

    return weigh


def _to_zero(weigh: Weigh, std: np.ndarray, place: int, size: float) -> float:
    """Return the width of the prior of one parameter under which its correction is no larger than the parameter."""
    low, high = np.log(NOTHING), np.log(std[place])
    for _ in range(HALVINGS):
        trial = std.copy()
        trial[place] = np.exp(0.5 * (low + high))
        if abs(weigh(trial)[1][place]) > size:
            high = np.log(trial[place])
        else:
            low = np.log(trial[place])
    return float(np.exp(low))


def pinned(white: White, base: list[Term], axis: int, error: float) -> list[Term]:
    """Return `base` with the parameters of one drive known to a relative `error`."""
    nominal = white.problem.drive_parameters
    result = []
    for term in base:
        size = abs(float(nominal[term.drive])) if term.drive[:1] == (axis,) else 0.0
        result.append(replace(term, std=np.minimum(term.std, error * size)) if size > 0 else term)
    return result
