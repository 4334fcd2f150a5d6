"""Runs: stretches along which a value stays the same."""

from __future__ import annotations

from itertools import pairwise

import numpy as np


def runs(values: np.ndarray, start: int = 0) -> list[slice]:
    """Return one slice for each run of equal `values` (m,), as places that begin at `start`; none of no values."""
    edges = start + np.concatenate([[0], np.flatnonzero(values[1:] != values[:-1]) + 1, [len(values)]])
    return [slice(int(i), int(k)) for i, k in pairwise(edges) if i < k]
