"""What is asked of a quantity that is watched: over which windows, from where axes are learnt anew, and for what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.conditions import Conditions
from jointwear.monitor.watching.watched_axis import UNSEEN, Start


@dataclass(frozen=True)
class Period:
    """Windows of a robot: their conditions of operation, `baseline` (w,) bool, and `shift` (w,), labels."""

    conditions: Conditions
    baseline: np.ndarray
    shift: np.ndarray


@dataclass(frozen=True)
class Anew:
    """Windows from which each axis is learnt anew, nothing where there is none.

    `events`: at which the config says that something was done to it; `proposed`: found in the logs themselves; `kept`:
    those of `events` that leave alarms open, over which what such an alarm tells of goes on.
    """

    events: Sequence[Sequence[int]] = ()
    proposed: Sequence[Sequence[int]] = ()
    kept: Sequence[Sequence[int]] = ()

    def starts(self, axes: int) -> list[list[Start]]:
        """Return where each axis is learnt anew."""
        none: list[list[int]] = [[]] * axes
        told = (
            # No growth goes on over what the logs show in the same window, such as another scale.
            [Start(k, k in g and k in p, k in g and k not in p) for k in e] + [Start(k, True) for k in set(p) - set(e)]
            for e, p, g in zip(self.events or none, self.proposed or none, self.kept or none, strict=True)
        )
        return [sorted(one, key=lambda start: start.window) for one in told]


@dataclass(frozen=True)
class Asked:
    """What is asked of a quantity.

    `rate`: false alarms a window that all axes together may have; `services`: whether falls propose services; `common`:
    whether what all axes have in common is taken out; `unit` (n,): what that comes to for each axis in these units,
    such as its share of viscous friction; `least`: growth from which on somebody has to act, in units of the series;
    `coarsest`: standard deviation of a prediction beyond which a window is not judged.
    """

    rate: float
    services: bool = True
    common: bool = True
    unit: np.ndarray | float = 1.0
    least: float = 0.0
    coarsest: float = UNSEEN
