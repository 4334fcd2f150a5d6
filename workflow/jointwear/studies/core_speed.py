"""How fast the core is that a study runs on, so that its computing times compare with those of other machines."""

from __future__ import annotations

import time

#: Additions of the loop that is timed, and the processor time [s] it takes on a usual core of 2024 under Python 3.11.
ADDITIONS, USUAL_SECONDS = 500_000, 0.025


def slowness() -> float:
    """Return how many times longer than on a usual core a fixed loop takes on this one, now.

    The processor time of shared machines follows what their other guests do, so it is asked beside each time that is
    kept.
    """
    start = time.process_time()
    total = 0
    for k in range(ADDITIONS):
        total += k
    return max(time.process_time() - start, 1e-9) / USUAL_SECONDS
