"""Series beyond their ends."""

from __future__ import annotations

import numpy as np


def turned_about_ends(values: np.ndarray, more: int) -> np.ndarray:
    """Return values (k, ...) continued on both sides by `more` samples, fewer than k, turned about the ends.

    As `numpy.pad` does it, in a tenth of the time.
    """
    before, after = values[more:0:-1], values[-2 : -2 - more : -1]
    return np.concatenate([2 * values[0] - before, values, 2 * values[-1] - after])
