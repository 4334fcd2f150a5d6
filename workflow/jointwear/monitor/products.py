"""Products that the baseline lacks, as what the regression of a window leaves shows them.

A part that is carried on some moves, and that no load at the flange stands for, is left over by the regression of a
window, and moves the friction of the axes that lift it. What is left grows or falls with it on several axes at once,
from one shift to the next: wear is of one axis, and weather comes and goes. A program with such a product is another
program (:mod:`.regimes`): its normal is learnt first.
"""

from __future__ import annotations

import numpy as np

from jointwear.monitor.regimes import programs_or_one
from jointwear.monitor.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Log of the noise by which the median of a shift leaves the range of the baseline's shifts on some axis, and on how
#: many axes it does by the smaller one; shifts of the baseline that tell the range, windows of a later one.
FAR, APART, AXES = np.log(1.25), np.log(1.15), 2
SHIFTS, WINDOWS = 3, 2


def with_products(
    statistics: WindowStatistics, regime: np.ndarray | None, shift: np.ndarray, baseline: np.ndarray
) -> np.ndarray | None:
    """Return the programs (w,), -1 unknown, with those told apart that carry products which the baseline lacks; None
    where there is one program and no such product.

    Parameters
    ----------
    regime : (w,) of :mod:`.regimes`, or None for one program. shift : (w,) labels. baseline : (w,) bool.
    """
    program = programs_or_one(regime, statistics.windows)
    seen = statistics.judgeable & (statistics.count > 0) & (statistics.noise_variance > 0)
    noise = np.where(seen, 0.5 * np.log(np.where(seen, statistics.noise_variance, 1.0)), np.nan)
    result, products = program.copy(), int(program.max(initial=0))
    for name in np.unique(program[baseline & (program >= 0)]):
        own = program == name
        known = [known_median(noise[rows], axis=0) for rows in _shifts(own & baseline, shift)]
        if len(known) < SHIFTS:
            continue
        low, high = np.nanmin(known, axis=0), np.nanmax(known, axis=0)
        found: list[tuple[np.ndarray, int]] = []
        for rows in _shifts(own & ~baseline, shift):
            middle = known_median(noise[rows], axis=0)
            beyond = np.nan_to_num(np.maximum(low - middle, middle - high))
            if len(rows) < WINDOWS or beyond.max() <= FAR or (beyond > APART).sum() < AXES:
                continue
            alike = [label for other, label in found if np.nanmax(np.abs(other - middle)) <= FAR]
            if not alike:
                products += 1
                found.append((middle, products))
            result[rows] = alike[0] if alike else products
    return result if regime is not None or (result != program).any() else None


def _shifts(rows: np.ndarray, shift: np.ndarray) -> list[np.ndarray]:
    """Return the windows of each shift among `rows` (w,) bool."""
    return [np.flatnonzero(rows & (shift == name)) for name in np.unique(shift[rows])]
