"""Products that the baseline lacks, as what the regression of a window leaves shows them.

A part that is carried on some moves, and that no load at the flange stands for (:mod:`.carried`), is left over by the
regression of a window, and moves the friction of the axes that lift it, those of neighbours opposite ways. What is left
grows or falls with it on several axes at once, from one shift to the next, where wear is of one axis. A program with
such a product is another program (:mod:`.regimes`): its normal is learnt first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointwear.files.wording import name_axes
from jointwear.monitor.programs import learnt_in_words
from jointwear.monitor.regimes import programs_or_one
from jointwear.monitor.windows import WindowStatistics
from jointwear.statistics.known import known_median

#: Log of the noise by which the median of a shift leaves the range of the baseline's shifts on some axis, and by which
#: on at least so many. Parts of 0.9 to 3.1 kg that no load stands for changed it by 1.2 to 1.6 on the axes that lift
#: them (two robots of the twenty-fifth fleet).
FAR, APART, AXES = np.log(1.25), np.log(1.15), 2
#: Shifts of the baseline that tell the range, and windows of a later one.
SHIFTS, WINDOWS = 3, 2


@dataclass(frozen=True)
class Product:
    """A product that the baseline lacks: its `program` label, and the 1-based `axes` that are louder or quieter."""

    program: int
    axes: tuple[int, ...]


def with_products(
    statistics: WindowStatistics, regime: np.ndarray | None, shift: np.ndarray, baseline: np.ndarray
) -> tuple[np.ndarray | None, tuple[Product, ...]]:
    """Return the programs (w,), -1 unknown, those with products that the baseline lacks told apart, and these products;
    None where there is one program and no such product.

    Parameters
    ----------
    regime : (w,) of :mod:`.regimes`, or None for one program. shift : (w,) labels. baseline : (w,) bool.
    """
    program = programs_or_one(regime, statistics.windows)
    seen = statistics.judgeable & (statistics.count > 0) & (statistics.noise_variance > 0)
    noise = np.where(seen, 0.5 * np.log(np.where(seen, statistics.noise_variance, 1.0)), np.nan)
    result, products = program.copy(), []
    for name in np.unique(program[baseline & (program >= 0)]):
        own = program == name
        known = [known_median(noise[rows], axis=0) for rows in _by_shift(own & baseline, shift)]
        if len(known) < SHIFTS:
            continue
        low, high = np.fmin.reduce(known), np.fmax.reduce(known)
        found: list[tuple[np.ndarray, int]] = []
        for rows in _by_shift(own & ~baseline, shift):
            middle = known_median(noise[rows], axis=0)
            beyond = np.nan_to_num(np.maximum(low - middle, middle - high))
            apart = beyond > APART
            if len(rows) < WINDOWS or beyond.max() <= FAR or apart.sum() < AXES:
                continue
            label = next((n for other, n in found if np.nanmax(np.abs(other - middle)) <= FAR), None)
            if label is None:
                label = int(result.max()) + 1
                found.append((middle, label))
                products.append(Product(label, tuple((np.flatnonzero(apart) + 1).tolist())))
            result[rows] = label
    return (None if regime is None and not products else result), tuple(products)


def product_findings(
    statistics: WindowStatistics, program: np.ndarray | None, products: Sequence[Product], judged: np.ndarray
) -> list[dict[str, Any]]:
    """Return a finding for every product that the baseline lacks.

    Parameters
    ----------
    program : (w,) as :func:`with_products` returns it. judged : (w,) bool, in which most axes are judged.
    """
    result = []
    for product in products:
        rows = np.flatnonzero(program == product.program)
        words = (
            f"What {name_axes(list(product.axes))} need beside the model changed at once, as with a part that the "
            "normal period does not have and that is carried on some moves: "
        )
        words += learnt_in_words(judged[rows], statistics.length)
        result.append({"time": float(statistics.start[rows[0]]), "axes": [], "kind": "program", "words": words})
    return result


def _by_shift(rows: np.ndarray, shift: np.ndarray) -> list[np.ndarray]:
    """Return the windows of each shift among `rows` (w,) bool."""
    return [np.flatnonzero(rows & (shift == name)) for name in np.unique(shift[rows])]
