"""Programs as the log names them, in place of regimes that are found in the motion (:mod:`.regimes`).

The config says in which columns a log names its program (task, payload, speed override, whatever decides what the arm
does), or what the logs of a name hold. A window that mixes programs is a program of its own, named after all that hold
:data:`~jointwear.monitor.program_labels.PART` of its samples or more. A program with fewer than
:data:`~jointwear.monitor.regimes.FEWEST` windows in the baseline was never seen: its windows are not judged.
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.program_labels import window_programs
from jointwear.monitor.regimes import FEWEST


def labelled_regimes(labels: np.ndarray, baseline: np.ndarray) -> np.ndarray | None:
    """Return the regime (w,) of every window, -1 where its program was never seen; None where no window has a label.

    Parameters
    ----------
    labels : (w,) of the statistics. baseline : (w,) bool.
    """
    names = np.array(window_programs(labels), dtype=object)
    if not any(names):
        return None
    known, counts = np.unique(names[baseline].astype(str), return_counts=True)
    seen = {str(name): k for k, name in enumerate(known[counts >= FEWEST])}
    return np.array([seen.get(str(name), -1) for name in names])


def unseen_programs(labels: np.ndarray, baseline: np.ndarray) -> list[tuple[str, int]]:
    """Return the programs that the baseline lacks, each with the window in which it first runs."""
    regime = labelled_regimes(labels, baseline)
    if regime is None:
        return []
    first: dict[str, int] = {}
    for k, name in enumerate(window_programs(labels)):
        if regime[k] < 0 and name:
            first.setdefault(name, k)
    return list(first.items())
