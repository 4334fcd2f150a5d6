"""Pieces of samples that one load at the flange is looked for in together."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

#: Time [s] of samples that shows a load: two to four cycles of a robot.
SUFFICES = 20.0


def together(pieces: Sequence[slice], window: np.ndarray, stretch: np.ndarray, step: float) -> list[list[slice]]:
    """Return the pieces in groups that one load is looked for in: those too short to show one with what is beside them.

    Parameters
    ----------
    pieces : uninterrupted samples of one window each, in order. window, stretch : (m,) labels. step : [s] between
        samples.

    Notes
    -----
    A hole cuts a piece off from what its window shows. Of its few moves most fit a load no better than friction: with
    none taken off, or a wrong one, parts of 5 to 14 kg turned into 30 to 70 % of friction beside holes of seconds.
    """

    def beside(one: slice, other: slice) -> bool:
        return window[one.start] == window[other.start] or stretch[one.start] == stretch[other.start]

    groups: list[list[slice]] = []
    for piece in pieces:
        if groups and _seconds(groups[-1], step) < SUFFICES and beside(groups[-1][-1], piece):
            groups[-1].append(piece)
            continue
        _join_short(groups, beside, step)
        groups.append([piece])
    _join_short(groups, beside, step)
    return groups


def _join_short(groups: list[list[slice]], beside: Callable[[slice, slice], bool], step: float) -> None:
    """Put the last group, where it is too short and nothing follows beside it, to the one before it."""
    if len(groups) > 1 and _seconds(groups[-1], step) < SUFFICES and beside(groups[-2][-1], groups[-1][0]):
        groups[-2:] = [groups[-2] + groups[-1]]


def _seconds(group: Sequence[slice], step: float) -> float:
    return step * sum(piece.stop - piece.start for piece in group)
