"""When samples that come earlier than one already seen are more than late, and which single ones are astray."""

from __future__ import annotations

import numpy as np

#: Most samples in a row that may be late.
LATE = 3
#: Far is a jump [s] longer than a day and than so many times the log: no pause of a robot, but a clock that is not set.
FAR, FAR_TIMES = 86400.0, 10.0


def first_long_run(late: np.ndarray) -> int | None:
    """Return where the first run of more than :data:`LATE` true values (m,) begins, None where there is none."""
    if not late.any():
        return None
    edges = np.flatnonzero(np.diff(np.concatenate([[False], late, [False]]).astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    # A run that the chunk ends in counts as long: what follows would be late too.
    long = (ends - starts > LATE) | ((ends == len(late)) & (starts > 0) & (ends - starts > 1))
    return int(starts[long][0]) if long.any() else None


def ahead_of(values: np.ndarray, back: int, before: float) -> int:
    """Return how many stamps right before the one at `back` are astray: ahead of it, which goes on where those before
    them were. 0 where they are more than :data:`LATE`, so that a clock was set back.

    Parameters
    ----------
    values : (m,) stamps [s]. before : the stamp before them [s], -inf where there is none, infinite
        where the first of them must stay.
    """
    count = next((k for k in range(back) if values[back - k - 1] <= values[back]), back)
    return count if count <= LATE and (count < back or before <= values[back]) else 0


def lone_start(values: np.ndarray) -> int:
    """Return how many first stamps, at most :data:`LATE` of values (m,) [s] that rise, lie far before all others."""
    for k in range(min(LATE, len(values) - LATE - 1), 0, -1):
        if values[k] - values[k - 1] > max(FAR, FAR_TIMES * (values[-1] - values[k])):
            return k
    return 0


def lone_end(values: np.ndarray, first: float) -> int:
    """Return how many last stamps, at most :data:`LATE` of values (m,) [s] that rise, lie far after all others.

    Parameters
    ----------
    first : stamp [s] with which the log begins, before the values or the first of them.
    """
    for k in range(min(LATE, len(values) - 1), 0, -1):
        if values[-k] - values[-k - 1] > max(FAR, FAR_TIMES * (values[-k - 1] - first)):
            return k
    return 0
