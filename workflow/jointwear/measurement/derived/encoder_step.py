"""The step of the numbers that a position is written in."""

from __future__ import annotations

import numpy as np

from jointwear.files.json_values import six_digits

#: Fewest different positions that a step is told from, most steps that may lie between the two that are nearest, and
#: share of the positions that must be multiples of it, to a share of a step.
FEWEST_POSITIONS, NEAREST, NEARLY_ALL, CLOSE = 20, 16, 0.98, 0.05
#: Steps that gaps may hold from which a step is told, one after the other.
WIDER = (16, 256, 4096)
#: Multiple of the spacing of floats that is no step of an encoder but of the numbers themselves, and step [rad] finer
#: than which there is none: 25 bits a turn of a motor behind a gear of 160.
FLOATS, FINEST = 8.0, 1e-9


def _fitted(gaps: np.ndarray, step: float) -> float:
    """Return a `step` [rad] fitted to gaps (k,) [rad] that are multiples of it, wider ones as it gets better known.

    The nearest gap is as wrong as the last digit that was written: of wide ones it would count one step more or less.
    """
    for most in (*WIDER, np.inf):
        counts = np.round(gaps / step)
        near = counts <= most
        step = float(gaps[near].sum() / counts[near].sum())
    return step


def encoder_step(values: np.ndarray) -> float | None:
    """Return the step that nearly all finite positions (m,) [rad] are multiples of, None where there is none.

    It is told from the differences of neighbouring positions by size, not by time: an axis that moves by many steps
    from sample to sample still visits neighbours.
    """
    known = np.unique(values[np.isfinite(values)])
    if len(known) < FEWEST_POSITIONS:
        return None
    spacing = np.spacing(np.float64(np.abs(known).max()))
    if np.array_equal(known, known.astype(np.float32)):
        spacing = float(np.spacing(np.float32(np.abs(known).max())))
    gaps = np.diff(known)
    # One number that was worked out in two ways is two floats.
    gaps = gaps[gaps > FLOATS * spacing]
    if len(gaps) < FEWEST_POSITIONS - 1:
        return None
    for parts in range(1, NEAREST + 1):
        step = _fitted(gaps, gaps.min() / parts)
        if step <= max(FLOATS * spacing, FINEST):
            return None
        whole = (known - known[0]) / step
        if np.mean(np.abs(whole - np.round(whole)) < CLOSE) > NEARLY_ALL:
            return six_digits(step)
    return None
