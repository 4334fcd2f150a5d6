"""The step of the numbers that a position is written in."""

from __future__ import annotations

import numpy as np

from jointwear.files.json_values import six_digits

#: Fewest different positions that a step is told from, most steps that may lie between the two that are nearest, and
#: share of the positions that must be multiples of it, to a share of a step.
FEWEST, NEAREST, NEARLY_ALL, CLOSE = 20, 16, 0.98, 0.05
#: Multiple of the spacing of floats that is no step of an encoder but of the numbers themselves, and step [rad] finer
#: than which there is none: 25 bits a turn of a motor behind a gear of 160.
FLOATS, FINEST = 8.0, 1e-9


def encoder_step(values: np.ndarray) -> float | None:
    """Return the step that nearly all finite positions (m,) [rad] are multiples of, None where there is none.

    It is told from the differences of neighbouring positions by size, not by time: an axis that moves by many steps
    from sample to sample still visits neighbours.
    """
    known = np.unique(values[np.isfinite(values)])
    if len(known) < FEWEST:
        return None
    spacing = np.spacing(np.float64(np.abs(known).max()))
    if np.array_equal(known, known.astype(np.float32)):
        spacing = float(np.spacing(np.float32(np.abs(known).max())))
    gaps = np.diff(known)
    # One number that was worked out in two ways is two floats.
    gaps = gaps[gaps > FLOATS * spacing]
    if len(gaps) < FEWEST - 1:
        return None
    for parts in range(1, NEAREST + 1):
        counts = np.round(gaps / (gaps.min() / parts))
        step = float(gaps.sum() / counts.sum())
        if step <= max(FLOATS * spacing, FINEST):
            return None
        whole = (known - known[0]) / step
        if np.mean(np.abs(whole - np.round(whole)) < CLOSE) > NEARLY_ALL:
            return six_digits(step)
    return None
