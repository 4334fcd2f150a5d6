"""A torque that stands still while its axis moves, always or for a while: the sensor, or the log, and nothing that the
axis does."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.checks.clipped_torque import LONGER, at_limit, at_zero, is_fine
from jointwear.measurement.checks.silent_joints import kept_values

#: Samples of a torque that keeps one value, and of motion of its joint either way, from which it is frozen.
FEWEST_FROZEN, FEWEST_MOVING = 200, 20
#: Share of the samples of a window in which an axis moves from which on a torque that stands still is that of all.
MOST = 0.5
#: Longest time [s] between samples, of a clock that is slow by a hundredth, that tell whether a torque stands still for
#: a while.
SLOWEST = 0.101


def standing(torque: np.ndarray, velocity: np.ndarray, dead_band: np.ndarray) -> np.ndarray:
    """Return the axes (n,) whose torque keeps one value though they move both ways.

    Parameters
    ----------
    torque, velocity : (m, n) [N m], [rad/s]. dead_band : (n,) [rad/s].
    """
    if len(torque) < FEWEST_FROZEN:
        return np.zeros(torque.shape[1], dtype=bool)
    # One value throughout shows in the first samples already: mostly nothing is left to look at.
    first = torque[:FEWEST_FROZEN]
    same = ~(np.isfinite(first[0]) & np.isfinite(first) & (first != first[0])).any(axis=0)
    for j in np.flatnonzero(same):
        known = torque[np.isfinite(torque[:, j]), j]
        same[j] = len(known) > 0 and np.ptp(known) == 0
    both = (velocity > dead_band).sum(axis=0), (velocity < -dead_band).sum(axis=0)
    return same & (np.minimum(*both) > FEWEST_MOVING)


def silent(torque: np.ndarray, position: np.ndarray, moves: np.ndarray, stretch: np.ndarray, step: float) -> np.ndarray:
    """Return where (m, n) bool a torque was not measured for a while in which its axis moves: it keeps one value for a
    second and more, or zero for five samples. Not one that keeps one value throughout, one at a limit, or one that is
    written in steps as coarse as itself.

    Parameters
    ----------
    torque, position : (m, n) [N m], [rad]. moves : (m, n) bool. stretch : (m,) label of the uninterrupted run.
    step : usual time between samples [s].
    """
    known = np.isfinite(torque)
    if not known.any() or step > SLOWEST:
        return np.zeros(torque.shape, dtype=bool)
    kept = kept_values(torque, position, moves, stretch, 1.0 / step)
    kept |= moves & at_zero(torque, position, stretch)
    for j in np.flatnonzero(kept.any(axis=0)):
        kept[:, j] &= is_fine(torque[:, j]) and _stands_out(kept[:, j], torque[:, j], moves[:, j], stretch)
    return kept & ~at_limit(torque, position, stretch)[0] if kept.any() else kept


def _stands_out(kept: np.ndarray, torque: np.ndarray, moves: np.ndarray, stretch: np.ndarray) -> np.ndarray:
    """Return which samples lie in a run of one torque that is far longer than other runs in motion: those of a coarse
    scale are long wherever the torque hardly changes. Arrays (m,)."""
    edges = np.flatnonzero((np.diff(torque) != 0) | (np.diff(stretch) != 0)) + 1
    lengths = np.diff(np.concatenate([[0], edges, [len(torque)]]))
    run, others = np.repeat(lengths, lengths), moves & ~kept
    return run > LONGER * (np.median(run[others]) if others.any() else 1.0)


def mostly(found: np.ndarray, moves: np.ndarray, time: np.ndarray, length: float) -> np.ndarray:
    """Return the samples (m, n) of windows in which most of the samples of an axis in motion are `found` (m, n) bool.

    Parameters
    ----------
    moves : (m, n) bool. time : (m,) [s]. length : of a window [s].
    """
    windows, place = np.unique(np.floor(time / length), return_inverse=True)
    moved, those = (np.zeros((len(windows), found.shape[1])) for _ in range(2))
    np.add.at(moved, place, moves)
    np.add.at(those, place, found & moves)
    return (those > MOST * np.maximum(moved, 1))[place]
