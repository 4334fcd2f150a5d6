"""A ridge fit of many columns that is taken off series: what is left of them is noise, or what is asked about."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from jointwear.discovery.linear import solved
from jointwear.discovery.noise.noise import Whitener

#: Ridge, as a share of the mean square sum of a column.
RIDGE = 1e-4
#: Share of its square sum that is left of a column, below which sums of products lose too many digits.
FEW_DIGITS = 1e-6


class RidgeFit:
    """A ridge fit of `columns` (N, k) to the samples `used` (N,), or to whitened ones.

    Called with series (N,) or (N, s) it returns what is left of them.
    """

    def __init__(self, columns: np.ndarray, used: np.ndarray, white: Whitener | None) -> None:
        self._columns, self._used, self._white = columns, used, white
        self._x = columns.T.compress(used, axis=1).T if white is None else white(columns)
        gram = self._x.T @ self._x
        self._ridge = RIDGE * np.trace(gram) / max(len(gram), 1)
        gram[np.diag_indices_from(gram)] += self._ridge
        self._factor = cho_factor(gram)

    def __call__(self, series: np.ndarray) -> np.ndarray:
        # Few rows times many, not many times few columns: twice as fast.
        found = cho_solve(self._factor, (self._seen(series).T @ self._x).T)
        return series - (found.T @ self._columns.T).T

    def part(self, series: np.ndarray, count: int) -> np.ndarray:
        """Return what the first `count` columns hold of a series (N,) in the fit, (N,)."""
        return self._columns[:, :count] @ cho_solve(self._factor, self._x.T @ self._seen(series))[:count]

    def squares(self, groups: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return the sums of products (s, s), as the fit sees them, of what is left of each of groups (N, s).

        What is left of the columns themselves is not worked out, which would take as long again.
        """
        edges = np.cumsum([0, *(columns.shape[1] for columns in groups)])
        places = [slice(*pair) for pair in pairwise(edges)]
        seen = np.empty((edges[-1], len(self._x)))
        for where, columns in zip(places, groups, strict=True):
            seen[where] = self._seen(columns).T
        cross = seen @ self._x
        found = cho_solve(self._factor, cross.T).T
        result = []
        for where, columns in zip(places, groups, strict=True):
            whole = seen[where] @ seen[where].T
            left = whole - cross[where] @ found[where].T - self._ridge * found[where] @ found[where].T
            if np.any(np.diag(left) < FEW_DIGITS * np.diag(whole)):
                own = self._seen(self(columns))
                left = own.T @ own
            result.append(left)
        return result

    def gained(
        self, groups: Sequence[np.ndarray], squares: Sequence[np.ndarray], left: np.ndarray
    ) -> list[tuple[float, np.ndarray]]:
        """Return for each of groups (N, s) what it takes off the squares of what a fit that knows no noise left of a
        series (N,), and its coefficients (s,); `squares` are those of :meth:`squares`."""
        return self.gained_of(groups, squares, self.again(left))

    def again(self, left: np.ndarray) -> np.ndarray:
        """Return what the fit leaves of what it left of a series (N,), 0 where it is not used."""
        return np.where(self._used, self(left), 0.0)

    @staticmethod
    def gained_of(
        groups: Sequence[np.ndarray], squares: Sequence[np.ndarray], again: np.ndarray
    ) -> list[tuple[float, np.ndarray]]:
        """Return :meth:`gained` of a series of which :meth:`again` is known."""
        # What the fit leaves of columns has the products with a residual that these have with what it leaves of that.
        return [solved(columns.T @ again, gram) for columns, gram in zip(groups, squares, strict=True)]

    def _seen(self, series: np.ndarray) -> np.ndarray:
        if self._white is not None:
            return self._white(series)
        return series.T.compress(self._used, axis=-1).T
