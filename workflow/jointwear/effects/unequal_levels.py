"""Coulomb friction whose two levels differ: what scales them adds more friction to the larger one.

A gear that drags more one way than the other does so when it is cold, dry or worn too. Of a change by the same share of
both levels a part is the same in both directions of motion, like a spring or an offset. An effect on such an axis has
two forms: one in proportion to the levels of the robot file, and one that is equal in both directions.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jointwear.effects.effect import Parameter
from jointwear.effects.state import State


def carrier(state: State, axis: int, parameters: Mapping[str, float]) -> np.ndarray:
    """Return what friction of 1 N m in the mean is in the direction of motion, shape (...,): 1 + `unequal` forward and
    -1 + `unequal` backward."""
    direction = state.direction[..., axis]
    unequal = parameters.get("unequal", 0.0)
    return direction + unequal * np.abs(direction) if unequal else direction


def forms(state: State, axis: int) -> list[dict[str, float]]:
    """Return the two forms, or one where the levels of the robot file are equal, that in proportion to them first."""
    return [{"unequal": share} for share in dict.fromkeys((_unequal(state, axis), 0.0))]


def unequal_parameter(what: str) -> Parameter:
    """Return the parameter of an effect that says by how much more of `what` there is one way than the other."""
    words = f"u, by which the {what} of positive motion is larger and that of negative motion smaller"
    return Parameter("unequal", "1", -1.0, 1.0, words, 0.0, fixed=True)


def _unequal(state: State, axis: int) -> float:
    """Return what the robot file's two levels differ by, as a share of their sum; 0 without friction."""
    forward, backward = state.drive.coulomb_positive[axis], -state.drive.coulomb_negative[axis]
    both = forward + backward
    return float(np.clip((forward - backward) / both, -1.0, 1.0)) if both > 0 else 0.0
