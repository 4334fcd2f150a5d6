"""A temperature that nobody logged: what the log's own times tell of warming in operation and cooling at rest.

    dh/dt = (u - h) / tau in operation, -h / (COOLING tau) at rest,

h from 0 (cold) to about 1 (warm), u the drive: a power of the speed of the axis over its usual one.
"""

from __future__ import annotations

import numpy as np

#: Time constants of warming [h] that are tried: joints of industrial arms need a few hours.
TIMES = (1.5, 2.5, 4.0)
#: Powers of the speed that heat goes with: one program for all, or the work of friction.
DRIVES = (0.0, 1.5)
#: A robot at rest cools slower than it warms: no churned oil, no moving air.
COOLING = 1.6
#: Largest drive.
MOST = 3.0


def warm_up_state(start: np.ndarray, end: np.ndarray, drive: np.ndarray, tau: float) -> np.ndarray:
    """Return the mean state of every window, (w, n).

    Parameters
    ----------
    start, end : (w,) [s] of windows with operation. drive : (w, n), 1 for usual operation. tau : [h].
    """
    state = np.zeros(drive.shape[1])
    result = np.empty(drive.shape)
    drive = np.clip(np.nan_to_num(drive, nan=1.0), 0.0, MOST)
    before = start[0] if len(start) else 0.0
    for k in range(len(start)):
        state = state * np.exp(-max(start[k] - before, 0.0) / 3600 / (COOLING * tau))
        share = (end[k] - start[k]) / 3600 / tau
        fall = np.exp(-share)
        # Mean of an exponential approach over the window.
        result[k] = drive[k] + (state - drive[k]) * (1 - fall) / max(share, 1e-9)
        state = drive[k] + (state - drive[k]) * fall
        before = end[k]
    return result
