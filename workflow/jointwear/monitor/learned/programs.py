"""Programs by the path in joint space: pieces that run over the same path belong to one program.

A piece shows a part of the cycle, often another part each time, so that means and spreads of a piece say little. Two
pieces are of one program where much of the path of either lies near that of the other; programs are what such pairs
connect. Speed, load and temperature leave a path as it is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

#: Points that stand for the path of a piece, even in its length.
POINTS = 120
#: Distance that is near, as a share of the span of the whole motion of the axes.
NEAR = 0.03
#: Quantiles between which positions tell the travel.
ENDS = 0.005, 0.995
#: Share of the path of one piece that must lie near the other.
SHARED = 0.5


def programs_of(positions: Sequence[np.ndarray]) -> np.ndarray:
    """Return the program (k,) of each of k pieces, 0 the one with most samples.

    Parameters
    ----------
    positions : of each piece (m, n) [rad], finite or not.
    """
    if not positions:
        return np.zeros(0, dtype=int)
    whole = np.concatenate(positions)
    low, high = (np.nanquantile(whole, end, axis=0) for end in ENDS)
    span = float(np.max(high - low))
    if not span > 0:
        return np.zeros(len(positions), dtype=int)
    paths = [_path(p / span) for p in positions]
    trees = [cKDTree(path) for path in paths]
    pairs = []
    for i in range(len(paths)):
        for j in range(i):
            forth = np.isfinite(trees[j].query(paths[i], distance_upper_bound=NEAR)[0]).mean()
            if forth >= SHARED or np.isfinite(trees[i].query(paths[j], distance_upper_bound=NEAR)[0]).mean() >= SHARED:
                pairs.append((i, j))
    rows, columns = np.array(pairs, dtype=int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(paths), len(paths)))
    _, label = connected_components(graph, directed=False)
    size = np.bincount(label, weights=[len(p) for p in positions])
    rank = np.empty(len(size), dtype=int)
    rank[np.argsort(-size, kind="stable")] = np.arange(len(size))
    return rank[label]


def _path(position: np.ndarray) -> np.ndarray:
    """Return POINTS points even in the length of a path, so that rest counts once."""
    position = position[np.isfinite(position).all(axis=1)]
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(position, axis=0), axis=1))])
    at = np.linspace(0.0, length[-1], POINTS)
    return np.stack([np.interp(at, length, column) for column in position.T], axis=1)
