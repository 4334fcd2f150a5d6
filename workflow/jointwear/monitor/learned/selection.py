"""One recording from the pieces of a program: few enough to be searched, spread over time and temperature."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jointwear.measurement.recording import Recording
from jointwear.monitor.learned.gather import Piece

#: Pieces of a recording, and samples beyond which there are fewer: the search takes time in proportion.
MOST_PIECES, MOST_SAMPLES = 30, 16_000
#: Fewest pieces to learn from: every fifth is held out, and each must be predicted from the others.
FEWEST_PIECES = 5
#: One piece in this many is held out.
HELD_OUT = 5


def choose(pieces: Sequence[Piece]) -> list[Piece]:
    """Return the pieces to learn from, in order of time: even in temperature where it is logged, else in time."""
    if not pieces:
        return []
    usual = float(np.median([len(p.chunk.time) for p in pieces]))
    most = int(np.clip(MOST_SAMPLES // max(usual, 1.0), FEWEST_PIECES, MOST_PIECES))
    warmth = np.array([p.warmth for p in pieces])
    order = np.lexsort(([p.begin for p in pieces], np.where(np.isfinite(warmth), warmth, 0.0)))
    chosen = order[np.unique(np.linspace(0, len(order) - 1, min(most, len(order))).astype(int))]
    return sorted((pieces[k] for k in chosen), key=lambda p: p.begin)


def recording_of(pieces: Sequence[Piece], name: str) -> Recording:
    """Return pieces as one recording, each a trajectory, every fifth held out; velocity only where all have it."""

    def joined(role: str) -> np.ndarray | None:
        values = [getattr(p.chunk, role) for p in pieces]
        if any(v is None or not np.isfinite(v).any() for v in values):
            return None
        return np.concatenate(values)

    begin = min(p.begin for p in pieces)
    counts = [len(p.chunk.time) for p in pieces]
    labels = np.arange(len(pieces))
    test = tuple(int(k) for k in labels[HELD_OUT // 2 :: HELD_OUT])
    return Recording(
        time=np.concatenate([p.chunk.time for p in pieces]) - begin,
        trajectory=np.repeat(labels, counts),
        position=joined("position"),
        torque=joined("torque"),
        velocity=joined("velocity"),
        acceleration=joined("acceleration"),
        temperature=joined("temperature"),
        train=tuple(int(k) for k in labels if k not in test),
        test=test,
        name=name,
    )
