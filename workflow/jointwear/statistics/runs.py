"""Runs: stretches along which a value stays the same."""

from __future__ import annotations

import numpy as np


def runs(values: np.ndarray, start: int = 0, shortest: int = 1, longest: int | None = None) -> list[slice]:
    """Return one slice for each run of equal `values` (m,), as places that begin at `start`; none of no values.

    Only runs of `shortest` to `longest` places.
    """
    edges = start + np.concatenate([[0], np.flatnonzero(values[1:] != values[:-1]) + 1, [len(values)]])
    length = np.diff(edges)
    chosen = (length >= max(shortest, 1)) & (length <= (len(values) if longest is None else longest))
    return [slice(i, k) for i, k in zip(edges[:-1][chosen].tolist(), edges[1:][chosen].tolist(), strict=True)]
