"""Torques that were not recorded: they keep one value while the joint moves, always or for a while."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.files.wording import count
from jointwear.measurement.derived.motion import Measured, measure
from jointwear.measurement.recording import Recording
from jointwear.measurement.refused import FEWEST_OF_JOINT, Refused

#: Time [s] and turn [rad] in which a torque that keeps one value was not recorded: friction and weight change in less,
#: and the coarsest scale of a current has another value.
STAYS, TURNS = 1.0, 0.1


def silent_joints(measured: Measured) -> list[int]:
    """Return the joints, from 0, whose torque keeps one value while they move."""
    return [
        j
        for j, used in enumerate(measured.usable.T)
        if used.sum() >= FEWEST_OF_JOINT and np.ptp(measured.torque[used, j]) == 0.0
    ]


def silent_samples(measured: Measured) -> np.ndarray:
    """Return where (m, n) bool a torque keeps one value for a while in which its joint turns."""
    moves = np.abs(measured.velocity) > measured.speed_floor
    return kept_values(measured.torque, measured.position, moves, measured.trajectory, measured.rate)


def kept_values(
    torque: np.ndarray, position: np.ndarray, moves: np.ndarray, label: np.ndarray, rate: float
) -> np.ndarray:
    """Return where (m, n) bool a torque keeps one value for :data:`STAYS` and more in which its joint turns.

    Parameters
    ----------
    torque, position : (m, n) [N m], [rad]. moves : (m, n) bool. label : (m,) of uninterrupted runs. rate : [Hz].
    """
    silent = np.zeros(torque.shape, bool)
    fewest = max(int(STAYS * rate), 2)
    for j, (values, places) in enumerate(zip(torque.T, position.T, strict=True)):
        changes = (np.diff(values) != 0) | (np.diff(label) != 0)
        edges = np.concatenate([[0], np.flatnonzero(changes) + 1, [len(values)]])
        # A torque with noise changes at every sample.
        for k in np.flatnonzero(np.diff(edges) >= fewest):
            a, b = edges[k : k + 2]
            if moves[a:b, j].sum() >= fewest and np.ptp(places[a:b]) > TURNS:
                silent[a:b, j] = True
    return silent


def silence_in_words(measured: Measured) -> list[str]:
    """Return in words which joints have a torque that keeps one value for a while, and when first."""
    silent = silent_samples(measured)
    silent[:, silent_joints(measured)] = False
    return [
        f"the torque of joint {j + 1} keeps one value in {count(int(silent[:, j].sum()), 'sample')} in which the joint "
        f"turns, first at {_seconds(measured.time[np.argmax(silent[:, j])])} s: left out"
        for j in np.flatnonzero(silent.any(axis=0))
    ]


def _seconds(time: float) -> str:
    """Return a time [s] into a recording in digits, whole where it is long: 14410, not 1.441e+04."""
    return f"{time:.4g}" if time < 1000 else f"{time:.0f}"


def check_torque_moves(measured: Measured, name: str) -> None:
    """Check that some joint changes its torque while it moves.

    Raises
    ------
    Refused : where none does.
    """
    moving = int(np.sum(measured.usable.sum(axis=0) >= FEWEST_OF_JOINT))
    if moving and len(silent_joints(measured)) == moving:
        raise Refused(
            f"{name}: the torque keeps one value while the axes move",
            "name the column that holds the torque under 'variables'",
            by_keys=True,
        )


def moving_torques(recording: Recording) -> Measured:
    """Return what :func:`~.motion.measure` does, with joints whose torque was not recorded marked
    as ones that cannot be judged.

    Raises
    ------
    Refused : where that is so of all joints that move.
    """
    measured = measure(recording)
    check_torque_moves(measured, f"data set '{recording.name}'")
    usable = measured.usable & ~silent_samples(measured)
    usable[:, silent_joints(measured)] = False
    return replace(measured, usable=usable)
