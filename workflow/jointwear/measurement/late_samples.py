"""When samples that come earlier than one already seen are more than late."""

from __future__ import annotations

import numpy as np

#: Most samples in a row that may be late.
LATE = 3


def first_long_run(late: np.ndarray) -> int | None:
    """Return where the first run of more than :data:`LATE` true values (m,) begins, None where there is none."""
    if not late.any():
        return None
    edges = np.flatnonzero(np.diff(np.concatenate([[False], late, [False]]).astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    # A run that the chunk ends in counts as long: what follows would be late too.
    long = (ends - starts > LATE) | ((ends == len(late)) & (starts > 0) & (ends - starts > 1))
    return int(starts[long][0]) if long.any() else None
