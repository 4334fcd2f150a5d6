"""The travel of a joint on which an effect was found: beyond it a curve through what was seen is no law."""

from __future__ import annotations

import numpy as np

from jointwear.effects.effect import Parameter
from jointwear.effects.state import State

#: Position [rad] beyond all travel.
FAR = 100.0
#: The two ends, parameters of an effect; by default it was found everywhere.
ENDS = (
    Parameter("low", "rad", -FAR, FAR, "end of the travel on which it was found", -FAR, fixed=True),
    Parameter("high", "rad", -FAR, FAR, "the other end", FAR, fixed=True),
)


def ends_of(state: State, axis: int) -> dict[str, float]:
    """Return the ends `low` and `high` [rad] of the travel of one axis in a state."""
    position = state.position[..., axis]
    return {"low": float(np.round(position.min(), 3)), "high": float(np.round(position.max(), 3))}
