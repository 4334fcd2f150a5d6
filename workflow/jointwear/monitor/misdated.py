"""Logs whose dates cannot be right, as they stand by name between logs of quite another time."""

from __future__ import annotations

import numpy as np

#: Pause [s] without a log, a quarter of a year, beyond which dates are another clock's.
PAUSE = 90 * 86400.0
#: Fewest logs in order of time by name that say that names follow time: by chance one order in 120 does.
FEWEST = 5


def misdated(first: np.ndarray) -> dict[int, tuple[int, int]]:
    """Return every log that is dated :data:`PAUSE` and more off while the logs before and after it by name are not,
    with the nearest ones of these.

    Names tell only where all other logs, more than half and at least :data:`FEWEST`, follow each other in time as they
    do by name. A clock that is wrong from some log on is none of this: nobody knows which of the two dates is right.

    Parameters
    ----------
    first : (p,) times of the first samples [s] in order of the names; NaN of logs that take no part.
    """
    order = np.argsort(first, kind="stable")[: int(np.isfinite(first).sum())]
    groups = np.split(order, np.flatnonzero(np.diff(first[order]) > PAUSE) + 1)
    others = np.sort(max(groups, key=len))
    if len(others) < FEWEST or 2 * len(others) <= len(order) or np.any(np.diff(first[others]) < 0):
        return {}
    found = {}
    for k in np.setdiff1d(order, others).tolist():
        next_one = int(np.searchsorted(others, k))
        if 0 < next_one < len(others):
            found[k] = (int(others[next_one - 1]), int(others[next_one]))
    return found
