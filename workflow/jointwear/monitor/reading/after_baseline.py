"""Which windows are judged: those after the baseline. What came before it is history, not known to be healthy or worn.

The friction of such windows is shown. They raise no alarm, ask for no event and teach nothing.
"""

from __future__ import annotations

import numpy as np


def after_baseline(baseline: np.ndarray) -> np.ndarray:
    """Return the windows (w,) bool after the last one of the `baseline` (w,) bool; all where it holds none."""
    return np.logical_or.accumulate(baseline[::-1])[::-1] == 0


def before_baseline(baseline: np.ndarray) -> np.ndarray:
    """Return the windows (w,) bool that are neither of the `baseline` (w,) bool nor after it."""
    return ~baseline & ~after_baseline(baseline)
