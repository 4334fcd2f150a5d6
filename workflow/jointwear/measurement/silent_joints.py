"""Joints whose torque was not recorded: it keeps one value while they move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jointwear.measurement.checks import FEWEST, Refused
from jointwear.measurement.motion import Measured, measure
from jointwear.measurement.recording import Recording


def silent_joints(measured: Measured) -> list[int]:
    """Return the joints, from 0, whose torque keeps one value while they move."""
    return [
        j
        for j, used in enumerate(measured.usable.T)
        if used.sum() >= FEWEST and np.ptp(measured.torque[used, j]) == 0.0
    ]


def check_torque_moves(measured: Measured, name: str) -> None:
    """Check that some joint changes its torque while it moves.

    Raises
    ------
    Refused : where none does.
    """
    moving = int(np.sum(measured.usable.sum(axis=0) >= FEWEST))
    if moving and len(silent_joints(measured)) == moving:
        raise Refused(
            f"{name}: the torque keeps one value while the axes move",
            "name the column that holds the torque under 'variables'",
        )


def moving_torques(recording: Recording) -> Measured:
    """Return what :func:`~jointwear.measurement.motion.measure` does, with joints whose torque was not recorded marked
    as ones that cannot be judged.

    Raises
    ------
    Refused : where that is so of all joints that move.
    """
    measured = measure(recording)
    check_torque_moves(measured, f"data set '{recording.name}'")
    silent = silent_joints(measured)
    if not silent:
        return measured
    usable = measured.usable.copy()
    usable[:, silent] = False
    return replace(measured, usable=usable)
