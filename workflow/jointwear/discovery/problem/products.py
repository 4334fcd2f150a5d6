"""Sums of products of the columns of a dictionary, most of which are the same in every fit.

A search asks the same columns again beside every set of names. Their products with each other, with the targets and
with the columns of a term do not change with the set: what is left of a scan does not grow with the length of a log.
"""

from __future__ import annotations

from functools import cached_property
from weakref import ref

import numpy as np

from jointwear.discovery.linear import Fit


class Products:
    """Columns (m, k) on one axis and their sums of products.

    Parameters
    ----------
    axis : 0-based. columns : (m, k), whitened; whoever holds this must not change them.
    """

    def __init__(self, axis: int, columns: np.ndarray) -> None:
        self._axis, self._columns = axis, columns
        self._known: dict[int, tuple[ref, np.ndarray]] = {}

    @cached_property
    def squares(self) -> np.ndarray:
        """The squared length (k,) of every column."""
        return np.sum(self._columns**2, axis=0)

    def projected(self, fit: Fit) -> tuple[np.ndarray, np.ndarray]:
        """Return b (k,) and V (k, p) of :meth:`jointwear.discovery.linear.Fit.projected`, equal to rounding."""
        cross = np.zeros((self._columns.shape[1], len(fit.theta)))
        for term, where in zip(fit.terms, fit.slices, strict=True):
            if self._axis in term.blocks:
                cross[:, where] = self._with(term.blocks[self._axis])
        return self._with(fit.targets[self._axis]) - cross @ fit.theta, cross

    def _with(self, other: np.ndarray) -> np.ndarray:
        """Return X'other (k,) or (k, q); known for as long as `other` lives."""
        known = self._known.get(id(other))
        if known is None or known[0]() is not other:
            self._known = {key: one for key, one in self._known.items() if one[0]() is not None}
            known = self._known[id(other)] = ref(other), self._columns.T @ other
        return known[1]
