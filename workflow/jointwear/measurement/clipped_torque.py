"""Torques that stay at their largest value: a drive, or the measurement of its torque, at its limit."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.checks import FEWEST
from jointwear.measurement.recording import Recording

#: Samples in a row at the largest value from which it is a limit, and how many times as long as the longest run of
#: another value: a coarse scale repeats all of its values, at the crest of a wave five times as often as beside it.
FEWEST_IN_A_ROW, LONGER = 5, 10
#: Samples in which a joint that moves shows it: a coarse encoder repeats its values.
STILL = 10


def clipped_torques(recording: Recording) -> list[str]:
    """Return in words which joints reach a limit of their torque while they move, and for how long."""
    found = []
    for j, (torque, position) in enumerate(zip(recording.torque.T, recording.position.T, strict=True)):
        moves = _differs(position, recording.trajectory, STILL)
        moves[:-STILL] &= moves[STILL:]
        if moves.sum() < FEWEST or not np.isfinite(torque).any() or np.nanmin(torque) == np.nanmax(torque):
            continue
        repeats = moves & ~_differs(torque, recording.trajectory, 1)
        ends = np.nanmin(torque), np.nanmax(torque)
        elsewhere = _longest(repeats & ~np.isin(torque, ends)) + 1
        at_limit, limits = np.zeros(len(torque), bool), []
        for limit in ends:
            there = torque == limit
            longest = _longest(repeats & there) + 1
            if longest >= FEWEST_IN_A_ROW and longest > LONGER * elsewhere:
                at_limit |= there
                limits.append(f"{limit:.4g}")
        if limits:
            percent = 100 * at_limit.mean()
            found.append(
                f"the torque of joint {j + 1} stays at {' and '.join(limits)} N m in "
                f"{percent:.{0 if percent >= 10 else 1}f} % of the samples: a drive or a sensor at its limit, which no "
                "effect describes"
            )
    return found


def _differs(values: np.ndarray, label: np.ndarray, reach: int) -> np.ndarray:
    """Return which samples (m,) differ from the one `reach` before; none does at the start of a record."""
    differs = np.zeros(len(values), bool)
    differs[reach:] = (values[reach:] != values[:-reach]) & (label[reach:] == label[:-reach])
    return differs


def _longest(shown: np.ndarray) -> int:
    """Return the length of the longest run of samples (m,) that are shown."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], shown.astype(int), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))
