"""Load at the flange as the gravity torques show it, window by window: a condition of operation, no wear.

The regression of a window finds by which share g its gravity torque differs from the model's. A load moves that of
several axes at once; their mean by weight of evidence is one value of the robot, and together with the model's torque
it tells the load on each axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jointwear.monitor.normal.estimate import COLUMNS, Sums, column_estimate

#: Standard deviation a priori of the share; an axis whose share is known no better than this does not count.
USUAL, COARSEST = 0.2, 0.15


@dataclass(frozen=True)
class GravityTorque:
    """By what gravity torques differ from the model's: `share` (w, n) of them and `constant` (w, n) [N m], both shrunk,
    zeros where nothing shows them.

    Only together do they tell the load of an axis. Where its gravity torque hardly changes within a window, friction
    that is off the shape of its curve moves one against the other: of an axis that wore by 65 % the share rose by 0.23,
    which looked like a load that the baseline lacks, and the sum stayed within 0.2 %.
    """

    share: np.ndarray
    constant: np.ndarray


def gravity_share(sums: Sums, pooled: np.ndarray) -> tuple[GravityTorque, np.ndarray]:
    """Return the difference of the gravity torque from the model, axis by axis, and the share of the robot (w,) by
    which it differs, in the baseline's units; zeros where nothing shows it. `pooled` (n,) noise variance [N2 m2]."""
    n = sums.gram.shape[-3]
    free, held = np.ones((n, len(COLUMNS)), dtype=bool), np.zeros((n, len(COLUMNS)))
    value, variance = column_estimate(sums, held, free, pooled, COLUMNS.index("gravity"))
    constant, _ = column_estimate(sums, held, free, pooled, COLUMNS.index("offset"))
    known = np.isfinite(value) & (variance < COARSEST**2) & (variance > 0)
    safe = np.where(known, variance, 1.0)
    shrinking = np.where(known, USUAL**2 / (USUAL**2 + safe), 0.0)
    weight = np.where(known, 1.0 / safe, 0.0)
    total = weight.sum(axis=1)
    robot = np.divide(
        (weight * np.where(known, value, 0.0)).sum(axis=1), total, out=np.zeros(len(total)), where=total > 0
    )
    return GravityTorque(np.nan_to_num(value) * shrinking, np.nan_to_num(constant) * shrinking), robot
