"""Control limits of a principal component model under Gaussian data."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
from scipy.special import fdtri


def q_limit(residual_eigenvalues: np.ndarray, confidence: float) -> float:
    """Return the limit of the Q-statistic (SPE).

    Parameters
    ----------
    residual_eigenvalues : (k,) variances along the components that are not kept.
    confidence : share of normal observations below the limit, in (0, 1).

    References
    ----------
    J. E. Jackson and G. S. Mudholkar, Control procedures for residuals associated with principal component
    analysis, Technometrics 21 (1979) 341-349.
    """
    largest = float(np.max(residual_eigenvalues, initial=0.0))
    if largest <= 0:
        return 0.0
    # Relative to the largest, because powers of tiny variances vanish in floating point.
    theta = [float(np.sum((np.asarray(residual_eigenvalues) / largest) ** power)) for power in (1, 2, 3)]
    h = 1 - 2 * theta[0] * theta[2] / (3 * theta[1] ** 2)
    quantile = NormalDist().inv_cdf(confidence)
    if h <= 0:
        # One large variance above many small ones. Below zero the power falls as Q grows, and the deviate would take
        # its sign (Jackson 1991); Box's scaled chi-square with the same two moments is the better approximation here.
        from scipy.special import chdtri

        return largest * theta[1] / theta[0] * float(chdtri(theta[0] ** 2 / theta[1], 1 - confidence))
    bracket = quantile * np.sqrt(2 * theta[1] * h**2) / theta[0] + 1 + theta[1] * h * (h - 1) / theta[0] ** 2
    return largest * theta[0] * float(max(bracket, 0.0)) ** (1 / h)


def t2_limit(components: int, observations: int, confidence: float) -> float:
    """Return the limit of Hotelling's T2 for a new observation (F distribution).

    Raises
    ------
    ValueError : if there are not more observations than components.
    """
    if observations <= components:
        raise ValueError(f"{observations} observations cannot carry {components} components")
    factor = components * (observations**2 - 1) / (observations * (observations - components))
    return factor * float(fdtri(components, observations - components, confidence))
