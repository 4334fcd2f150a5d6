"""Change of the friction of every axis in every window, and the variance that the noise of the window explains.

The residual torque of a window is regressed on five columns,

    residual = share x_coulomb + offset + d_viscous v + k_gravity g + k_inertial i + noise,

where x_coulomb is the nominal Coulomb torque, C+ for v > 0 and -C- for v < 0: `share` is the growth of both levels
over their nominal value. The other four are nuisances. In the normal period the pooled regression finds their values;
later each is either free again in every window or held at that value. A nuisance is free where this costs the
Coulomb estimate little (:data:`PRICE`), because then what moves it (a payload, a drifting sensor) cannot look like
wear; where the motion cannot tell it from Coulomb friction it is held. What a wrong model leaves in the estimate is
the same in every window of the same motion and goes away with the mean of the normal period.

All functions take any leading dimensions, so that thousands of simulated robots are judged at once. Axes n are the
last dimension of estimates; windows w come before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

COLUMNS = ("coulomb", "offset", "viscous", "gravity", "inertial")
#: Factor by which the standard deviation of the Coulomb estimate may grow for all free nuisances together.
PRICE = 1.25
#: Degrees of freedom that the pooled noise variance counts for beside those of a window.
POOLED_FREEDOM = 200.0
#: Relative standard deviations that the pooled regression of the normal period allows the nuisances a priori.
PRIOR_SHARE = {"coulomb": 0.5, "offset": 0.5, "viscous": 0.5, "gravity": 0.2, "inertial": 0.2}
_TINY = 1e-9


def column_change(coulomb: np.ndarray) -> np.ndarray:
    """Return the matrices (n, 5, 5) that turn the regressors of the windows into :data:`COLUMNS`.

    Parameters
    ----------
    coulomb : (n, 2) nominal Coulomb levels [N m], both positive; an axis without any counts 1 N m both ways.
    """
    levels = np.where(coulomb.sum(axis=1, keepdims=True) > 0, coulomb, 1.0)
    change = np.zeros((len(levels), 5, 5))
    change[:, 0, 0], change[:, 1, 0] = levels[:, 0], levels[:, 1]
    change[:, 0, 1], change[:, 1, 1] = 1.0, -1.0
    for k in (2, 3, 4):
        change[:, k, k] = 1.0
    return change


def _inverse(gram: np.ndarray) -> np.ndarray:
    """Return the pseudo-inverse of Gram matrices (..., k, k) after scaling their columns."""
    scale = np.sqrt(np.maximum(np.einsum("...kk->...k", gram), 0.0))
    inverse = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    outer = inverse[..., :, None] * inverse[..., None, :]
    return np.linalg.pinv(gram * outer, rcond=_TINY, hermitian=True) * outer


def contrast(gram: np.ndarray, free: np.ndarray, target: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return weights a (..., n, 5) with coefficient = a . moment, and the information (..., n) on it.

    Parameters
    ----------
    gram : (..., n, 5, 5) of the changed columns. free : (n, 5) nuisances that are estimated along.
    target : the column whose coefficient is wanted.

    Notes
    -----
    Frisch-Waugh-Lovell: the coefficient of one column after the free ones are projected out of it. Redundant
    nuisances do no harm. Without information the weights are 0.
    """
    others = free.copy()
    others[:, target] = False
    cross = gram[..., target, :] * others
    nuisance = gram * (others[:, :, None] & others[:, None, :])
    weights = -np.einsum("...jk,...k->...j", _inverse(nuisance), cross)
    weights[..., target] = 1.0
    information = gram[..., target, target] + np.einsum("...k,...k->...", weights * others, cross)
    seen = information > _TINY * np.maximum(gram[..., target, target], _TINY)
    information = np.where(seen, information, 0.0)
    safe = np.where(seen, information, 1.0)[..., None]
    return np.where(seen[..., None], weights / safe, 0.0), information


def choose_free(gram: np.ndarray) -> np.ndarray:
    """Return which nuisances (n, 5) are free, from the pooled Gram matrices (n, 5, 5) of the normal period."""
    n = gram.shape[0]
    free = np.zeros((n, 5), dtype=bool)
    free[:, 0] = True
    alone = contrast(gram, free)[1]
    for column in (1, 3, 4, 2):
        tried = free.copy()
        tried[:, column] = True
        information = contrast(gram, tried)[1]
        free[:, column] = (information > 0) & (information * PRICE**2 >= alone)
    return free


def pooled_fit(gram: np.ndarray, moment: np.ndarray, variance: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return coefficients (..., n, 5) of the normal period, shrunk to the nominal model where nothing is seen.

    Parameters
    ----------
    gram, moment : (n, 5, 5) and (..., n, 5), sums over the normal period. variance : (..., n) [N2 m2].
    scale : (n, 5) prior standard deviations.
    """
    precision = np.zeros_like(gram)
    index = np.arange(5)
    precision[..., index, index] = 1.0 / scale**2
    weight = np.maximum(variance, _TINY)[..., None, None]
    return np.linalg.solve(gram / weight + precision, (moment / weight[..., 0])[..., None])[..., 0]


@dataclass(frozen=True)
class Pooled:
    """The pooled regression of the normal period.

    `held` (..., n, 5): coefficients; `free` (n, 5) bool: nuisances that are free in every window; `variance` (..., n):
    noise [N2 m2].
    """

    held: np.ndarray
    free: np.ndarray
    variance: np.ndarray


@dataclass(frozen=True)
class Sums:
    """Sufficient statistics with changed columns; any leading dimensions before (w, n).

    `gram` (..., w, n, 5, 5), broadcastable; `moment` (..., w, n, 5); `residual_square`, `freedom` (..., w, n);
    `usable` (..., w, n) bool.
    """

    gram: np.ndarray
    moment: np.ndarray
    residual_square: np.ndarray
    freedom: np.ndarray
    usable: np.ndarray


def change_columns(
    gram: np.ndarray,
    moment: np.ndarray,
    residual_square: np.ndarray,
    freedom: np.ndarray,
    usable: np.ndarray,
    coulomb: np.ndarray,
) -> Sums:
    """Return the sums of windows for the columns of this module; `coulomb` (n, 2) [N m]."""
    change = column_change(coulomb)
    turned = np.einsum("nji,...njk,nkl->...nil", change, gram, change)
    return Sums(turned, np.einsum("nji,...nj->...ni", change, moment), residual_square, freedom, usable)


def column_estimate(
    sums: Sums, held: np.ndarray, free: np.ndarray, pooled: np.ndarray, target: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the coefficient of one column in every window and the variance that white noise explains, (..., w, n).

    Both are NaN where a window shows nothing of it.

    Parameters
    ----------
    held : (..., n, 5) values of the nuisances that are not `free` (n, 5). pooled : (..., n) noise [N2 m2] of the normal
        period, which counts beside that of a window. target : column of :data:`COLUMNS`.
    """
    weights, information = contrast(sums.gram, free, target)
    fixed = held * ~_with(free, target)
    moment = sums.moment - np.einsum("...njk,...nk->...nj", sums.gram, fixed[..., None, :, :])
    estimate = np.einsum("...k,...k->...", weights, moment)
    noise = (POOLED_FREEDOM * pooled[..., None, :] + sums.residual_square) / (POOLED_FREEDOM + sums.freedom)
    seen = sums.usable & (information > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = np.where(seen, noise / information, np.nan)
    return np.where(seen, estimate, np.nan), variance


def _with(free: np.ndarray, target: int) -> np.ndarray:
    result = free.copy()
    result[:, target] = True
    return result


def pool_windows(sums: Sums, scale: np.ndarray) -> Pooled:
    """Regress all windows of the normal period at once.

    Parameters
    ----------
    sums : of the normal period alone. scale : (n, 5) prior standard deviations, :func:`prior_scale`.
    """
    usable = sums.usable
    gram = np.where(usable[..., None, None], sums.gram, 0.0).sum(axis=-4)
    moment = np.where(usable[..., None], sums.moment, 0.0).sum(axis=-3)
    freedom = np.where(usable, sums.freedom, 0).sum(axis=-2)
    square = np.where(usable, sums.residual_square, 0.0).sum(axis=-2)
    variance = np.where(freedom > 0, square / np.maximum(freedom, 1), 0.0)
    one = gram.reshape(-1, *gram.shape[-3:])[0]
    return Pooled(pooled_fit(gram, moment, variance, scale), choose_free(one), variance)


def prior_scale(coulomb: np.ndarray, viscous: np.ndarray) -> np.ndarray:
    """Return prior standard deviations (n, 5) of the coefficients of :data:`COLUMNS`.

    Parameters
    ----------
    coulomb : (n, 2) nominal levels [N m]. viscous : (n,) nominal coefficients [N m s/rad].
    """
    level = np.where(coulomb.sum(axis=1) > 0, coulomb.mean(axis=1), 1.0)
    share = PRIOR_SHARE
    columns = [
        np.full(len(level), share["coulomb"]),
        share["offset"] * level,
        share["viscous"] * np.where(viscous > 0, viscous, level),
        np.full(len(level), share["gravity"]),
        np.full(len(level), share["inertial"]),
    ]
    return np.stack(columns, axis=1)
