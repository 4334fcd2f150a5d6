"""How far the axes disagree about an effect of the whole arm: a torque constant that is off is in no covariance.

A body at the flange is seen by every axis. What one axis lacks besides, a torque constant that is 3 % off or friction
without a name, is the same in all of its rows: it does not average out, and the scatter of a residual does not show it,
because the body takes it over. The axes asked one by one tell: they are taken for studies of one thing that scatter
about it by more than they know, with the variance between them by moments (random effects: DerSimonian and Laird 1986),
nothing where they agree. An axis that knows next to nothing weighs next to nothing there.
"""

from __future__ import annotations

import numpy as np

from jointwear.discovery.linear import Fit, Term
from jointwear.discovery.problem.whitening import White


def of_scales(white: White, fit: Fit, term: Term) -> np.ndarray:
    """Return the covariance (p, p) of the coefficients of a fit if each axis sees an effect with a scale of its own.

    Parameters
    ----------
    white, fit : the problem with the weight of each axis, and the fit of everything. term : that of the effect.
    """
    own = next(w for t, w in zip(fit.terms, fit.slices, strict=True) if t is term)
    others = [t for t in fit.terms if t is not term]
    scales, variances, pulls = [], [], []
    for axis, column in term.blocks.items():
        torque = (column @ fit.theta[own])[:, None]
        if not torque.any():
            continue
        targets = [y if j == axis else y[:0] for j, y in enumerate(white.targets)]
        alone = Fit(targets, [_of_one(t, axis) for t in others])
        b, gram = alone.gram({axis: torque})
        if gram[0, 0] <= 0:
            continue
        scales.append(float(b[0] / gram[0, 0]))
        variances.append(float(1.0 / gram[0, 0]))
        pull = np.zeros(len(fit.theta))
        pull[fit.columns[axis]] = fit.design[axis].T @ torque[:, 0]
        pulls.append(fit.covariance @ pull)
    between = between_variance(np.array(scales), np.array(variances))
    return between * sum((np.outer(p, p) for p in pulls), np.zeros_like(fit.covariance))


def _of_one(term: Term, axis: int) -> Term:
    blocks = {axis: term.blocks[axis]} if axis in term.blocks else {}
    return Term(term.label, blocks, term.std, drive=term.drive)


def between_variance(values: np.ndarray, variances: np.ndarray) -> float:
    """Return the variance between studies (k,) beyond that of each of them, 0 where they agree."""
    if len(values) < 2:
        return 0.0
    weight = 1.0 / variances
    mean = np.sum(weight * values) / np.sum(weight)
    excess = float(np.sum(weight * (values - mean) ** 2)) - (len(values) - 1)
    return max(0.0, excess / float(np.sum(weight) - np.sum(weight**2) / np.sum(weight)))
