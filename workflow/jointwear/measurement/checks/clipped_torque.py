"""Torques that stay at their largest value: a drive, or the measurement of its torque, at its limit."""

from __future__ import annotations

import numpy as np

from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT

#: Samples in a row at the largest value from which it is a limit, and how many times as long as the longest run of
#: another value: a coarse scale repeats all of its values, at the crest of a wave five times as often as beside it.
FEWEST_IN_A_ROW, LONGER = 5, 10
#: Samples in which a joint that moves shows it: a coarse encoder repeats its values.
STILL = 10
#: Part of the usual torque (root mean square) that the smallest step between its values is, at most, where it cannot
#: keep one of them for long: of a coarse scale each stands for many torques.
FINE = 0.1


def clipped_torques(recording: Recording) -> list[str]:
    """Return in words which joints reach a limit of their torque while they move, and for how long."""
    there, limits = at_limit(recording.torque, recording.position, recording.trajectory)
    found = []
    for j, reached in enumerate(limits):
        if reached:
            percent = 100 * there[:, j].mean()
            found.append(
                f"the torque of joint {j + 1} stays at {' and '.join(f'{x:.4g}' for x in reached)} N m in "
                f"{percent:.{0 if percent >= 10 else 1}f} % of the samples: a drive or a sensor at its limit, which no "
                "effect describes"
            )
    return found


def at_limit(torque: np.ndarray, position: np.ndarray, label: np.ndarray) -> tuple[np.ndarray, list[list[float]]]:
    """Return where torques (m, n) stay at a limit, (m, n) bool, and the limits [N m] that each joint reaches.

    Parameters
    ----------
    position : (m, n) [rad]. label : (m,) of the uninterrupted stretch.
    """
    there, limits = np.zeros(torque.shape, dtype=bool), []
    for j, (values, places) in enumerate(zip(torque.T, position.T, strict=True)):
        limits.append([x for x in _lasting(np.ascontiguousarray(values), places, label) if x])
        if limits[-1]:
            there[:, j] = np.isin(values, limits[-1])
    return there, limits


def at_zero(torque: np.ndarray, position: np.ndarray, label: np.ndarray) -> np.ndarray:
    """Return where torques (m, n) stay at exactly zero in motion, as no drive does: they were not measured there, (m,
    n) bool; parameters as of :func:`at_limit`."""
    there = torque == 0.0
    # Hardly any log has such a torque.
    for j in np.flatnonzero(there.any(axis=0)):
        there[:, j] &= 0.0 in _lasting(np.ascontiguousarray(torque[:, j]), position[:, j], label)
    return there


def is_fine(torque: np.ndarray) -> bool:
    """Return whether a torque (m,) [N m] is written in steps that are small against it."""
    own = np.unique(torque[np.isfinite(torque)])
    return len(own) > 1 and float(np.diff(own).min()) < FINE * float(np.sqrt(np.mean(own**2)))


def _lasting(torque: np.ndarray, position: np.ndarray, label: np.ndarray) -> list[float]:
    """Return at which of its largest and its smallest torque, and of zero, [N m] one joint stays while it moves, arrays
    (m,)."""
    same = ~_differs(torque, label, 1)
    # Hardly any log has a run to look at.
    in_a_row = same[FEWEST_IN_A_ROW - 2 :].copy()
    for before in range(FEWEST_IN_A_ROW - 2):
        in_a_row &= same[before : before + len(in_a_row)]
    if not in_a_row.any() or not np.isfinite(torque).any():
        return []
    ends = np.unique([np.nanmin(torque), np.nanmax(torque), 0.0])
    moves = _differs(position, label, STILL)
    moves[:-STILL] &= moves[STILL:]
    if moves.sum() < FEWEST_OF_JOINT or np.nanmin(torque) == np.nanmax(torque):
        return []
    repeats = moves & same
    elsewhere = _longest(repeats & ~np.isin(torque, ends)) + 1
    runs = {float(x): _longest(repeats & (torque == x)) + 1 for x in ends}
    return [x for x, longest in runs.items() if longest >= FEWEST_IN_A_ROW and longest > LONGER * elsewhere]


def _differs(values: np.ndarray, label: np.ndarray, reach: int) -> np.ndarray:
    """Return which samples (m,) differ from the one `reach` before; none does at the start of a record."""
    differs = np.zeros(len(values), bool)
    differs[reach:] = (values[reach:] != values[:-reach]) & (label[reach:] == label[:-reach])
    return differs


def _longest(shown: np.ndarray) -> int:
    """Return the length of the longest run of samples (m,) that are shown."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], shown.astype(int), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))
