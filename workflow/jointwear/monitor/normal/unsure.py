"""Windows of which the estimate is far less sure than is usual: they count for less, or are not judged.

The variance of :mod:`.estimate` is that of noise without memory. What the model lacks in a window, such as a part
that was not found there (:mod:`jointwear.monitor.reading.carried`), is no such noise: it lasts for a move, so that it
shifts an estimate by far more. The sandwich over blocks (`score` of the windows) tells how far. What is usual of it the
baseline shows, and the dispersion of the normal state holds it (:mod:`.dispersion`); what is beyond that a window has
by itself (:func:`beyond_usual`).

Where single windows of a program miss a part that the others have, it repeats from block to block and no block tells
of it: their friction was off by +40 % on an axis of a robot of the thirty-fourth fleet, at seven times the error that
is usual in the program. Such windows are not judged (:func:`odd_windows`).
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.normal.estimate import contrast
from jointwear.statistics.known import known_median

#: Times the usual error of the baseline up to which the error of a window, told by a dozen blocks, is usual. At 2 and 4
#: the same false alarms go on the thirty-fourth fleet; at 2 alarms of the shop floor come an hour later.
USUAL = 3.0
#: Times the usual error of its program from which on a window is an odd one, share of the windows of the baseline in
#: that program up to which such windows are odd there, and fewest of them that tell.
ODD, RARE, FEWEST_WINDOWS = 4.0, 0.25, 4


def coloured_variance(gram: np.ndarray, score: np.ndarray, free: np.ndarray, target: int = 0) -> np.ndarray:
    """Return the variance (..., w, n) of the coefficient of one column by the sandwich over blocks; 0 where unknown.

    Parameters
    ----------
    gram, score : (..., w, n, 5, 5) of the changed columns. free, target : of :func:`.estimate.column_estimate`.
    """
    weights, _ = contrast(gram, free, target)
    return np.maximum(np.einsum("...i,...ij,...j->...", weights, score, weights), 0.0)


def beyond_usual(variance: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """Return by how much a variance (w, n) is larger than is usual in the `baseline` (w,) bool, 0 up to
    :data:`USUAL` times its standard deviation."""
    usual = known_median(np.where(baseline[:, None] & (variance > 0), variance, np.nan), axis=0)
    return np.maximum(variance - USUAL**2 * np.nan_to_num(usual, nan=np.inf), 0.0)


def odd_windows(error: np.ndarray, program: np.ndarray, baseline: np.ndarray) -> np.ndarray:
    """Return the windows (w, n) whose `error` (w, n) is far from that of their program.

    Parameters
    ----------
    error : standard deviation, NaN unknown. program : (w,) label, -1 unknown. baseline : (w,) bool.
    """
    result = np.zeros(error.shape, dtype=bool)
    for name in np.unique(program[baseline & (program >= 0)]):
        own = program == name
        first = error[own & baseline]
        with np.errstate(invalid="ignore"):
            odd = error[own] > ODD * known_median(first, axis=0)
        result[own] = odd & (np.isfinite(first).sum(axis=0) >= FEWEST_WINDOWS)
    return not_of_program(result, np.isfinite(error), program, baseline)


def not_of_program(
    odd: np.ndarray, known: np.ndarray, program: np.ndarray, baseline: np.ndarray, rare: float = RARE
) -> np.ndarray:
    """Return the windows `odd` (w, n) bool without those of a program that is so in more than a share `rare` of its
    windows of the baseline: a state that the program has, and learnt as such.

    Parameters
    ----------
    known : (w, n) bool, windows that tell of it. program, baseline : of :func:`odd_windows`.
    """
    result = odd.copy()
    for name in np.unique(program[baseline & (program >= 0)]):
        own = program == name
        first = own & baseline
        count = (odd & known)[first].sum(axis=0)
        result[own] &= count <= rare * known[first].sum(axis=0)
    return result
